#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "base/frame.h"
#include "sensor/codec/image_codec.h"
#include "sensor/session/recorder.h"
#include "sensor/source.h"

namespace kino {

/// All that frames of one picture track have in common: a frame that differs is of another track.
struct StreamFormat {
    StreamId id;
    bool jpeg = false;  ///< passed on as the device coded it; image.codec and .layout say nothing
    ImageFormat image;
    DepthUnit unit = DepthUnit::linear;             ///< depth
    double metres_per_unit = 0.001;                 ///< depth
    PixelFormat pixel_format = PixelFormat::rgba8;  ///< colour
    YuvMatrix matrix = YuvMatrix::bt601;            ///< colour
    YuvRange range = YuvRange::full;                ///< colour
    int significant_bits = 16;                      ///< infrared
    friend bool operator==(const StreamFormat&, const StreamFormat&) = default;
};

[[nodiscard]] StreamFormat format_of(int device, const DepthFrame& frame, SessionCodec codec);
[[nodiscard]] StreamFormat format_of(int device, const ColorFrame& frame, SessionCodec codec);
[[nodiscard]] StreamFormat format_of(int device, const InfraredFrame& frame, SessionCodec codec);

/// The Matroska CodecID of the track, and the four letters of its pixels if it is uncompressed.
[[nodiscard]] std::string codec_id_of(const StreamFormat& format);
[[nodiscard]] std::string fourcc_of(const StreamFormat& format);

/// The KINO_FORMAT text of docs/session-format.md, there and back.
[[nodiscard]] std::string format_to_json(const StreamFormat& format);
[[nodiscard]] Result<StreamFormat> format_from_json(std::string_view text,
                                                    const std::string& where);

/// The stream's name in files: "depth", "color", "infrared", "motion", "bodies".
[[nodiscard]] const char* track_name(StreamKind kind);
[[nodiscard]] Result<StreamKind> stream_kind_of(std::string_view track_name,
                                                const std::string& where);

/// For a person: "16 bit, 1000 per metre, FFV1".
[[nodiscard]] std::string describe(const StreamFormat& format);

/// The pixels of a colour frame without padding at the ends of rows. Fails where the bytes are too
/// few for the size. `store` is used if a copy is needed.
[[nodiscard]] Result<std::span<const std::uint8_t>> packed_pixels(const ColorFrame& frame,
                                                                  std::vector<std::uint8_t>& store);
/// Bytes from row to row of an unpadded picture; 0 for mjpeg.
[[nodiscard]] int packed_pitch(PixelFormat format, int width);

}  // namespace kino
