#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/time.h"

namespace kino::test {

enum class BagPacking : std::uint8_t { none, lz4, bz2 };

/// A librealsense recording as a ROS bag 2.0, written by hand from the format's description and
/// knowing nothing of the reader.
struct BagBytes {
    int width = 24;
    int height = 10;
    int color_width = 16;
    int color_height = 12;
    int frames = 4;
    BagPacking packing = BagPacking::none;
    bool indexed = true;             ///< false: cut off behind the last chunk, no table written
    bool with_index_records = true;  ///< those behind each chunk
    std::string color_encoding = "rgb8";
    float depth_unit = 0.001f;
    std::string model = "Brown Conrady";
    /// Chunks so; 0: none is finished, as when the recorder dies in its first chunk.
    int frames_a_chunk = 2;
};

[[nodiscard]] std::uint16_t bag_depth(std::size_t pixel, int frame);
[[nodiscard]] std::uint8_t bag_color(std::size_t byte, int frame);
[[nodiscard]] TimeNs bag_depth_time(int frame);   ///< as recorded
[[nodiscard]] TimeNs bag_depth_stamp(int frame);  ///< the camera's

[[nodiscard]] std::vector<std::uint8_t> make_bag(const BagBytes& bag);

}  // namespace kino::test
