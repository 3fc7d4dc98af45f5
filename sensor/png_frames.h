#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "sensor/recording_source.h"

namespace kino {

struct PngFrame {
    std::filesystem::path path;
    TimeNs time = 0;  ///< the recording's own clock
};

/// Depth and colour kept as one PNG file a frame.
struct PngFrames {
    std::vector<PngFrame> depth;
    std::vector<PngFrame> color;
    DepthUnit unit = DepthUnit::linear;
    double metres_per_unit = 0.001;
    RigParameters rig;  ///< a file whose size is not its camera's is refused
};

/// Reads files when asked, and keeps decoded frames up to 32 MB, so that short loops and
/// ping-pong decode each file once.
[[nodiscard]] std::unique_ptr<FrameReader> make_png_reader(PngFrames frames);

}  // namespace kino
