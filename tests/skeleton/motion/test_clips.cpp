#include "tests/skeleton/motion/test_clips.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <glm/geometric.hpp>

#include "tests/support/random.h"
#include "tests/support/temp_dir.h"

namespace kino::test {
namespace {

constexpr TimeNs kLateNs = 1'700'000'000'123'456'789;

glm::dvec3 random_direction(Random& random) {
    for (;;) {
        const glm::dvec3 v(random.real(-1, 1), random.real(-1, 1), random.real(-1, 1));
        const double length = glm::length(v);
        if (length > 0.1 && length < 1) return v / length;
    }
}

MotionClip clip_from(const Places& places, const Pose& world_from_depth) {
    MotionClip clip;
    clip.rate_hz = 30;
    const Pose depth_from_world = inverse(world_from_depth);
    for (std::size_t i = 0; i < places.size(); ++i) {
        MotionMoment moment;
        moment.world_from_depth = world_from_depth;
        moment.bodies.time = kLateNs + static_cast<TimeNs>(i) * kNsPerSecond / 30;
        Body body;
        body.id = kPerson;
        for (std::size_t j = 0; j < kJointCount; ++j) {
            body.joints[j] = {glm::vec3(depth_from_world * places[i][j]), JointState::tracked, 1};
        }
        moment.bodies.bodies.push_back(body);
        clip.moments.push_back(moment);
    }
    return clip;
}

}  // namespace

MotionClip synthetic_clip(Motion motion, int frames) {
    Places places;
    for (int i = 0; i < frames; ++i) {
        places.push_back(pose_body(pose_at(motion, i / 30.0)).joint_m);
    }
    const Pose tilted{glm::angleAxis(-0.3, glm::dvec3(1, 0, 0)), glm::dvec3(0.2, 1.05, -0.1)};
    return clip_from(places, tilted * world_from_camera_axes());
}

MotionClip random_clip(std::uint64_t seed, int frames) {
    Random random(seed);
    Places places;
    for (int i = 0; i < frames; ++i) {
        auto& p = places.emplace_back();
        p[0] = {random.real(-1, 1), random.real(0, 2), random.real(-4, -1)};
        for (std::size_t j = 1; j < kJointCount; ++j) {
            const double bone_m = 0.1 + 0.02 * static_cast<double>(j);
            p[j] = p[static_cast<std::size_t>(kJointParent[j])] + bone_m * random_direction(random);
        }
    }
    return clip_of(places);
}

MotionClip clip_of(const Places& places) {
    return clip_from(places, world_from_camera_axes());
}

Places world_places(const MotionClip& clip) {
    Places out;
    for (const MotionMoment& m : clip.moments) {
        auto& p = out.emplace_back();
        for (std::size_t j = 0; j < kJointCount; ++j) {
            p[j] = m.world_from_depth * glm::dvec3(m.bodies.bodies.at(0).joints[j].position_m);
        }
    }
    return out;
}

Places normalized(const Places& places) {
    std::array<double, kJointCount> bone{};
    for (std::size_t j = 1; j < kJointCount; ++j) {
        std::vector<double> lengths;
        const auto parent = static_cast<std::size_t>(kJointParent[j]);
        for (const auto& p : places) lengths.push_back(glm::length(p[j] - p[parent]));
        std::sort(lengths.begin(), lengths.end());
        bone[j] = lengths[lengths.size() / 2];
    }
    Places out;
    for (const auto& p : places) {
        auto& q = out.emplace_back(p);
        for (std::size_t j = 1; j < kJointCount; ++j) {
            const auto parent = static_cast<std::size_t>(kJointParent[j]);
            q[j] = q[parent] + bone[j] * glm::normalize(p[j] - p[parent]);
        }
    }
    return out;
}

std::array<glm::dvec3, kJointCount> standing() {
    return pose_body(standing_pose()).joint_m;
}

std::string written(const MotionClip& clip, const std::string& name, MotionSummary* summary) {
    const TempDir folder;
    const auto result = write_motion(folder / name, clip);
    EXPECT_TRUE(result.has_value()) << result.error().to_string();
    if (!result) return {};
    const std::string bytes = read_bytes(folder / name);
    EXPECT_EQ(result->bytes, bytes.size());
    if (summary != nullptr) *summary = *result;
    return bytes;
}

double largest_error_m(const std::map<std::string, glm::dvec3>& found, double unit_m,
                       const std::array<glm::dvec3, kJointCount>& places) {
    double worst = 0;
    for (std::size_t j = 0; j < kJointCount; ++j) {
        const glm::dvec3 there = found.at(joint_name(static_cast<Joint>(j))) * unit_m;
        const double off = glm::length(there - places[j]);
        if (!(off <= worst)) worst = off;
    }
    return worst;
}

}  // namespace kino::test
