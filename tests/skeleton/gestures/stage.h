#pragma once

#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "skeleton/gestures/gesture_recognizer.h"
#include "skeleton/synthetic/scene.h"
#include "tests/support/random.h"

namespace kino::test {

using PoseAt = std::function<BodyPose(double t_s)>;

inline double normal(Random& random) {
    return std::sqrt(-2 * std::log(random.real(1e-12, 1))) *
           std::cos(2 * std::numbers::pi * random.real(0, 1));
}

struct Take {
    double seconds = 10, rate_hz = 30;
    double noise_m = 0;  ///< on each axis of each joint
    std::uint64_t seed = 1;
    std::uint32_t id = 1;
    double start_s = 100;
};

/// True joints in depth-camera space, with noise, from a sensor 1.05 m above the floor.
inline std::vector<BodyFrame> record(const PoseAt& pose, const Take& take) {
    static const Pose depth_from_world =
        inverse(make_scene(Motion::idle, 320, 240).world_from_depth);
    Random random(take.seed);
    std::vector<BodyFrame> out;
    const auto count = static_cast<int>(take.seconds * take.rate_hz);
    for (int i = 0; i < count; ++i) {
        const double t = i / take.rate_hz;
        const PosedBody posed = pose_body(pose(t));
        Body body;
        body.id = take.id;
        for (std::size_t j = 0; j < kJointCount; ++j) {
            glm::dvec3 p = depth_from_world * posed.joint_m[j];
            if (take.noise_m > 0)
                p += take.noise_m * glm::dvec3(normal(random), normal(random), normal(random));
            body.joints[j] = {glm::vec3(p), JointState::tracked, 1.f};
        }
        out.push_back({from_seconds(take.start_s + t), {body}});
    }
    return out;
}

inline PoseAt scripted(Motion motion) {
    return [motion](double t) { return pose_at(motion, t); };
}

/// The frames of several people, by index.
inline std::vector<BodyFrame> together(std::vector<BodyFrame> a, const std::vector<BodyFrame>& b) {
    for (std::size_t i = 0; i < a.size() && i < b.size(); ++i)
        a[i].bodies.insert(a[i].bodies.end(), b[i].bodies.begin(), b[i].bodies.end());
    return a;
}

inline std::vector<GestureEvent> recognize(const std::vector<BodyFrame>& frames,
                                           GestureRecognizer& recognizer) {
    std::vector<GestureEvent> out;
    for (const BodyFrame& frame : frames)
        for (GestureEvent& event : recognizer.update(frame)) out.push_back(std::move(event));
    return out;
}

inline std::vector<GestureEvent> recognize(const std::vector<BodyFrame>& frames) {
    GestureRecognizer recognizer;
    return recognize(frames, recognizer);
}

/// Without engagement and without what continuous gestures do between begin and end.
inline std::vector<GestureKind> kinds(const std::vector<GestureEvent>& events) {
    std::vector<GestureKind> out;
    for (const GestureEvent& e : events) {
        if (e.kind == GestureKind::engaged || e.kind == GestureKind::released) continue;
        if (e.phase == GesturePhase::once || e.phase == GesturePhase::begin) out.push_back(e.kind);
    }
    return out;
}

inline double smooth_step(double x) {
    x = x < 0 ? 0 : x > 1 ? 1 : x;
    return x * x * (3 - 2 * x);
}

/// An arm given by where its parts point, x outwards from the body.
inline ArmPose arm(std::size_t side, glm::dvec3 upper, glm::dvec3 lower) {
    if (side == 1) upper.x = -upper.x, lower.x = -lower.x;
    ArmPose out;
    out.upper = glm::normalize(upper);
    out.lower = glm::normalize(lower);
    out.hand = out.lower;
    return out;
}

struct Key {
    double time_s;
    ArmPose left, right;
};

/// Arms through key poses, eased between them, standing with a little sway at (x, z) on the floor.
inline PoseAt keyed(std::vector<Key> keys, double x_m = 0, double z_m = -2.75) {
    return [keys = std::move(keys), x_m, z_m](double t) {
        BodyPose pose = pose_at(Motion::idle, t);
        pose.place_m = {x_m, 0, z_m};
        std::size_t i = 0;
        while (i + 1 < keys.size() && keys[i + 1].time_s <= t) ++i;
        BodyPose from = pose, to = pose;
        from.arm = {keys[i].left, keys[i].right};
        const std::size_t n = std::min(i + 1, keys.size() - 1);
        to.arm = {keys[n].left, keys[n].right};
        const double span = keys[n].time_s - keys[i].time_s;
        return blend(from, to, span > 0 ? smooth_step((t - keys[i].time_s) / span) : 1);
    };
}

}  // namespace kino::test
