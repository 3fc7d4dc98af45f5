#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "base/body.h"
#include "base/error.h"
#include "base/image.h"
#include "skeleton/forest/coarse_part.h"

namespace kino {

/// A joint of the nearest person, marked by hand; pixels of the depth picture.
struct MarkedJoint {
    std::string name;  ///< as in the file, "il_hand": the hand on the picture's left
    Joint joint = Joint::head;
    double x = 0, y = 0;
    CoarsePartSet right = 0;  ///< labels that are right around it
};

struct MarkedFrame {
    std::string name;
    Image<std::uint16_t> depth_mm;
    Image<std::uint8_t> body;  ///< 1 where the marked person is
    std::vector<MarkedJoint> joints;
};

/// Pixel focal length of the Kinect v1's depth camera, as nobody recorded it with the frames.
constexpr double kMarkedFocalPx = 585;

/// Frames of a folder with joints2d.json and the 16-bit pictures that it names, in the folder or
/// in its depth_mm. The person is what hangs together with the marked joints within 0.9 m before
/// and 0.4 m behind the torso, steps of more than 60 mm apart.
[[nodiscard]] Result<std::vector<MarkedFrame>> read_marked_frames(
    const std::filesystem::path& folder);

}  // namespace kino
