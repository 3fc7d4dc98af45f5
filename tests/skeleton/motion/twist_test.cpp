#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>

#include "tests/skeleton/motion/glb_reader.h"
#include "tests/skeleton/motion/test_clips.h"

namespace kino::test {
namespace {

/// Global rotation of each node by name.
std::map<std::string, glm::dquat> turns_at(const GlbFile& file, std::size_t key) {
    const auto nodes = file.nodes_at(key);
    std::map<std::string, glm::dquat> out;
    for (std::size_t n = 0; n < nodes.size(); ++n) {
        out[file.json["nodes"][n]["name"]] = glm::normalize(glm::quat_cast(nodes[n]));
    }
    return out;
}

/// The angle between two rotations, radians.
double angle_between(const glm::dquat& a, const glm::dquat& b) {
    return 2 * std::acos(std::min(1.0, std::abs(glm::dot(a, b))));
}

/// The documented rest pose with bones of 0.3 m.
std::array<glm::dvec3, kJointCount> rest() {
    const glm::dvec3 up(0, 1, 0), left(1, 0, 0), ahead(0, 0, 1), hip(std::sqrt(0.75), -0.5, 0);
    const glm::dvec3 mirrored(-hip.x, hip.y, 0);
    const glm::dvec3 directions[] = {{},   up,    up,       up,    left,  left, left,
                                     left, -left, -left,    -left, -left, hip,  -up,
                                     -up,  ahead, mirrored, -up,   -up,   ahead};
    std::array<glm::dvec3, kJointCount> p{};
    for (std::size_t j = 1; j < kJointCount; ++j) {
        p[j] = p[static_cast<std::size_t>(kJointParent[j])] + 0.3 * directions[j];
    }
    return p;
}

TEST(Twist, TheRestPoseHasNoRotations) {
    const GlbFile file = read_glb(written(clip_of({rest()}), "a.glb"));
    for (const auto& [name, turn] : turns_at(file, 0)) {
        EXPECT_LT(angle_between(turn, glm::dquat(1, 0, 0, 0)), 1e-3) << name;
    }
}

TEST(Twist, TurningThePersonTurnsTheRootAlone) {
    const glm::dquat turn = glm::angleAxis(2.0, glm::normalize(glm::dvec3(0.2, 1, 0.1)));
    const Places places = world_places(synthetic_clip(Motion::dance, 40));
    Places turned = places;
    for (auto& p : turned) {
        for (glm::dvec3& v : p) v = turn * v + glm::dvec3(1, 2, 3);
    }
    const GlbFile one = read_glb(written(clip_of(places), "a.glb"));
    const GlbFile two = read_glb(written(clip_of(turned), "a.glb"));
    for (std::size_t n = 0; n < 25; ++n) {
        const auto a = one.rotations(n), b = two.rotations(n);
        ASSERT_EQ(a.size(), b.size());
        for (std::size_t i = 0; i < a.size(); ++i) {
            EXPECT_LT(angle_between(n == 0 ? turn * a[i] : a[i], b[i]), 2e-3) << n;
        }
    }
}

TEST(Twist, TheTrunkFollowsHipsAndShoulders) {
    const MotionClip clip = synthetic_clip(Motion::turn);
    const Places places = world_places(clip);
    const GlbFile file = read_glb(written(clip, "a.glb"));
    for (std::size_t i = 0; i < places.size(); i += 37) {
        const auto turns = turns_at(file, i);
        const auto& p = places[i];
        const auto expect_frame = [](const glm::dquat& q, const glm::dvec3& y,
                                     const glm::dvec3& x) {
            EXPECT_LT(glm::length(q * glm::dvec3(0, 1, 0) - glm::normalize(y)), 1e-4);
            EXPECT_NEAR(glm::dot(q * glm::dvec3(0, 0, 1), x), 0, 1e-4);
            EXPECT_GT(glm::dot(q * glm::dvec3(1, 0, 0), x), 0);
        };
        expect_frame(turns.at("hip_center"), p[1] - p[0], p[12] - p[16]);
        expect_frame(turns.at("spine"), p[2] - p[1], p[4] - p[8]);
    }
}

TEST(Twist, EveryOtherBoneTurnsByTheLeastRotationFromItsReference) {
    struct Rule {
        const char *node, *reference;
        glm::dvec3 rest;
    };
    const glm::dvec3 up(0, 1, 0), left(1, 0, 0), ahead(0, 0, 1), hip(std::sqrt(0.75), -0.5, 0);
    const Rule rules[] = {
        {"neck", "spine", up},
        {"clavicle_left", "spine", left},
        {"shoulder_left", "spine", left},  // not the clavicle: a shrug does not twist the arm
        {"elbow_left", "shoulder_left", left},
        {"wrist_left", "elbow_left", left},
        {"shoulder_right", "spine", -left},
        {"elbow_right", "shoulder_right", -left},
        {"pelvis_left", "hip_center", hip},
        {"hip_left", "hip_center", -up},
        {"knee_left", "hip_left", -up},
        {"ankle_left", "knee_left", ahead},
        {"hip_right", "hip_center", -up},
        {"ankle_right", "knee_right", ahead},
    };
    for (const MotionClip& clip : {synthetic_clip(Motion::dance, 90), random_clip(21, 90)}) {
        const GlbFile file = read_glb(written(clip, "a.glb"));
        for (std::size_t i = 0; i < 90; i += 11) {
            const auto turns = turns_at(file, i);
            for (const Rule& rule : rules) {
                const glm::dquat q = glm::conjugate(turns.at(rule.reference)) * turns.at(rule.node);
                // The least rotation's axis is across the bone.
                EXPECT_NEAR(glm::dot(glm::dvec3(q.x, q.y, q.z), rule.rest), 0, 1e-5) << rule.node;
            }
        }
    }
}

}  // namespace
}  // namespace kino::test
