#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "base/camera_model.h"
#include "base/error.h"
#include "viz/scene/scene.h"

namespace kino::test {

/// A number no DepthSurface has had yet.
[[nodiscard]] std::uint64_t next_version();

/// A depth image without lens distortion, seen by a camera in its middle; `depth_m(x, y)` gives
/// the metres, `color(x, y)` the colour.
template <class Depth, class Color>
std::shared_ptr<DepthSurface> make_surface(const CameraModel& camera, Depth depth_m, Color color) {
    auto surface = std::make_shared<DepthSurface>();
    auto rays = std::make_shared<Image<RayXy>>(camera.width, camera.height);
    surface->depth_m.resize(camera.width, camera.height);
    surface->color.resize(camera.width, camera.height);
    for (int y = 0; y < camera.height; ++y) {
        for (int x = 0; x < camera.width; ++x) {
            rays->at(x, y) = {static_cast<float>((x - camera.cx) / camera.fx),
                              static_cast<float>((y - camera.cy) / camera.fy)};
            surface->depth_m.at(x, y) = static_cast<float>(depth_m(x, y));
            surface->color.at(x, y) = color(x, y);
        }
    }
    surface->rays = rays;
    surface->focal_px = camera.fx;
    surface->version = next_version();
    return surface;
}

/// A frame of a recording, registered and coloured, as the programs draw it.
struct RecordedScene {
    Scene scene;
    RigParameters rig;
};
[[nodiscard]] Result<RecordedScene> load_recording(const std::string& uri, std::int64_t frame = 0);

}  // namespace kino::test
