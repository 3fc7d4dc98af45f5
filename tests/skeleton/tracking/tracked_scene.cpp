#include "tests/skeleton/tracking/tracked_scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <numbers>

#include "skeleton/forest/default_forest.h"

namespace kino::test {

BodyTracker tracker_for(const Image<RayXy>& rays, const BodyTrackerOptions& options) {
    static const Result<std::shared_ptr<const Forest>> forest = default_forest();
    EXPECT_TRUE(forest) << (forest ? "" : forest.error().what);
    Result<BodyTracker> tracker = BodyTracker::create(rays, *forest, options);
    EXPECT_TRUE(tracker);
    return std::move(*tracker);
}

TrackedScene::TrackedScene(const RoomOptions& r, const BodyTrackerOptions& options)
    : room(r), scene(r), tracker(tracker_for(scene.rays(), options)) {}

void TrackedScene::next(const std::vector<Actor>& actors) {
    scene.draw(actors, index++);
    time += step;
    tracker.track(scene.depth_m(), time, std::nullopt, frame);
}

void TrackedScene::learn_room() {
    for (int i = 0; i < 8; ++i) {
        next({});
        time += kNsPerSecond / 8;
    }
}

Body TrackedScene::truth(const Actor& actor) const {
    constexpr double kRad = std::numbers::pi / 180;
    const Pose camera = Pose{glm::angleAxis(room.tilt_deg * kRad, glm::dvec3(1, 0, 0)) *
                                 glm::angleAxis(room.roll_deg * kRad, glm::dvec3(0, 0, 1)),
                             glm::dvec3(room.camera_x_m, room.camera_height_m, 0)} *
                        world_from_camera_axes();
    const Pose view = inverse(camera);
    const PosedBody posed = pose_body(actor.pose);
    Body body;
    for (std::size_t j = 0; j < kJointCount; ++j) {
        body.joints[j] = {glm::vec3(view * (actor.world_from_body * posed.joint_m[j])),
                          JointState::tracked, 1};
    }
    return body;
}

std::vector<float> errors_mm(const Body& truth, const Body* found, std::size_t first,
                             std::size_t last) {
    std::vector<float> errors;
    for (std::size_t j = first; j <= last; ++j) {
        const bool lost = !found || found->joints[j].state == JointState::lost;
        errors.push_back(
            lost ? 300
                 : 1000 * glm::length(found->joints[j].position_m - truth.joints[j].position_m));
    }
    return errors;
}

float mean_of(const std::vector<float>& v) {
    float sum = 0;
    for (const float e : v) sum += e;
    return v.empty() ? 0 : sum / static_cast<float>(v.size());
}

float quantile_of(std::vector<float> v, double q) {
    if (v.empty()) return 0;
    std::ranges::sort(v);
    return v[static_cast<std::size_t>(q * static_cast<double>(v.size() - 1))];
}

const Body* nearest_body(const BodyFrame& frame, const Body& truth) {
    const Body* nearest = nullptr;
    float least = 1;
    for (const Body& body : frame.bodies) {
        const float d =
            glm::length(body[Joint::hip_center].position_m - truth[Joint::hip_center].position_m);
        if (d < least) {
            least = d;
            nearest = &body;
        }
    }
    return nearest;
}

bool all_finite(const BodyFrame& frame) {
    for (const Body& body : frame.bodies) {
        for (const JointPosition& joint : body.joints) {
            if (!std::isfinite(joint.position_m.x + joint.position_m.y + joint.position_m.z +
                               joint.confidence) ||
                joint.confidence < 0 || joint.confidence > 1) {
                return false;
            }
        }
    }
    return true;
}

}  // namespace kino::test
