#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/time.h"

namespace kino::test {

using Bytes = std::vector<std::uint8_t>;

/// An Azure Kinect recording written by hand, knowing nothing of the reader: EBML heads of fixed
/// widths, as libmatroska lays them out.
struct K4aBytes {
    int depth_width = 320;
    int depth_height = 288;
    int color_width = 1280;
    int color_height = 720;
    std::string color_fourcc = "MJPG";  ///< empty: no colour
    bool infrared = true;
    bool motion = true;
    TimeNs start_offset = 336'277'000;
    std::string calibration;  ///< empty: none
    int frames = 3;
    bool finished = true;  ///< false: as before the recorder's flush, the segment's size 0
    std::string depth_name = "DEPTH";
};

[[nodiscard]] std::uint16_t k4a_depth(std::size_t pixel, int frame);
[[nodiscard]] std::uint16_t k4a_infrared(std::size_t pixel, int frame);
[[nodiscard]] std::uint8_t k4a_color(std::size_t byte, int frame);
/// Colour's bytes of a frame as the file holds them.
[[nodiscard]] Bytes k4a_color_frame(const K4aBytes& file, int frame);
/// Time of frame i since the start of the file; colour comes 2 ms later.
[[nodiscard]] TimeNs k4a_time(int frame);

[[nodiscard]] Bytes make_k4a(const K4aBytes& file);

/// As a camera carries it, in the order of the SDK.
[[nodiscard]] std::string sample_k4a_calibration();

}  // namespace kino::test
