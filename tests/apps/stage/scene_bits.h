#pragma once

#include <cmath>
#include <functional>
#include <string>

#include "base/pose.h"
#include "viz/scene/scene.h"

/// What tests of stages and of the demo share.
namespace kino::test {

/// A pose like a real sensor's: above the floor, a little turned and tilted.
inline Pose sensor_pose() {
    const Pose tilted{.rotation = glm::angleAxis(0.1, glm::dvec3(1, 0, 0)) *
                                  glm::angleAxis(0.4, glm::dvec3(0, 1, 0)),
                      .translation = {1, 1.2, -3}};
    return tilted * world_from_camera_axes();
}

inline bool all_finite(const glm::dmat4& m) {
    for (int c = 0; c < 4; ++c) {
        for (int r = 0; r < 4; ++r) {
            if (!std::isfinite(m[c][r])) return false;
        }
    }
    return true;
}

/// A sum of all bits of what a scene would be drawn from, its people apart.
inline std::string bits_of(const Scene& scene) {
    std::string bits;
    const auto add = [&](const auto& value) {
        bits.append(reinterpret_cast<const char*>(&value), sizeof value);
    };
    for (const Light& light : scene.lights) {
        add(light.kind);
        add(light.position);
        add(light.direction);
        add(light.color);
        add(light.radius_m);
    }
    for (const MeshNode& node : scene.meshes) {
        add(node.id);
        add(node.world_from_object);
        add(node.previous_world_from_object);
        add(node.material);
    }
    for (const Material& material : scene.materials) add(material.emission);
    add(scene.exposure);
    add(scene.background_top);
    add(scene.frame_index);
    return std::to_string(std::hash<std::string>()(bits));
}

}  // namespace kino::test
