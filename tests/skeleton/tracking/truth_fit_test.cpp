// The fit on true masks and true parts: what is left is the model's own error.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "skeleton/forest/body_part.h"
#include "skeleton/forest/training_images.h"
#include "tests/skeleton/tracking/eval/truth_tracker.h"

namespace kino {
namespace {

using glm::vec3;
using namespace test;

Take take_of(const std::string& motion, std::uint64_t seed) {
    ActorTake options;
    options.motion = motion;
    options.seed = seed;
    options.distance_m = 2.4;
    Result<Take> take = actor_take(options);
    EXPECT_TRUE(take);
    return std::move(*take);
}

struct Errors {
    std::vector<float> visible, all;
    [[nodiscard]] static float mean(const std::vector<float>& v) {
        float sum = 0;
        for (const float e : v) sum += e;
        return v.empty() ? 0 : sum / static_cast<float>(v.size());
    }
    [[nodiscard]] static float quantile(std::vector<float> v, double q) {
        std::ranges::sort(v);
        return v[static_cast<std::size_t>(q * static_cast<double>(v.size() - 1))];
    }
};

void collect(const Body& truth, const Body& found, Errors& errors) {
    for (std::size_t j = 0; j < kJointCount; ++j) {
        ASSERT_TRUE(std::isfinite(glm::length(found.joints[j].position_m)));
        const float e = 1000 * glm::length(found.joints[j].position_m - truth.joints[j].position_m);
        errors.all.push_back(e);
        if (truth.joints[j].state == JointState::tracked) errors.visible.push_back(e);
    }
}

TEST(TruthFit, MovingArmsAreFollowedWithinThreeCentimetres) {
    Errors errors;
    for (const std::uint64_t seed : {3u, 8u}) {
        const Take take = take_of("arms", seed);
        TruthTracker tracker(take.rays);
        TakeFrame frame;
        for (int i = 0; i < 150; i += 3) {
            take.render(i, frame);
            const BodyFrame found = tracker.track(frame);
            ASSERT_EQ(found.bodies.size(), 1u);
            collect(frame.truth.bodies[0], found.bodies[0], errors);
        }
    }
    EXPECT_LT(Errors::mean(errors.visible), 30);
    EXPECT_LT(Errors::quantile(errors.all, 0.97), 120);
}

TEST(TruthFit, WhoTurnsRoundStaysHimself) {
    Errors errors;
    const Take take = take_of("turn", 5);
    TruthTracker tracker(take.rays);
    TakeFrame frame;
    for (int i = 0; i < 300; i += 3) {
        take.render(i, frame);
        const BodyFrame found = tracker.track(frame);
        ASSERT_EQ(found.bodies.size(), 1u);
        collect(frame.truth.bodies[0], found.bodies[0], errors);
    }
    EXPECT_LT(Errors::mean(errors.visible), 35);
    EXPECT_LT(Errors::quantile(errors.visible, 0.97), 90);
    EXPECT_LT(Errors::quantile(errors.all, 0.9), 130);
}

TEST(TruthFit, BoneLengthsHoldAfterThreeSeconds) {
    const Take take = take_of("dance", 4);
    TruthTracker tracker(take.rays);
    TakeFrame frame;
    std::array<float, kJointCount> least{}, most{};
    least.fill(1e9f);
    const int end = std::min(take.frames, 240);
    for (int i = 0; i < end; ++i) {
        take.render(i, frame);
        const BodyFrame found = tracker.track(frame);
        if (i < 95) continue;
        for (std::size_t j = 1; j < kJointCount; ++j) {
            const auto parent = static_cast<std::size_t>(kJointParent[j]);
            const float length = glm::length(found.bodies[0].joints[j].position_m -
                                             found.bodies[0].joints[parent].position_m);
            least[j] = std::min(least[j], length);
            most[j] = std::max(most[j], length);
        }
    }
    for (std::size_t j = 1; j < kJointCount; ++j) {
        EXPECT_LT((most[j] - least[j]) / least[j], 0.03f) << joint_name(static_cast<Joint>(j));
    }
}

TEST(TruthFit, SameFramesGiveTheSameBits) {
    const Take take = take_of("arms", 6);
    TruthTracker a(take.rays), b(take.rays);
    TakeFrame frame;
    for (int i = 0; i < 40; ++i) {
        take.render(i, frame);
        const BodyFrame x = a.track(frame), y = b.track(frame);
        for (std::size_t j = 0; j < kJointCount; ++j) {
            ASSERT_EQ(x.bodies[0].joints[j].position_m, y.bodies[0].joints[j].position_m);
            ASSERT_EQ(x.bodies[0].joints[j].confidence, y.bodies[0].joints[j].confidence);
        }
    }
}

std::size_t mirrored_joint(std::size_t j) {
    if (j < 4) return j;
    return (j - 4) / 4 % 2 == 0 ? j + 4 : j - 4;
}

TEST(TruthFit, AMirroredPictureGivesTheMirroredBody) {
    const Take take = take_of("arms", 7);
    const int w = take.rays.width(), h = take.rays.height();
    Image<RayXy> rays(w, h);
    for (int y = 0; y < h; ++y) {
        for (int x = 0; x < w; ++x) {
            const RayXy& ray = take.rays.at(w - 1 - x, y);
            rays.at(x, y) = {-ray.x, ray.y};
        }
    }
    TruthTracker straight(take.rays), flipped(rays);
    TakeFrame frame, mirror;
    std::vector<float> apart;
    for (int i = 0; i < 60; i += 2) {
        take.render(i, frame);
        mirror = frame;
        for (int y = 0; y < h; ++y) {
            for (int x = 0; x < w; ++x) {
                mirror.depth_m.at(x, y) = frame.depth_m.at(w - 1 - x, y);
                mirror.actor.at(x, y) = frame.actor.at(w - 1 - x, y);
                const std::uint8_t part = frame.part.at(w - 1 - x, y);
                mirror.part.at(x, y) =
                    part == kNotBody
                        ? part
                        : static_cast<std::uint8_t>(mirrored(static_cast<BodyPart>(part)));
            }
        }
        const Body a = straight.track(frame).bodies.at(0), b = flipped.track(mirror).bodies.at(0);
        for (std::size_t j = 0; j < kJointCount; ++j) {
            vec3 p = b.joints[mirrored_joint(j)].position_m;
            p.x = -p.x;
            apart.push_back(1000 * glm::length(p - a.joints[j].position_m));
        }
    }
    // The grid of pixels that are labelled is not mirrored, so the points differ.
    EXPECT_LT(Errors::quantile(apart, 0.5), 5);
    EXPECT_LT(Errors::quantile(apart, 0.95), 20);
}

}  // namespace
}  // namespace kino
