#include "calibration/rig.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <limits>
#include <numbers>

#include "calibration/projection.h"
#include "tests/calibration/rig_samples.h"

namespace kino {
namespace {

DepthFrame flat(int width, int height, std::uint16_t mm) {
    DepthFrame frame;
    frame.raw = Image<std::uint16_t>(width, height, mm);
    return frame;
}

RegisteredDepth registered(const RigParameters& parameters, const DepthFrame& frame,
                           RigOptions options = {}) {
    Rig rig = Rig::create(parameters, options).value();
    RegisteredDepth out;
    EXPECT_TRUE(rig.register_depth(frame, out));
    return out;
}

bool any_valid(const Image<ColorUv>& uv) {
    return std::ranges::any_of(uv.pixels(), [](ColorUv p) { return p.valid(); });
}
bool any_positive(const Image<float>& image) {
    return std::ranges::any_of(image.pixels(), [](float z) { return z > 0; });
}
double pixels(std::uint16_t fixed) {
    return fixed / 16.0;
}

template <class T>
bool same_bits(const Image<T>& a, const Image<T>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
}

TEST(Rig, OneCameraForBothIsTheIdentity) {
    RigSamples samples(1);
    for (const bool distorted : {false, true}) {
        RigParameters parameters;
        parameters.depth = distorted ? samples.camera(133, 97) : samples.plain_camera(133, 97);
        parameters.color = parameters.depth;
        const DepthFrame frame = samples.room(133, 97);
        for (const bool simd : {false, true}) {
            const RegisteredDepth out = registered(parameters, frame, {.simd = simd});
            int seen = 0;
            for (int y = 0; y < 97; ++y) {
                for (int x = 0; x < 133; ++x) {
                    if (out.depth_m.at(x, y) == 0) {
                        EXPECT_FALSE(out.uv.at(x, y).valid());
                        continue;
                    }
                    ASSERT_TRUE(out.uv.at(x, y).valid());
                    EXPECT_EQ(out.uv.at(x, y).u, 16 * x);
                    EXPECT_EQ(out.uv.at(x, y).v, 16 * y);
                    ++seen;
                }
            }
            EXPECT_GT(seen, 5000);
            EXPECT_EQ(out.depth_in_color_m, out.depth_m);
        }
    }
}

TEST(Rig, ParallaxTableOfTheKinect) {
    const RigParameters parameters = default_kinect1_rig();
    const double metres[] = {0.5, 1, 2, 4};
    const double shift_px[] = {26.6, 13.3, 6.6, 3.3};
    for (int i = 0; i < 4; ++i) {
        const auto mm = static_cast<std::uint16_t>(metres[i] * 1000);
        const RegisteredDepth out = registered(parameters, flat(640, 480, mm));
        // Where the same ray would land from infinitely far.
        const Projection color(*parameters.color);
        const Projection depth(parameters.depth);
        const glm::dvec2 far = *color.project({*depth.unproject({400, 200}), 1});
        const ColorUv uv = out.uv.at(400, 200);
        ASSERT_TRUE(uv.valid());
        EXPECT_NEAR((far.x - pixels(uv.u)) / shift_px[i], 1, 0.02) << metres[i];
        EXPECT_NEAR(pixels(uv.v), far.y, 0.04);
    }
}

TEST(Rig, Depth0OrRaw2047Or0xFFFF) {
    RigSamples samples(2);
    const RigParameters parameters = samples.rig(64, 48);
    for (const bool simd : {false, true}) {
        for (const std::uint16_t raw : {std::uint16_t{0}, std::uint16_t{0xFFFF}}) {
            DepthFrame frame = flat(64, 48, raw);
            for (const double unit : {0.001, 1e-5, 1e-9}) {
                frame.metres_per_unit = unit;
                const RegisteredDepth out = registered(parameters, frame, {.simd = simd});
                EXPECT_FALSE(any_positive(out.depth_m));
                EXPECT_FALSE(any_valid(out.uv));
                EXPECT_FALSE(any_positive(out.depth_in_color_m));
            }
        }
        for (const int raw : {2047, 2048, 2048 + 800, 0x7FFF, 0x8000, 0x8000 + 800, 0xFFFF}) {
            DepthFrame frame = flat(64, 48, static_cast<std::uint16_t>(raw));
            frame.unit = DepthUnit::kinect_disparity11;
            const RegisteredDepth out = registered(parameters, frame, {.simd = simd});
            EXPECT_FALSE(any_positive(out.depth_m)) << raw;
            EXPECT_FALSE(any_valid(out.uv)) << raw;
        }
    }
}

TEST(Rig, RangeLimitsAreInclusiveInWholeUnits) {
    RigParameters parameters = default_kinect1_rig(64, 48);
    parameters.min_depth_m = 0.4;
    parameters.max_depth_m = 8.0;
    for (const double unit : {0.001, 0.0002, 0.0001}) {
        DepthFrame frame = flat(64, 48, 0);
        frame.metres_per_unit = unit;
        const auto first = static_cast<int>(std::lround(0.4 / unit));
        const int last = std::min(static_cast<int>(std::lround(8.0 / unit)), 65534);
        const int raws[] = {first - 1, first, last, last + 1};
        for (int i = 0; i < 4; ++i) frame.raw.at(i, 0) = static_cast<std::uint16_t>(raws[i]);
        const RegisteredDepth out = registered(parameters, frame);
        EXPECT_EQ(out.depth_m.at(0, 0), 0.0f);
        EXPECT_NEAR(out.depth_m.at(1, 0), first * unit, 1e-6);
        EXPECT_NEAR(out.depth_m.at(2, 0), last * unit, 1e-6);
        EXPECT_EQ(out.depth_m.at(3, 0), 0.0f);
    }
}

TEST(Rig, ColourBehindCamera) {
    RigParameters parameters = default_kinect1_rig(64, 48);
    // Facing the other way: everything is behind it.
    parameters.color_from_depth.rotation = glm::angleAxis(std::numbers::pi, glm::dvec3(0, 1, 0));
    for (const bool simd : {false, true}) {
        RegisteredDepth out = registered(parameters, flat(64, 48, 2000), {.simd = simd});
        EXPECT_TRUE(any_positive(out.depth_m));
        EXPECT_FALSE(any_valid(out.uv));
        EXPECT_FALSE(any_positive(out.depth_in_color_m));
    }
    // Exactly in its plane: z = 0, not "very far to the side".
    parameters = default_kinect1_rig(64, 48);
    parameters.color_from_depth.translation = {0, 0, -2.0};
    EXPECT_FALSE(any_valid(registered(parameters, flat(64, 48, 2000)).uv));
    // Placed behind the scene and looking back at it, it does see it.
    parameters.color_from_depth.rotation = glm::angleAxis(std::numbers::pi, glm::dvec3(0, 1, 0));
    parameters.color_from_depth.translation = {0, 0, 4.0};
    const RegisteredDepth out = registered(parameters, flat(64, 48, 2000));
    EXPECT_TRUE(any_valid(out.uv));
    EXPECT_NEAR(std::ranges::max(out.depth_in_color_m.pixels()), 2.0f, 1e-5);
}

TEST(Rig, DistortionFoldsBackAtTheBorder) {
    RigParameters parameters;
    parameters.depth = RigSamples::folding_camera(160, 120);
    parameters.color = RigSamples::folding_camera(160, 120);
    parameters.color_from_depth.translation = {0.02, 0, 0};
    const double fold = Projection(parameters.depth).max_radius();
    Rig rig = Rig::create(parameters).value();
    RegisteredDepth out;
    ASSERT_TRUE(rig.register_depth(flat(160, 120, 1500), out));
    int without_ray = 0;
    for (int y = 0; y < 120; ++y) {
        for (int x = 0; x < 160; ++x) {
            const RayXy ray = rig.depth_rays().at(x, y);
            if (std::isnan(ray.x)) {
                ++without_ray;
                EXPECT_FALSE(out.uv.at(x, y).valid());
            } else {
                EXPECT_LE(std::hypot(ray.x, ray.y), fold * 1.000001);
            }
        }
    }
    EXPECT_GT(without_ray, 10);
    EXPECT_TRUE(std::isnan(rig.depth_rays().at(0, 0).x));
    // A wide plain depth camera sees points that the colour lens would fold back into its picture.
    parameters.depth = {.width = 160, .height = 120, .fx = 40, .fy = 40, .cx = 79.5, .cy = 59.5};
    out = registered(parameters, flat(160, 120, 1500));
    for (int y = 0; y < 120; ++y) {
        for (int x = 0; x < 160; ++x) {
            const double r = std::hypot((x - 79.5) / 40 + 0.02 / 1.5, (y - 59.5) / 40);
            if (r > fold * 1.0001) {
                EXPECT_FALSE(out.uv.at(x, y).valid()) << x << " " << y;
            }
        }
    }
}

TEST(Rig, ForegroundColourIsNotPrintedOnTheWall) {
    // A post 40 px wide at 1 m before a wall at 3 m: 25 mm to the side the colour camera misses
    // 13.3 - 4.4 px of wall at one edge of it.
    const RigParameters parameters = default_kinect1_rig();
    DepthFrame frame = flat(640, 480, 3000);
    for (int y = 0; y < 480; ++y) {
        for (int x = 300; x < 340; ++x) frame.raw.at(x, y) = 1000;
    }
    const RegisteredDepth out = registered(parameters, frame);
    const RegisteredDepth naive = registered(parameters, frame, {.occlusion_test = false});
    int hidden = 0;
    for (int x = 0; x < 640; ++x) {
        if (frame.raw.at(x, 200) == 1000) {
            EXPECT_TRUE(out.uv.at(x, 200).valid());
        }
        if (naive.uv.at(x, 200).valid() && !out.uv.at(x, 200).valid()) {
            ++hidden;
            EXPECT_EQ(frame.raw.at(x, 200), 3000);
        }
    }
    EXPECT_NEAR(hidden, 0.025 * 571.26 * (1 / 1.0 - 1 / 3.0), 1.6);
    EXPECT_EQ(naive.depth_in_color_m, out.depth_in_color_m);
}

TEST(Rig, FinerColourDoesNotShineThroughBetweenPoints) {
    // 320x240 depth under 640x480 colour: the post's points are two colour pixels apart.
    const RigParameters parameters = default_kinect1_rig(320, 240);
    DepthFrame frame = flat(320, 240, 3000);
    for (int y = 0; y < 240; ++y) {
        for (int x = 150; x < 170; ++x) frame.raw.at(x, y) = 1000;
    }
    const RegisteredDepth out = registered(parameters, frame);
    const RegisteredDepth naive = registered(parameters, frame, {.occlusion_test = false});
    const double expected_px = 0.025 * 285.63 * (1 / 1.0 - 1 / 3.0);
    for (int y = 20; y < 220; ++y) {
        int hidden = 0;
        for (int x = 0; x < 320; ++x) {
            if (naive.uv.at(x, y).valid() && !out.uv.at(x, y).valid()) ++hidden;
        }
        EXPECT_NEAR(hidden, expected_px, 1.6) << "row " << y;
    }
}

TEST(Rig, SmallStepsAreNoOcclusion) {
    // 30 mm and two steps: at 2 m that is 54.6 mm.
    RigParameters parameters = default_kinect1_rig();
    parameters.color_from_depth.translation.x = -0.2;
    for (const int behind_mm : {40, 70}) {
        DepthFrame frame = flat(640, 480, static_cast<std::uint16_t>(2000));
        for (int y = 0; y < 480; ++y) {
            for (int x = 320; x < 640; ++x) {
                frame.raw.at(x, y) = static_cast<std::uint16_t>(2000 - behind_mm);
            }
        }
        const RegisteredDepth out = registered(parameters, frame);
        const RegisteredDepth naive = registered(parameters, frame, {.occlusion_test = false});
        EXPECT_EQ(out.uv == naive.uv, behind_mm == 40);
    }
}

TEST(Rig, PortableAndSimdGiveTheSameBits) {
    RigSamples samples(7);
    for (int i = 0; i < 12; ++i) {
        // Odd sizes leave a rest that is no multiple of eight.
        const int width = 161 + 3 * i;
        RigParameters parameters = samples.rig(width, 121);
        if (i % 3 == 0) parameters.color = samples.plain_camera(width, 121);
        if (i % 4 == 1) parameters.color = samples.camera(2 * width + 1, 241);
        DepthFrame frame = samples.room(width, 121);
        if (i % 5 == 4) {
            frame.unit = DepthUnit::kinect_disparity11;
            for (auto& raw : frame.raw.pixels()) raw = static_cast<std::uint16_t>(raw % 2100);
        }
        const RegisteredDepth fast = registered(parameters, frame, {.simd = true});
        const RegisteredDepth plain = registered(parameters, frame, {.simd = false});
        EXPECT_TRUE(any_valid(fast.uv));
        EXPECT_TRUE(same_bits(fast.depth_m, plain.depth_m)) << i;
        EXPECT_TRUE(same_bits(fast.uv, plain.uv)) << i;
        EXPECT_TRUE(same_bits(fast.depth_in_color_m, plain.depth_in_color_m)) << i;
    }
}

TEST(Rig, FrameAfterFrameLeavesNothingBehind) {
    RigSamples samples(8);
    for (const int color_scale : {1, 2}) {
        RigParameters parameters = samples.rig(160, 120);
        parameters.color = samples.camera(160 * color_scale, 120 * color_scale);
        Rig rig = Rig::create(parameters).value();
        RegisteredDepth out;
        for (int i = 0; i < 4; ++i) {
            // A near frame before each room: what it leaves would hide the room.
            ASSERT_TRUE(rig.register_depth(flat(160, 120, 500), out));
            const DepthFrame frame = samples.room(160, 120);
            ASSERT_TRUE(rig.register_depth(frame, out));
            const RegisteredDepth fresh = registered(parameters, frame);
            EXPECT_TRUE(same_bits(out.depth_m, fresh.depth_m));
            EXPECT_TRUE(same_bits(out.uv, fresh.uv));
            EXPECT_TRUE(same_bits(out.depth_in_color_m, fresh.depth_in_color_m));
        }
    }
}

TEST(Rig, DepthOnlyHasNoColour) {
    RigParameters parameters = default_kinect1_rig(64, 48);
    parameters.color.reset();
    const RegisteredDepth out = registered(parameters, flat(64, 48, 1000));
    EXPECT_EQ(out.uv.size(), 64u * 48u);
    EXPECT_FALSE(any_valid(out.uv));
    EXPECT_TRUE(out.depth_in_color_m.empty());
    EXPECT_EQ(out.depth_m.at(3, 3), 1.0f);
}

TEST(Rig, RefusesWhatItCannotUse) {
    const RigParameters good = default_kinect1_rig(64, 48);
    Rig rig = Rig::create(good).value();
    RegisteredDepth out;
    EXPECT_FALSE(rig.register_depth(flat(63, 48, 1000), out));
    EXPECT_FALSE(rig.register_depth(flat(48, 64, 1000), out));
    EXPECT_FALSE(rig.register_depth(DepthFrame{}, out));
    for (const double unit : {0.0, -0.001, std::numeric_limits<double>::quiet_NaN(),
                              std::numeric_limits<double>::infinity()}) {
        DepthFrame frame = flat(64, 48, 1000);
        frame.metres_per_unit = unit;
        EXPECT_FALSE(rig.register_depth(frame, out));
        frame.unit = DepthUnit::kinect_disparity11;
        EXPECT_TRUE(rig.register_depth(frame, out));
    }
    RigParameters bad = good;
    bad.depth.fx = 0;
    EXPECT_FALSE(Rig::create(bad));
    bad = good;
    bad.color->width = 5000;
    EXPECT_FALSE(Rig::create(bad));
    EXPECT_FALSE(Rig::create(good, {.occlusion_margin_m = -1}));
    EXPECT_FALSE(
        Rig::create(good, {.occlusion_margin_m = std::numeric_limits<double>::quiet_NaN()}));
}

TEST(Rig, TinyImagesAndExtremeUnits) {
    for (const int size : {1, 2, 7, 8, 9}) {
        RigParameters parameters = default_kinect1_rig();
        parameters.depth = {.width = size, .height = 1, .fx = 500, .fy = 500, .cx = 0, .cy = 0};
        parameters.color = parameters.depth;
        parameters.color_from_depth = {};
        DepthFrame frame = flat(size, 1, 1000);
        EXPECT_EQ(registered(parameters, frame).depth_in_color_m.at(size - 1, 0), 1.0f);
        frame.metres_per_unit = 1e300;
        EXPECT_FALSE(any_positive(registered(parameters, frame).depth_m));
        frame.metres_per_unit = 1e-300;
        EXPECT_FALSE(any_positive(registered(parameters, frame).depth_m));
    }
}

TEST(Rig, FloatRayTableAgainstDouble) {
    RigSamples samples(9);
    for (int i = 0; i < 20; ++i) {
        RigParameters parameters = samples.rig(320, 240);
        const Rig rig = Rig::create(parameters).value();
        const Projection projection(parameters.depth);
        for (int k = 0; k < 200; ++k) {
            const int x = static_cast<int>(samples.uniform(0, 319.9));
            const int y = static_cast<int>(samples.uniform(0, 239.9));
            const RayXy ray = rig.depth_rays().at(x, y);
            if (std::isnan(ray.x)) continue;
            const auto z = static_cast<float>(samples.uniform(0.4, 8));
            const float px = z * ray.x;
            const float py = z * ray.y;
            const auto back = projection.project({px, py, z});
            // On the rim itself the rounded ray may lie just outside.
            if (!back) continue;
            EXPECT_LT(glm::length(*back - glm::dvec2(x, y)), 1e-3);
        }
    }
}

}  // namespace
}  // namespace kino
