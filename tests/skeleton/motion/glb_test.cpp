#include <gtest/gtest.h>

#include <glm/geometric.hpp>

#include "tests/skeleton/motion/glb_reader.h"
#include "tests/skeleton/motion/test_clips.h"

namespace kino::test {
namespace {

GlbFile glb_of(const MotionClip& clip, MotionSummary* summary = nullptr) {
    return read_glb(written(clip, "a.glb", summary));
}

void expect_positions(const MotionClip& clip, std::size_t step) {
    const GlbFile file = glb_of(clip);
    const Places wanted = normalized(world_places(clip));
    ASSERT_EQ(file.times().size(), wanted.size());
    for (std::size_t i = 0; i < wanted.size(); i += step) {
        EXPECT_LT(largest_error_m(file.positions(i), 1, wanted[i]), 2e-5);
    }
}

TEST(Glb, GivesThePositionsOfEveryMotionBack) {
    for (const Motion motion : all_motions()) expect_positions(synthetic_clip(motion, 120), 29);
}

TEST(Glb, GivesRandomPosesAndOneFrameBack) {
    expect_positions(random_clip(3, 40), 7);
    expect_positions(synthetic_clip(Motion::squat, 1), 1);
}

TEST(Glb, RotationsAreOfUnitLengthAndNeverFlip) {
    const auto check = [](const MotionClip& clip, double least) {
        const GlbFile file = glb_of(clip);
        std::size_t animated = 0;
        for (std::size_t n = 0; n < file.json["nodes"].size(); ++n) {
            const auto turns = file.rotations(n);
            animated += turns.empty() ? 0 : 1;
            for (std::size_t i = 0; i < turns.size(); ++i) {
                EXPECT_NEAR(glm::dot(turns[i], turns[i]), 1, 1e-6);
                EXPECT_GE(glm::dot(turns[i], turns[i == 0 ? 0 : i - 1]), least);
            }
        }
        EXPECT_EQ(animated, 19U);  // one a bone
    };
    // Real motion at 30 Hz is far from a quarter turn on the quaternions' sphere (cosine 0).
    for (const Motion motion : all_motions()) check(synthetic_clip(motion), 0.8);
    check(random_clip(9, 300), 0);
    // Half turns of the whole person: the product is 0, whose sign is rounding's.
    const Places random = world_places(random_clip(12, 100));
    Places turning;
    for (const auto& p : random) {
        turning.push_back(p);
        auto& turned = turning.emplace_back(p);
        for (glm::dvec3& v : turned) v = {-v.x, v.y, -v.z};
    }
    check(clip_of(turning), 0);
}

TEST(Glb, TheMeshFollowsTheBones) {
    const MotionClip clip = synthetic_clip(Motion::dance, 60);
    const GlbFile file = glb_of(clip);
    const auto nodes = file.positions(50);
    const auto vertices = file.skinned(50);
    // Each joint that a bone ends in is a corner of that bone's solid.
    for (std::size_t j = 0; j < kJointCount; ++j) {
        const glm::dvec3 joint = nodes.at(joint_name(static_cast<Joint>(j)));
        double nearest = 1;
        for (const glm::dvec3& v : vertices) nearest = std::min(nearest, glm::distance(v, joint));
        EXPECT_LT(nearest, 1e-5) << joint_name(static_cast<Joint>(j));
    }
    // 19 bones and 5 tips of 6 corners; every triangle looks away from its solid's middle.
    ASSERT_EQ(vertices.size(), 24U * 6);
    const auto& primitive = file.json["meshes"][0]["primitives"][0];
    const auto indices = file.values(primitive["indices"]);
    ASSERT_EQ(indices.size(), 24U * 24);
    for (std::size_t t = 0; t < indices.size(); t += 3) {
        const auto corner = [&](std::size_t k) {
            return vertices[static_cast<std::size_t>(indices[t + k])];
        };
        const std::size_t solid = static_cast<std::size_t>(indices[t]) / 6 * 6;
        glm::dvec3 middle(0);
        for (std::size_t k = 0; k < 6; ++k) middle += vertices[solid + k] / 6.0;
        const glm::dvec3 normal = glm::cross(corner(1) - corner(0), corner(2) - corner(0));
        EXPECT_GT(glm::dot(normal, corner(0) - middle), 0);
    }
}

TEST(Glb, TimesAreTheRateAndTheSkinNamesEveryNode) {
    MotionClip clip = synthetic_clip(Motion::wave, 61);
    clip.rate_hz = 12.5;
    MotionSummary summary;
    const GlbFile file = glb_of(clip, &summary);
    const auto times = file.times();
    ASSERT_EQ(times.size(), 26U);  // 2 s
    EXPECT_EQ(summary.frames, 26U);
    for (std::size_t i = 0; i < times.size(); ++i)
        EXPECT_NEAR(times[i], 0.08 * static_cast<double>(i), 1e-6);
    EXPECT_EQ(file.json["skins"][0]["joints"].size(), 25U);
    EXPECT_EQ(file.json["nodes"].size(), 26U);
}

}  // namespace
}  // namespace kino::test
