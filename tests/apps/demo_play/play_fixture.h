#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <set>
#include <string>
#include <vector>

#include "apps/demo/demo_play.h"
#include "tests/apps/stage/scene_bits.h"

/// People made of a few numbers, a play to put them into, and what every scene of it must keep.
namespace kino::test {

constexpr double kStep = 1.0 / 30;

/// Somebody at `x_m` aside and 2.5 m ahead of the sensor, depth-camera space; hands go round.
inline Body somebody(std::uint32_t id, double time_s, double x_m = 0, double z_m = 2.5) {
    Body body{.id = id};
    const auto put = [&](Joint joint, double x, double y, double z) {
        body[joint] = {
            .position_m = {x_m + x, y, z_m + z}, .state = JointState::tracked, .confidence = 1};
    };
    put(Joint::hip_center, 0, 0.1, 0);
    put(Joint::spine, 0, -0.05, 0);
    put(Joint::shoulder_center, 0, -0.4, 0);
    put(Joint::head, 0, -0.62, 0);
    const double turn = 2 * time_s;
    // The sensor sees the person's left at its right.
    for (const double side : {1.0, -1.0}) {
        const int at = side > 0 ? 4 : 8, leg = side > 0 ? 12 : 16;
        put(static_cast<Joint>(at), 0.18 * side, -0.38, 0);
        put(static_cast<Joint>(at + 1), 0.3 * side, -0.15, -0.1);
        put(static_cast<Joint>(at + 2), 0.35 * side, -0.2, -0.3);
        put(static_cast<Joint>(at + 3), 0.4 * side + 0.25 * std::cos(turn),
            -0.2 + 0.25 * side * std::sin(turn), -0.35);
        put(static_cast<Joint>(leg), 0.1 * side, 0.15, 0);
        put(static_cast<Joint>(leg + 1), 0.12 * side, 0.55, 0);
        put(static_cast<Joint>(leg + 2), 0.12 * side, 0.95, 0);
        put(static_cast<Joint>(leg + 3), 0.13 * side, 1.0, -0.1);
    }
    return body;
}

inline GestureEvent gesture(GestureKind kind, std::uint32_t id = 1, Hand hand = Hand::right) {
    return {.kind = kind, .hand = hand, .body_id = id, .primary = id == 1, .confidence = 1};
}

class Game {
  public:
    explicit Game(DemoOptions options = {}) : play_(*DemoPlay::create(std::move(options))) {}

    /// A moment with these people.
    void step(const std::vector<Body>& bodies, std::vector<GestureEvent> events = {},
              double dt_s = kStep) {
        time_s_ += std::isfinite(dt_s) ? dt_s : 0;
        const BodyFrame frame{.time = from_seconds(time_s_), .bodies = bodies};
        for (GestureEvent& event : events) {
            event.time = frame.time;
            event.start_time = frame.time - from_seconds(0.35);
        }
        play_.step({.dt_s = dt_s,
                    .time = frame.time,
                    .bodies = &frame,
                    .gestures = events,
                    .world_from_depth = sensor_pose(),
                    .surface = surface,
                    .middle_m = sensor_pose() * glm::dvec3(0, 0, 2.5),
                    .source_lost = lost});
        for (DemoEvent& event : play_.take_events()) log_.push_back(std::move(event));
    }
    /// One person for so long.
    void go_on(double seconds, double x_m = 0) {
        for (int i = 0; i < static_cast<int>(std::lround(seconds / kStep)); ++i) {
            step({somebody(1, time_s_, x_m)});
        }
    }
    void nobody(double seconds) {
        for (int i = 0; i < static_cast<int>(std::lround(seconds / kStep)); ++i) step({});
    }
    /// That one person makes a gesture.
    void make(GestureEvent event) { step({somebody(1, time_s_)}, {std::move(event)}); }
    void make(GestureKind kind, Hand hand = Hand::right) { make(gesture(kind, 1, hand)); }
    void engage() {
        go_on(0.2);
        make(GestureKind::engaged);
        go_on(0.5);
    }

    [[nodiscard]] DemoPlay& play() { return play_; }
    [[nodiscard]] double now_s() const { return time_s_; }
    [[nodiscard]] const std::vector<DemoEvent>& log() const { return log_; }
    [[nodiscard]] std::vector<std::string> said() const {
        std::vector<std::string> out;
        for (const DemoEvent& event : log_) out.push_back(event.what);
        return out;
    }

    std::shared_ptr<const DepthSurface> surface;
    bool lost = false;

  private:
    DemoPlay play_;
    double time_s_ = 0;
    std::vector<DemoEvent> log_;
};

constexpr std::uint32_t kPaintId = 20000, kBallId = 30000, kAvatarId = 40000;

inline std::size_t nodes_within(const Scene& scene, std::uint32_t from, std::uint32_t to) {
    std::size_t count = 0;
    for (const MeshNode& node : scene.meshes) count += node.id >= from && node.id < to;
    return count;
}
inline std::size_t painted(const Scene& scene) {
    return nodes_within(scene, kPaintId, kPaintId + 800);
}
inline std::size_t sparks(const Scene& scene) {
    return nodes_within(scene, kPaintId + 800, kBallId);
}
inline std::size_t balls(const Scene& scene) {
    return nodes_within(scene, kBallId, kAvatarId);
}

inline glm::dvec3 light_of_all(const Scene& scene) {
    glm::dvec3 sum(0);
    for (const Light& light : scene.lights) sum += glm::dvec3(light.color);
    return sum;
}

inline void expect_sound(DemoPlay& play) {
    const Scene& scene = play.scene();
    std::set<std::uint32_t> ids;
    EXPECT_LE(scene.materials.size(), kMaxMaterials - 1);
    for (const MeshNode& node : scene.meshes) {
        ASSERT_TRUE(ids.insert(node.id).second) << node.id;
        ASSERT_GE(node.id, 1u);
        ASSERT_LE(node.id, 65535u);
        ASSERT_NE(node.mesh, nullptr);
        ASSERT_LE(node.material, scene.materials.size());
        ASSERT_TRUE(all_finite(node.world_from_object)) << node.id;
        ASSERT_TRUE(all_finite(node.previous_world_from_object)) << node.id;
    }
    std::size_t local = 0;
    for (const Light& light : scene.lights) {
        local += light.kind != LightKind::directional;
        for (int k = 0; k < 3; ++k) {
            ASSERT_TRUE(std::isfinite(light.position[k]) && std::isfinite(light.direction[k]));
            ASSERT_TRUE(std::isfinite(light.color[k]) && light.color[k] >= 0);
        }
        ASSERT_GT(light.radius_m, 0);
    }
    ASSERT_LE(local, 1024 + 48u);
    ASSERT_LE(local, 1024 + balls(scene));
    ASSERT_EQ(local, play.local_lights());
    ASSERT_TRUE(std::isfinite(scene.exposure) && scene.exposure >= 0);
    const View view = play.view(160, 90);
    ASSERT_TRUE(is_valid(view.world_from_view));
    const auto sound = [](const DemoGuidance& guidance) {
        ASSERT_TRUE(std::isfinite(guidance.progress) && std::isfinite(guidance.distance_m));
        ASSERT_GE(guidance.progress, 0);
        ASSERT_LE(guidance.progress, 1);
        if (guidance.anchor_m) {
            const glm::dvec3 at = *guidance.anchor_m;
            ASSERT_TRUE(std::isfinite(at.x + at.y + at.z));
        }
    };
    sound(play.guidance());
    if (play.second_guidance() != nullptr) sound(*play.second_guidance());
}

}  // namespace kino::test
