#include <gmock/gmock.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

#include "calibration/disparity.h"
#include "calibration/solve/depth_fit.h"
#include "calibration/solve/edge_alignment.h"
#include "calibration/solve/plane_check.h"
#include "tests/calibration/solve/synthetic_boards.h"

namespace kino {
namespace {

using testing::HasSubstr;

RigParameters small_rig() {
    RigParameters rig = default_kinect1_rig(160, 120);
    rig.color.reset();
    return rig;
}

Image<RayXy> rays_of(const RigParameters& rig) {
    auto made = Rig::create(rig);
    return made->depth_rays();
}

Pose board_at(double z, double tilt, double x = 0, double y = 0) {
    const glm::dquat rotation = glm::angleAxis(tilt, glm::dvec3(0, 1, 0));
    return {rotation, glm::dvec3(x, y, z) - rotation * glm::dvec3(0.15, 0.1, 0)};
}

constexpr glm::dvec2 kFar(0.3, 0.2);

// A depth image that shows the board's plane everywhere, through any function of the true depth.
template <class Reading>
std::vector<DepthSample> seen(const RigParameters& rig, const Pose& pose, Reading reading) {
    const Image<RayXy> rays = rays_of(rig);
    Image<float> depth(rig.depth.width, rig.depth.height, 1);
    const glm::dvec3 normal = pose.rotation * glm::dvec3(0, 0, 1);
    for (int y = 0; y < depth.height(); ++y) {
        for (int x = 0; x < depth.width(); ++x) {
            const glm::dvec3 ray(rays.at(x, y).x, rays.at(x, y).y, 1);
            const double z = glm::dot(normal, pose.translation) / glm::dot(normal, ray);
            depth.at(x, y) = static_cast<float>(reading(x, y, z));
        }
    }
    return samples_on_board(depth, rays, pose, kFar);
}

TEST(DepthSamples, TrueDepthIsThatOfThePlane) {
    const auto samples =
        seen(small_rig(), board_at(0.8, 0.4), [](int, int, double z) { return z; });
    EXPECT_GT(samples.size(), 1000u);
    for (const DepthSample& s : samples) EXPECT_NEAR(s.measured, s.true_m, 1e-6);
    EXPECT_NEAR(*depth_scale(samples), 1, 1e-6);
    EXPECT_FALSE(scale_complaint(samples, 0.025));
    EXPECT_TRUE(
        seen(small_rig(), board_at(0.8, 1.45), [](int, int, double z) { return z; }).empty());
}

TEST(DepthSamples, WrongSquareSizeIsNamedWithTheRightOne) {
    // The true board is 1.2 times as large and as far as the solve believes.
    const auto samples =
        seen(small_rig(), board_at(0.8, 0.3), [](int, int, double z) { return 1.2 * z; });
    EXPECT_EQ(scale_complaint(samples, 0.025).value_or(""),
              "the depth says that the squares are 30.0 mm, not 25.0 mm");
}

TEST(DisparityFit, FindsTheDeviceBehindRoundedReadings) {
    DisparityParameters truth;
    truth.const_shift = 203.5;
    truth.reference_distance_cm = 118.2;
    const Disparity device(truth);
    std::vector<DepthSample> samples;
    for (const double z : {0.5, 0.8, 1.3, 2.1, 3.0}) {
        const auto more = seen(small_rig(), board_at(z, 0.3),
                               [&](int, int, double depth) { return device.raw(depth); });
        samples.insert(samples.end(), more.begin(), more.end());
    }
    // Some pixels see something else.
    for (std::size_t i = 0; i < samples.size(); i += 97) samples[i].measured += 60;
    const auto fit = fit_disparity(samples, {});
    ASSERT_TRUE(fit) << fit.error().to_string();
    EXPECT_LT(fit->rms_steps, 0.35);  // rounding alone: 0.29
    const Disparity found(fit->parameters);
    for (const double z : {0.5, 1.0, 2.0, 3.0}) {
        EXPECT_NEAR(*found.metres(*device.raw_exact(z)), z, 0.002 * z * z) << z;
    }
    EXPECT_NEAR(fit->parameters.const_shift, truth.const_shift, 0.2);
}

TEST(DisparityFit, OneDistanceIsNotEnough) {
    const Disparity device;
    const auto samples = seen(small_rig(), board_at(1.0, 0.1),
                              [&](int, int, double depth) { return device.raw(depth); });
    const auto fit = fit_disparity(samples, {});
    ASSERT_FALSE(fit);
    EXPECT_THAT(fit.error().to_string(), HasSubstr("all boards are at about one distance"));
    EXPECT_FALSE(fit_disparity({}, {}));
}

TEST(DepthBias, TakesAwayWhatVariesOverThePicture) {
    const RigParameters rig = small_rig();
    const auto bias = [](int x, int y) { return 0.02 * (x - 80) / 80.0 + 0.01 * (y - 60) / 60.0; };
    const auto reading = [&](int x, int y, double z) { return 1 / (1 / z + bias(x, y)); };
    std::vector<DepthSample> samples;
    for (const double x : {-0.12, 0.0, 0.12}) {
        for (const double y : {-0.09, 0.0, 0.09}) {
            const auto more = seen(rig, board_at(0.7, 0.2, x, y), reading);
            samples.insert(samples.end(), more.begin(), more.end());
        }
    }
    const auto map = fit_bias(samples, 160, 120, 16, 12);
    ASSERT_TRUE(map) << map.error().to_string();
    // At another distance than it was made at.
    Image<float> depth(160, 120);
    for (int y = 0; y < 120; ++y) {
        for (int x = 0; x < 160; ++x) depth.at(x, y) = static_cast<float>(reading(x, y, 2.0));
    }
    depth.at(3, 3) = 0;
    EXPECT_GT(map->rms_before_mm, 3 * map->rms_after_mm);
    map->bias.correct(depth);
    EXPECT_EQ(depth.at(3, 3), 0);
    double before = 0;
    double after = 0;
    // Where boards were on all sides.
    for (int y = 32; y < 88; ++y) {
        for (int x = 35; x < 125; ++x) {
            before = std::max(before, std::abs(reading(x, y, 2.0) - 2));
            after = std::max<double>(after, std::abs(depth.at(x, y) - 2));
        }
    }
    EXPECT_LT(after, 0.15 * before);
    EXPECT_FALSE(fit_bias({}, 160, 120));
}

TEST(PlaneCheck, FlatPartsHaveTheNoiseThatWasPutIn) {
    const RigParameters rig = small_rig();
    const Image<RayXy> rays = rays_of(rig);
    test::Random random(1);
    std::vector<FlatPart> parts;
    for (const double distance : {1.1, 2.6}) {
        Image<float> depth(160, 120);
        for (float& z : depth.pixels()) {
            z = static_cast<float>(distance + 0.001 * distance * test::normal(random));
        }
        for (int x = 0; x < 160; ++x) depth.at(x, 10) = 0.6f;  // something in front
        const auto more = flat_parts(depth, rays);
        parts.insert(parts.end(), more.begin(), more.end());
    }
    const auto bands = by_distance(parts);
    ASSERT_EQ(bands.size(), 2u);
    EXPECT_NEAR(bands[0].distance_m, 1.1, 0.01);
    EXPECT_NEAR(bands[0].rms_mm, 1.1, 0.15);
    EXPECT_NEAR(bands[1].rms_mm, 2.6, 0.3);
    // Two rows of five tiles: the first row has the thing in it.
    EXPECT_EQ(bands[0].planes, 10);
}

// A dark square before a bright wall; the colour picture is moved by some pixels.
TEST(EdgeAlignment, FindsHowFarColourHasSlid) {
    for (const auto& [dx, dy] : {std::pair(0, 0), std::pair(5, -3), std::pair(-8, 2)}) {
        Image<float> depth(160, 120, 2.0f);
        Image<ColorUv> uv(160, 120);
        Image<std::uint8_t> grey(160, 120, 200);
        test::Random random(7);
        for (auto& value : grey.pixels())
            value = static_cast<std::uint8_t>(random.integer(190, 210));
        for (int y = 0; y < 120; ++y) {
            for (int x = 0; x < 160; ++x) {
                uv.at(x, y) = {static_cast<std::uint16_t>(x << kUvFractionBits),
                               static_cast<std::uint16_t>(y << kUvFractionBits)};
                const auto in = [](int a, int b) {
                    return a >= 40 && a < 110 && b >= 30 && b < 90;
                };
                if (in(x, y)) depth.at(x, y) = 1.0f;
                if (in(x - dx, y - dy))
                    grey.at(x, y) = static_cast<std::uint8_t>(random.integer(40, 60));
            }
        }
        const auto found = edge_alignment(depth, uv, grey);
        ASSERT_TRUE(found);
        EXPECT_NEAR(found->dx_px, dx, 0.6);
        EXPECT_NEAR(found->dy_px, dy, 0.6);
        EXPECT_GT(found->sharpness, 3);
    }
    const Image<float> flat(160, 120, 2.0f);
    EXPECT_FALSE(
        edge_alignment(flat, Image<ColorUv>(160, 120, {0, 0}), Image<std::uint8_t>(160, 120)));
}

}  // namespace
}  // namespace kino
