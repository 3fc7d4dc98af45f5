#pragma once

#include <cstdint>
#include <span>

#include "base/error.h"
#include "base/frame.h"

namespace kino {

/// Pixels as OpenNI2 hands them over.
struct OpenniPixels {
    int pixel_format = 0;   ///< openni::k...
    int width = 0;          ///< px
    int height = 0;         ///< px
    int stride = 0;         ///< bytes from row to row; not used for JPEG
    bool mirrored = false;  ///< left and right are exchanged
    std::span<const std::uint8_t> bytes;
};

/// The frame without its header, rows packed and unmirrored. They fail for a format of another
/// kind and for fewer bytes than the size needs. Depth: DEPTH_1_MM and DEPTH_100_UM stay as they
/// are, 0 being no reading; SHIFT_9_2 is the Kinect's 11-bit count, of SHIFT_9_3 the lowest bit is
/// dropped to make it one, and 0 becomes its "no reading", 2047.
[[nodiscard]] Result<DepthFrame> depth_from_openni(const OpenniPixels& pixels);
/// RGB888, YUV422 (u y v y), YUYV, GRAY8, JPEG. A mirrored YUV or JPEG picture is refused.
[[nodiscard]] Result<ColorFrame> color_from_openni(const OpenniPixels& pixels);
/// GRAY16 (10 bits), GRAY8, and of RGB888, which is grey, the green.
[[nodiscard]] Result<InfraredFrame> infrared_from_openni(const OpenniPixels& pixels);

/// For a person: "16 bit, millimetres"; empty for formats that the above refuse.
[[nodiscard]] const char* openni_format_name(int pixel_format);

}  // namespace kino
