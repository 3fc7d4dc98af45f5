#pragma once

#include <glm/vec2.hpp>
#include <string>
#include <vector>

namespace kino {

/// A corner of the board in a picture. `id` counts into Shots::corners_m; px, centres at integers.
struct ShotCorner {
    int id = 0;
    glm::dvec2 px{};
};

/// One camera's pictures of the board.
struct CameraShots {
    std::string name;                            ///< for a person: "infrared"
    int width = 0;                               ///< px
    int height = 0;                              ///< px
    std::vector<std::vector<ShotCorner>> views;  ///< as many as Shots::names; empty where unseen
};

/// What a calibration is made from: views of one flat board by one or two cameras. In a view the
/// board stands still. Every camera has as many views as there are names.
struct Shots {
    std::vector<glm::dvec2> corners_m;  ///< the board's corners in its plane
    std::vector<std::string> names;     ///< of the views
    std::vector<CameraShots> cameras;   ///< 1 or 2; the poses refer to the first
};

/// The views for which `keep` is true, in order.
[[nodiscard]] Shots only_views(const Shots& shots, const std::vector<bool>& keep);
/// The same shots by one camera alone; views that it did not see are left out.
[[nodiscard]] Shots only_camera(const Shots& shots, std::size_t camera);

}  // namespace kino
