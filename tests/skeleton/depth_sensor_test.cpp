#include "skeleton/synthetic/depth_sensor.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace kino {
namespace {

// A level camera 1 m up before a wall at `wall_m`, with nothing else in the room.
SyntheticScene facing_wall(double wall_m) {
    SyntheticScene scene = make_scene(Motion::idle);
    scene.furniture.clear();
    scene.person = false;
    scene.world_from_depth = Pose{glm::dquat(1, 0, 0, 0), {0, 1, 0}} * world_from_camera_axes();
    scene.room = {{-20, -20, -wall_m}, {20, 20, 1}};
    return scene;
}

Visibility see(const SyntheticScene& scene) {
    Visibility seen(scene, CastView(scene.rig.depth, inverse(scene.world_from_depth)),
                    scene.emitter_x_m());
    seen.draw({});
    return seen;
}

Image<std::uint16_t> measure(const SyntheticScene& scene, const DepthSensorOptions& options,
                             std::int64_t index = 0) {
    DepthSensor sensor(scene.rig, options);
    Image<std::uint16_t> raw;
    sensor.measure(see(scene), index, raw);
    return raw;
}

TEST(DepthSensor, ANoiselessReadingDecodesToWithinHalfAStep) {
    DepthSensorOptions quiet;
    quiet.noise = false;
    for (const double z : {0.5, 0.9, 1.7, 2.6, 4.1, 7.3}) {
        const SyntheticScene scene = facing_wall(z);
        const DepthSensor sensor(scene.rig, quiet);
        const Image<std::uint16_t> raw = measure(scene, quiet);
        for (const std::uint16_t value : raw.pixels()) {
            const auto decoded = sensor.disparity().metres(value);
            ASSERT_TRUE(decoded);
            ASSERT_NEAR(*decoded, z, 0.51 * sensor.disparity().step_m(z));
        }
    }
}

TEST(DepthSensor, NoiseHasTheStatedSpreadAndNoBias) {
    const SyntheticScene scene = facing_wall(2.0);
    const DepthSensor sensor(scene.rig);
    const double exact = *sensor.disparity().raw_exact(2.0);
    double sum = 0, squares = 0, next_to = 0;
    std::size_t count = 0;
    for (int frame = 0; frame < 4; ++frame) {
        const Image<std::uint16_t> raw = measure(scene, {}, frame);
        for (std::size_t i = 0; i < raw.size(); ++i) {
            const double off = raw.pixels()[i] - exact;
            sum += off;
            squares += off * off;
            if (i > 0) next_to += off * (raw.pixels()[i - 1] - exact);
            ++count;
        }
    }
    const auto n = static_cast<double>(count);
    // What rounding makes of a normal value, summed over the raw values it can become.
    const auto below = [&](double raw) {
        return 0.5 * std::erfc(-(raw - exact) / 0.46 / std::sqrt(2.0));
    };
    double mean = 0, variance = 0;
    for (double raw = std::floor(exact) - 6; raw < exact + 7; ++raw) {
        const double chance = below(raw + 0.5) - below(raw - 0.5);
        mean += chance * (raw - exact);
        variance += chance * (raw - exact) * (raw - exact);
    }
    EXPECT_NEAR(sum / n, mean, 0.002);
    EXPECT_NEAR(std::sqrt(squares / n), std::sqrt(variance), 0.002);
    EXPECT_NEAR(next_to / squares, 0, 0.005);  // neighbours know nothing of each other
}

TEST(DepthSensor, NoiseDependsOnTheFrameNumberAlone) {
    const SyntheticScene scene = facing_wall(3.0);
    EXPECT_EQ(measure(scene, {}, 7), measure(scene, {}, 7));
    const Image<std::uint16_t> a = measure(scene, {}, 7), b = measure(scene, {}, 8);
    std::size_t same = 0;
    for (std::size_t i = 0; i < a.size(); ++i) same += a.pixels()[i] == b.pixels()[i];
    EXPECT_LT(same, a.size() * 6 / 10);
}

TEST(DepthSensor, OutOfRangeIsNoReading) {
    for (const double z : {0.2, 0.38, 9.0, 12.0}) {
        const Image<std::uint16_t> raw = measure(facing_wall(z), {});
        EXPECT_EQ(std::count(raw.pixels().begin(), raw.pixels().end(), Disparity::kNoReading),
                  static_cast<std::ptrdiff_t>(raw.size()))
            << z;
    }
}

TEST(DepthSensor, EveryReadingDecodesInsideTheRange) {
    // Just at the limit noise carries half of the pixels over it.
    for (const double z : {0.4, 8.0}) {
        const SyntheticScene scene = facing_wall(z);
        const DepthSensor sensor(scene.rig);
        std::size_t read = 0;
        const Image<std::uint16_t> frame = measure(scene, {});
        for (const std::uint16_t raw : frame.pixels()) {
            if (raw == Disparity::kNoReading) continue;
            ++read;
            ASSERT_TRUE(sensor.disparity().metres(raw)) << raw;
        }
        EXPECT_GT(read, 10000u);
        EXPECT_LT(read, 300000u);
    }
}

// A thin plate in the picture's middle, before the wall.
SyntheticScene plate_before_wall(double plate_m, double wall_m, double half_width) {
    SyntheticScene scene = facing_wall(wall_m);
    scene.furniture = {
        box({0, 1, -plate_m - 1e-4}, {half_width, 0.3, 1e-4}, kPartThing, Covering::red)};
    return scene;
}

TEST(ProjectorShadow, LiesToTheLeftAndIsAsWideAsParallaxSays) {
    for (const auto& [plate, wall] : {std::pair{1.0, 2.0}, {1.5, 4.0}, {2.5, 3.0}, {0.6, 5.0}}) {
        const SyntheticScene scene = plate_before_wall(plate, wall, 0.25);
        const Visibility seen = see(scene);
        const int row = 240;
        int left = 640, right = -1, dark_left = 0, dark_right = 0;
        for (int x = 0; x < 640; ++x) {
            if (seen.part_of(seen.id().at(x, row)) == kPartThing) {
                left = std::min(left, x);
                right = std::max(right, x);
                EXPECT_NE(seen.lit().at(x, row), 0);
            }
        }
        for (int x = 0; x < 640; ++x) {
            if (seen.lit().at(x, row) != 0) continue;
            dark_left += x < left;
            dark_right += x > right;
        }
        const double width = 0.075 * scene.rig.depth.fx * (1 / plate - 1 / wall);
        EXPECT_EQ(dark_right, 0);
        EXPECT_NEAR(dark_left, width, 1.01) << plate << " m before " << wall << " m";
        EXPECT_EQ(seen.lit().at(left - 1, row), 0) << "the shadow touches the plate";
    }
}

TEST(ProjectorShadow, LightPassesBehindAThinRod) {
    // Narrower than its shadow is displaced: a lit strip remains between rod and shadow.
    const double plate = 1.0, wall = 4.0, half = 0.008;
    const SyntheticScene scene = plate_before_wall(plate, wall, half);
    const Visibility seen = see(scene);
    const double shift = 0.075 * scene.rig.depth.fx * (1 / plate - 1 / wall);
    const double rod_px = 2 * half * scene.rig.depth.fx / plate;
    std::vector<int> dark;
    for (int x = 0; x < 640; ++x) {
        if (seen.lit().at(x, 240) == 0) dark.push_back(x);
    }
    ASSERT_FALSE(dark.empty());
    EXPECT_NEAR(static_cast<double>(dark.size()), rod_px, 1.01);
    EXPECT_NEAR((dark.front() + dark.back()) / 2.0, scene.rig.depth.cx - shift, 1.01);
    EXPECT_EQ(dark.back() - dark.front() + 1, static_cast<int>(dark.size()));
}

TEST(ProjectorShadow, HasNoReading) {
    const SyntheticScene scene = plate_before_wall(1.0, 2.0, 0.25);
    const Visibility seen = see(scene);
    const Image<std::uint16_t> raw = measure(scene, {});
    int dark = 0;
    for (std::size_t i = 0; i < raw.size(); ++i) {
        if (seen.lit().pixels()[i] != 0) continue;
        ++dark;
        ASSERT_EQ(raw.pixels()[i], Disparity::kNoReading);
    }
    EXPECT_GT(dark, 1000);
}

TEST(EdgeDropout, TakesOnlyPixelsWithinTwoOfAnEdge) {
    const SyntheticScene scene = plate_before_wall(1.0, 2.0, 0.25);
    const Visibility seen = see(scene);
    const Image<std::uint16_t> raw = measure(scene, {}, 3);
    int lost_near = 0, near = 0;
    for (int y = 2; y < 478; ++y) {
        for (int x = 2; x < 638; ++x) {
            if (seen.lit().at(x, y) == 0) continue;
            bool edge = false;
            for (int d = -2; d <= 2; ++d) {
                edge = edge || std::abs(seen.z_m().at(x + d, y) - seen.z_m().at(x, y)) > 0.5f ||
                       std::abs(seen.z_m().at(x, y + d) - seen.z_m().at(x, y)) > 0.5f;
            }
            const bool lost = raw.at(x, y) == Disparity::kNoReading;
            if (!edge) {
                ASSERT_FALSE(lost) << x << ' ' << y;
            }
            near += edge;
            lost_near += edge && lost;
        }
    }
    // Half of them are 1 px away (0.45), half 2 px (0.15).
    EXPECT_NEAR(lost_near / static_cast<double>(near), 0.30, 0.04);
}

}  // namespace
}  // namespace kino
