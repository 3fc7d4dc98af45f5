#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

#include "calibration/projection.h"
#include "fake_kinect.h"
#include "sensor/kinect1/color_fit.h"
#include "sensor/kinect1/factory_rig.h"
#include "sensor/kinect1/registration_map.h"
#include "support/random.h"

namespace kino::kinect1 {
namespace {

FactoryData real_unit() {
    FactoryData data;
    data.zero_plane = parse_zero_plane(test::zero_plane_block(7.5F, 2.3F, 120, 0.1042F));
    data.registration = parse_registration(test::real_registration_block());
    data.const_shift = std::uint16_t{200};
    return data;
}

TEST(FactoryData, RealBlocksParse) {
    const FactoryData data = real_unit();
    ASSERT_TRUE(data.zero_plane && data.registration);
    EXPECT_NEAR(data.zero_plane->reference_pixel_size_mm, 0.1042, 1e-6);
    EXPECT_EQ(data.registration->ax, 1964);
    EXPECT_EQ(data.registration->dx_start, 6161);
    EXPECT_EQ(data.registration->dydydy_start, 134214659);
}

TEST(FactoryData, ImplausibleOrCutBlocksAreRefused) {
    EXPECT_FALSE(parse_zero_plane(test::zero_plane_block(0, 2.3F, 120, 0.1042F)));
    EXPECT_FALSE(parse_zero_plane(test::zero_plane_block(7.5F, NAN, 120, 0.1042F)));
    EXPECT_FALSE(parse_zero_plane(test::zero_plane_block(7.5F, 2.3F, 1e30F, 0.1042F)));
    EXPECT_FALSE(parse_zero_plane(test::Bytes(109)));
    EXPECT_FALSE(parse_registration(test::Bytes(118)));
    EXPECT_FALSE(parse_registration(test::Bytes(117, 1)));
    EXPECT_FALSE(parse_padding(test::Bytes(6)));
    EXPECT_FALSE(parse_const_shift(test::Bytes{0, 0, 0, 0}));
    EXPECT_EQ(parse_const_shift(test::Bytes{0, 0, 200, 0}), 200);
}

// The polynomial in closed form: third differences are the block's a, b, c, d, so a table of
// second and third differences must be what the block says, everywhere.
TEST(RegistrationMap, IsACubicWhoseThirdDifferencesAreTheBlocks) {
    const FactoryData data = real_unit();
    const RegistrationMap map(*data.registration, {}, *data.zero_plane);
    const auto x = [&](int c, int r) { return map.displacement(c, r).x; };
    const auto y = [&](int c, int r) { return map.displacement(c, r).y; };
    // Over 64 pixels the third difference along a row is 64^3 a / (2^8 2^6 2^17).
    const double unit = 64.0 * 64 * 64 / (256.0 * 64 * 131072);
    // Every one of the 64 steps rounds down twice, which bounds what the integers add.
    const double slack = 8 * 64.0 * (1 + 64.0) / 131072;
    for (const int r : {0, 200, 479}) {
        for (const int c : {0, 250, 440}) {
            const double along = x(c + 192, r) - 3 * x(c + 128, r) + 3 * x(c + 64, r) - x(c, r);
            EXPECT_NEAR(along, data.registration->ax * unit, slack);
            const double along_y = y(c + 192, r) - 3 * y(c + 128, r) + 3 * y(c + 64, r) - y(c, r);
            EXPECT_NEAR(along_y, data.registration->ay * unit, slack);
        }
    }
    for (const int c : {0, 320, 639}) {
        const double down = y(c, 392) - 3 * y(c, 328) + 3 * y(c, 264) - y(c, 200);
        EXPECT_NEAR(down, data.registration->by * unit, slack);
    }
}

TEST(RegistrationMap, NearerPointsMoveLeftByTheBaseline) {
    const FactoryData data = real_unit();
    const RegistrationMap map(*data.registration, {}, *data.zero_plane);
    const double focal = 120 / (2 * 0.1042);
    const double moved = map.at(320, 240, 1).x - map.at(320, 240, 2).x;
    EXPECT_NEAR(moved, -focal * 0.023 * (1 / 1.0 - 1 / 2.0), 0.01);
    EXPECT_EQ(map.at(320, 240, 1).y, map.at(320, 240, 2).y);
}

TEST(ColorFit, FindsTheCameraThatMadeTheMap) {
    CameraModel depth{.width = 640, .height = 480, .fx = 575, .fy = 575, .cx = 319.5, .cy = 239.5};
    CameraModel color{.width = 640,
                      .height = 480,
                      .fx = 528,
                      .fy = 525,
                      .cx = 327,
                      .cy = 252,
                      .k1 = 0.2,
                      .k2 = -0.5,
                      .p1 = 0.001,
                      .p2 = -0.002};
    const Pose pose{glm::angleAxis(0.008, glm::normalize(glm::dvec3(1, 2, -1))),
                    {-0.0251, 0.0004, 0.0008}};
    const Projection depth_projection(depth);
    const Projection color_projection(color);
    const auto map = [&](int x, int y, double z) {
        const auto ray = depth_projection.unproject({x, y});
        return color_projection.project(pose * (glm::dvec3(*ray, 1) * z)).value();
    };
    const ColorFit fit = fit_color_camera(map, depth, 640, 480, 0.025);
    // The expectations of rotation and translation pull a little.
    EXPECT_LT(fit.rms_px, 0.01);
    EXPECT_LT(fit.max_px, 0.05);
    EXPECT_NEAR(fit.color.fx, color.fx, 0.5);
    EXPECT_NEAR(fit.color.k1, color.k1, 0.01);
    EXPECT_NEAR(fit.color_from_depth.translation.x, pose.translation.x, 0.0003);
}

TEST(FactoryRig, OfARealUnitIsNearItsTables) {
    const FactoryData data = real_unit();
    const RigParameters rig = factory_rig(data, CameraMode::color_bayer, "A1");
    ASSERT_TRUE(validate(rig));
    EXPECT_EQ(rig.note.substr(0, 19), "factory calibration") << rig.note;
    RecordProperty("note", rig.note);
    EXPECT_NEAR(rig.depth.fx, 575.8, 0.1);
    EXPECT_NEAR(rig.color_from_depth.translation.x, -0.025, 0.004);
    // Not only on the grid that was fitted.
    const RegistrationMap map(*data.registration, data.padding, *data.zero_plane);
    const Projection depth(rig.depth);
    const Projection color(*rig.color);
    test::Random random(3);
    double sum = 0;
    int n = 0;
    while (n < 2000) {
        const int x = random.integer(0, 639);
        const int y = random.integer(0, 479);
        const double z = random.real(0.6, 6);
        const glm::dvec2 expected = map.at(x, y, z);
        if (expected.x < 0 || expected.x > 639 || expected.y < 0 || expected.y > 479) continue;
        const auto got =
            color.project(rig.color_from_depth * (glm::dvec3(*depth.unproject({x, y}), 1) * z));
        ASSERT_TRUE(got);
        sum += glm::dot(*got - expected, *got - expected);
        ++n;
    }
    EXPECT_LT(std::sqrt(sum / n), 1.0);
    RecordProperty("held_out_rms_px", std::to_string(std::sqrt(sum / n)));
}

TEST(FactoryRig, HighResolutionSeesTheSamePoints) {
    const RigParameters low = factory_rig(real_unit(), CameraMode::color_bayer, "");
    const RigParameters high = factory_rig(real_unit(), CameraMode::color_bayer_high, "");
    const Projection a(*low.color);
    const Projection b(*high.color);
    for (const glm::dvec3 point : {glm::dvec3(0, 0, 1), glm::dvec3(0.4, -0.3, 1)}) {
        const glm::dvec2 small = a.project(point).value();
        const glm::dvec2 large = b.project(point).value();
        // Edges keep their place: (small + 1/2) 2 = large + 1/2, and 32 lines more on top.
        EXPECT_NEAR((small.x + 0.5) * 2, large.x + 0.5, 1e-9);
        EXPECT_NEAR((small.y + 0.5) * 2 + 32, large.y + 0.5, 1e-9);
    }
    EXPECT_EQ(high.color->height, 1024);
}

TEST(FactoryRig, FallsBackAndSaysSo) {
    FactoryData data = real_unit();
    data.registration.reset();
    data.problems = "registration: no answer";
    data.zero_plane->emitter_distance_cm = 7.4;
    const RigParameters rig = factory_rig(data, CameraMode::color_bayer, "A1");
    EXPECT_EQ(rig.color, default_kinect1_rig().color);
    EXPECT_EQ(rig.disparity.emitter_distance_cm, 7.4);
    EXPECT_NE(rig.note.find("default cameras"), std::string::npos);
    EXPECT_NE(rig.note.find("registration: no answer"), std::string::npos);
}

TEST(FactoryRig, NonsenseInTheBlockIsNotACamera) {
    test::Random random(5);
    for (int i = 0; i < 10; ++i) {
        FactoryData data = real_unit();
        data.registration->dx_start = static_cast<std::int32_t>(random.bits());
        data.registration->dxdx_start = static_cast<std::int32_t>(random.bits());
        data.registration->ay = static_cast<std::int32_t>(random.bits());
        const RigParameters rig = factory_rig(data, CameraMode::color_bayer, "");
        EXPECT_TRUE(validate(rig));
        EXPECT_NE(rig.note.find("no camera comes near"), std::string::npos) << rig.note;
    }
}

}  // namespace
}  // namespace kino::kinect1
