#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <string>

#include "calibration/rig.h"
#include "tests/calibration/rig_samples.h"
#include "tests/reference/registration_reference.h"
#include "tests/reference/registration_scene.h"

namespace kino {
namespace {

using reference::RegistrationScene;

constexpr RigOptions kSplat{.coverage = Coverage::splat};

RegisteredDepth splatted(const RigParameters& parameters, const DepthFrame& frame,
                         RigOptions options = kSplat) {
    Rig rig = Rig::create(parameters, options).value();
    RegisteredDepth out;
    EXPECT_TRUE(rig.register_depth(frame, out));
    return out;
}

// Colour beside depth without distortion: tests then know to the pixel what must be seen.
RigParameters side_by_side(int width, int height, int finer, double baseline_m) {
    RigParameters rig;
    rig.depth = {.width = width, .height = height, .fx = 0.9 * width, .fy = 0.9 * width};
    rig.depth.cx = (width - 1) / 2.0;
    rig.depth.cy = (height - 1) / 2.0;
    rig.color = rig.depth;
    rig.color->width *= finer;
    rig.color->height *= finer;
    rig.color->fx *= finer;
    rig.color->fy *= finer;
    rig.color->cx = (rig.color->width - 1) / 2.0;
    rig.color->cy = (rig.color->height - 1) / 2.0;
    rig.color_from_depth.translation = {-baseline_m, 0, 0};
    rig.min_depth_m = 0.05;
    return rig;
}

RegistrationScene::Rectangle upright(glm::dvec3 centre, double half_width, double turned_deg,
                                     double half_height = 5) {
    const double a = glm::radians(turned_deg);
    return {centre, half_width * glm::dvec3(std::cos(a), 0, std::sin(a)), {0, half_height, 0}};
}

struct Seen {
    DepthFrame frame;
    reference::RegistrationTruth truth;
    RegisteredDepth out;
};

Seen see(const RegistrationScene& scene, const RigParameters& rig, RigOptions options = kSplat,
         double clear_px = 1) {
    const Image<glm::dvec2> depth_rays = reference::rays(rig.depth);
    const Image<glm::dvec2> color_rays = reference::rays(*rig.color);
    Seen seen;
    seen.frame = reference::depth_frame(scene, rig, depth_rays);
    seen.truth = reference::registration_truth(scene, rig, depth_rays, color_rays, clear_px);
    seen.out = splatted(rig, seen.frame, options);
    return seen;
}

void expect_as_reference(const RigParameters& parameters, const DepthFrame& frame,
                         const std::string& what) {
    const Image<glm::dvec2> rays = reference::rays(parameters.depth);
    const reference::Registration exact = reference::register_depth(parameters, rays, frame);
    const reference::SplatPicture slow = reference::splat_depth(parameters, rays, exact);
    const RegisteredDepth fast = splatted(parameters, frame);
    std::size_t filled = 0;
    std::size_t other = 0;
    double worst = 0;
    for (std::size_t i = 0; i < slow.depth_in_color_m.size(); ++i) {
        const double z = slow.depth_in_color_m.pixels()[i];
        const double error = std::abs(fast.depth_in_color_m.pixels()[i] - z);
        if (z > 0) ++filled;
        // Rounding moves what is drawn by micrometres, and now and then the border of a piece over
        // the centre of a pixel. 0.1 mm tells them apart.
        if (error > 1e-4) {
            ++other;
        } else {
            worst = std::max(worst, error);
        }
    }
    std::size_t placed = 0;
    std::size_t other_validity = 0;
    for (std::size_t i = 0; i < exact.uv.size(); ++i) {
        const bool in_picture = !std::isnan(exact.uv.pixels()[i].x);
        if (in_picture) ++placed;
        const bool shown = in_picture && slow.hidden.pixels()[i] == 0;
        if (shown != fast.uv.pixels()[i].valid()) ++other_validity;
    }
    EXPECT_GT(filled, 1000u) << what;
    EXPECT_LT(worst, 5e-5) << what;
    EXPECT_LE(other, 2 + filled / 500) << what << ", of " << filled;
    EXPECT_LE(other_validity, 2 + placed / 1000) << what << ", of " << placed;
}

TEST(RegistrationSplat, RandomRigsAsTheDoubleReference) {
    RigSamples samples(21);
    for (int i = 0; i < 5; ++i) {
        const RigParameters parameters = samples.rig(112, 84);
        expect_as_reference(parameters, samples.room(112, 84), "rig " + std::to_string(i));
    }
    for (const int finer : {2, 3}) {
        RigParameters parameters = samples.rig(96, 72);
        parameters.color = samples.camera(96 * finer + 1, 72 * finer);
        expect_as_reference(parameters, samples.room(96, 72), "finer " + std::to_string(finer));
    }
    RigParameters parameters = samples.rig(160, 120);
    parameters.color = samples.camera(80, 60);
    expect_as_reference(parameters, samples.room(160, 120), "coarser");
}

TEST(RegistrationSplat, StrongDistortionAsTheDoubleReference) {
    RigSamples samples(22);
    RigParameters parameters = samples.rig(112, 84);
    parameters.depth = RigSamples::folding_camera(112, 84);
    expect_as_reference(parameters, samples.room(112, 84), "folding depth");
    parameters = samples.rig(112, 84);
    parameters.color = RigSamples::folding_camera(112, 84);
    expect_as_reference(parameters, samples.room(112, 84), "folding colour");
    parameters.color->k1 = 1.5;
    parameters.color->p1 = 0.02;
    parameters.color->p2 = -0.03;
    expect_as_reference(parameters, samples.room(112, 84), "strong pincushion");
    parameters = samples.rig(112, 84);
    parameters.color_from_depth.translation.x = -0.3;
    expect_as_reference(parameters, samples.room(112, 84), "wide baseline");
}

TEST(RegistrationSplat, OneCameraForBothIsTheIdentity) {
    RigSamples samples(23);
    RigParameters parameters;
    parameters.depth = samples.camera(133, 97);
    parameters.color = parameters.depth;
    const RegisteredDepth out = splatted(parameters, samples.room(133, 97));
    for (std::size_t i = 0; i < out.depth_m.size(); ++i) {
        const float z = out.depth_m.pixels()[i];
        EXPECT_NEAR(out.depth_in_color_m.pixels()[i], z, 1e-6 * z);
        EXPECT_EQ(out.uv.pixels()[i].valid(), z > 0);
    }
}

// Every colour pixel that the depth camera measures is filled, and by its own surface.
TEST(RegistrationSplat, NoHolesOnSlantedSurfaces) {
    RigSamples samples(24);
    for (int i = 0; i < 18; ++i) {
        const int finer = 1 + i % 3;
        const double tilt = i < 9 ? samples.uniform(-70, 70) : samples.uniform(70, 84);
        const RigParameters rig = side_by_side(128, 96, finer, i % 2 == 0 ? 0.03 : -0.03);
        RegistrationScene scene;
        scene.rectangles.push_back(upright({0, 0, samples.uniform(1.0, 2.5)}, 8, tilt));
        // Turned about the axis of sight as well.
        const glm::dquat roll = glm::angleAxis(samples.uniform(0, 3), glm::dvec3(0, 0, 1));
        scene.rectangles[0].half_x = roll * scene.rectangles[0].half_x;
        scene.rectangles[0].half_y = roll * scene.rectangles[0].half_y;
        const Seen seen = see(scene, rig);
        int measured = 0;
        int holes = 0;
        double worst = 0;
        for (std::size_t k = 0; k < seen.truth.measured.size(); ++k) {
            if (seen.truth.measured.pixels()[k] == 0) continue;
            const double truth = seen.truth.depth_in_color_m.pixels()[k];
            // Beyond the sensor's range nothing is measured, and beside its border one neighbour.
            if (truth < 0.1 || truth > 6) continue;
            ++measured;
            const double z = seen.out.depth_in_color_m.pixels()[k];
            if (z == 0) ++holes;
            // In parts of the depth: units of 0.1 mm, carried on over a pixel's slope.
            if (z > 0) worst = std::max(worst, std::abs(z - truth) / (truth * truth));
        }
        EXPECT_GT(measured, 500) << i << " tilt " << tilt;
        EXPECT_EQ(holes, 0) << i << " tilt " << tilt << " finer " << finer;
        EXPECT_LT(worst, 0.002) << i << " tilt " << tilt << " finer " << finer;
    }
}

TEST(RegistrationSplat, NearestHasHolesWhereColourIsFiner) {
    const RigParameters rig = side_by_side(128, 96, 2, 0.03);
    RegistrationScene scene;
    scene.rectangles.push_back(upright({0, 0, 1.5}, 8, 20));
    const auto holes = [&](Coverage coverage) {
        const Seen seen = see(scene, rig, {.coverage = coverage});
        int count = 0;
        for (std::size_t k = 0; k < seen.truth.measured.size(); ++k) {
            count +=
                seen.truth.measured.pixels()[k] != 0 && seen.out.depth_in_color_m.pixels()[k] == 0;
        }
        return count;
    };
    EXPECT_GT(holes(Coverage::nearest), 10'000);
    EXPECT_LT(holes(Coverage::bilinear), 2'000);
    EXPECT_EQ(holes(Coverage::splat), 0);
}

// A plate before a wall: its depth ends where it ends, give or take half a depth pixel.
TEST(RegistrationSplat, DepthDiscontinuityDoesNotBleed) {
    for (const int finer : {1, 2, 4}) {
        const RigParameters rig = side_by_side(128, 96, finer, 0.025);
        RegistrationScene scene;
        scene.rectangles.push_back(upright({0, 0, 3}, 8, 10));
        scene.rectangles.push_back(upright({0.02, 0, 1.2}, 0.21, 25, 0.2));
        const Seen seen = see(scene, rig);
        const Image<int>& objects = seen.truth.object_in_color;
        // Half a depth pixel and the overlap, and what the plate's own tilt adds.
        const int reach = static_cast<int>(std::ceil(finer * (0.5 + 1.0 / 16) * 1.1 + 0.5));
        int bled = 0;
        int wall = 0;
        for (int y = reach; y < objects.height() - reach; ++y) {
            for (int x = reach; x < objects.width() - reach; ++x) {
                bool only_wall = true;
                for (int dy = -reach; dy <= reach; ++dy) {
                    for (int dx = -reach; dx <= reach; ++dx) {
                        only_wall = only_wall && objects.at(x + dx, y + dy) == 0;
                    }
                }
                if (!only_wall) continue;
                ++wall;
                const float z = seen.out.depth_in_color_m.at(x, y);
                bled += z > 0 && z < 2;
            }
        }
        EXPECT_GT(wall, 1000 * finer);
        EXPECT_EQ(bled, 0) << finer;
    }
}

// What only the colour camera sees, beside the plate, has no depth: not the wall's, not the
// plate's.
TEST(RegistrationSplat, HolesGetNoBackground) {
    for (const int fill_px : {0, 100'000}) {
        const RigParameters rig = side_by_side(160, 120, 2, 0.12);
        RegistrationScene scene;
        scene.rectangles.push_back(upright({0, 0, 3}, 8, 0));
        scene.rectangles.push_back(upright({0, 0, 1}, 0.2, 0, 0.15));
        RigOptions options = kSplat;
        options.fill_holes_px = fill_px;
        const Seen seen = see(scene, rig, options);
        const Image<glm::dvec2> rays = reference::rays(*rig.color);
        int shadow = 0;
        for (int y = 0; y < 240; ++y) {
            for (int x = 0; x < 320; ++x) {
                // The plate's readings reach half a depth pixel beyond it.
                const Image<int>& objects = seen.truth.object_in_color;
                if (objects.at(x, y) != 0 || objects.at(std::max(x - 2, 0), y) != 0 ||
                    objects.at(std::min(x + 2, 319), y) != 0) {
                    continue;
                }
                // The wall's point there, and how far inside the plate's outline it lies from the
                // depth camera, in pixels of that.
                const glm::dvec3 p = 3.0 * glm::dvec3(rays.at(x, y), 1) + glm::dvec3(0.12, 0, 0);
                const glm::dvec2 pixels = glm::dvec2(p) / 3.0 * rig.depth.fx;
                const glm::dvec2 inside = glm::dvec2(0.2, 0.15) * rig.depth.fx - glm::abs(pixels);
                if (!(std::min(inside.x, inside.y) > 1.5)) continue;
                ++shadow;
                EXPECT_EQ(seen.out.depth_in_color_m.at(x, y), 0.0f) << x << " " << y;
            }
        }
        EXPECT_GT(shadow, 1000);
    }
}

TEST(RegistrationSplat, ThinForegroundRod) {
    // Four fifths of a depth pixel wide, so that each row has one reading of it or none.
    const RigParameters rig = side_by_side(160, 120, 2, 0.025);
    RegistrationScene scene;
    scene.rectangles.push_back(upright({0, 0, 3}, 8, 0));
    const double pixel_m = 1.0 / rig.depth.fx;
    scene.rectangles.push_back(upright({0.1, 0, 1}, 0.5 * pixel_m, 0));
    const Seen seen = see(scene, rig);
    for (int y = 0; y < 240; ++y) {
        int rod_pixels = 0;
        for (int x = 0; x < 320; ++x) {
            const float z = seen.out.depth_in_color_m.at(x, y);
            if (z > 0 && z < 2) {
                ++rod_pixels;
                EXPECT_NEAR(z, 1, 1e-3);
            }
        }
        EXPECT_GE(rod_pixels, 1) << y;
        EXPECT_LE(rod_pixels, 3) << y;
    }
    // And no wall pixel behind it takes the rod's colour.
    for (std::size_t i = 0; i < seen.truth.seen_by_color.size(); ++i) {
        if (seen.truth.object_in_depth.pixels()[i] == 1) {
            EXPECT_TRUE(seen.out.uv.pixels()[i].valid());
        }
    }
}

TEST(RegistrationSplat, ParallelWalls) {
    // The nearer one ends in the middle. 70 mm are an occlusion at 1.5 m, 30 mm are not.
    for (const double apart : {0.03, 0.07}) {
        const RigParameters rig = side_by_side(160, 120, 2, 0.2);
        RegistrationScene scene;
        scene.rectangles.push_back(upright({0, 0, 1.5 + apart}, 8, 0));
        scene.rectangles.push_back(upright({-4, 0, 1.5}, 4, 0));
        const Seen seen = see(scene, rig);
        int refused = 0;
        for (std::size_t i = 0; i < seen.truth.seen_by_color.size(); ++i) {
            const bool valid = seen.out.uv.pixels()[i].valid();
            const bool hidden = seen.truth.object_in_depth.pixels()[i] == 0 && !valid;
            refused += hidden && seen.frame.raw.pixels()[i] != 0 &&
                       seen.truth.seen_by_color.pixels()[i] == 0 && i % 160 > 40;
            if (seen.truth.seen_by_color.pixels()[i] != 0 && i % 160 != 80) {
                EXPECT_TRUE(valid) << i % 160 << " " << i / 160;
            }
        }
        // The shift between the walls, in depth pixels, in each of 120 rows.
        const double shift = 0.2 * rig.depth.fx * (1 / 1.5 - 1 / (1.5 + apart));
        if (apart > 0.05) {
            EXPECT_NEAR(refused / 120.0, shift, 1);
        } else {
            EXPECT_EQ(refused, 0);
        }
    }
}

// Within one colour pixel such a wall's depth changes by more than the occlusion margin, so that
// depths at two places of it must not be compared.
TEST(RegistrationSplat, SlantedWallDoesNotHideItself) {
    RigParameters rig = side_by_side(160, 40, 1, 0.01);
    rig.color = rig.depth;
    rig.color->fx /= 2;  // colour pixels twice as wide as depth pixels
    RegistrationScene scene;
    scene.rectangles.push_back(upright({-0.4, 0, 1.6}, 1.2, 82));
    const Seen seen = see(scene, rig, {.occlusion_margin_m = 0.002, .coverage = Coverage::splat});
    int visible = 0;
    int refused = 0;
    for (std::size_t i = 0; i < seen.truth.seen_by_color.size(); ++i) {
        if (seen.truth.seen_by_color.pixels()[i] == 0) continue;
        ++visible;
        refused += !seen.out.uv.pixels()[i].valid();
    }
    EXPECT_GT(visible, 400);
    EXPECT_LT(refused, visible / 100);
}

TEST(RegistrationSplat, SlantedWallSeenEdgeOn) {
    // The depth camera sees its right side; from 0.1 to 0.3 m further left or right the colour
    // camera sees it edge-on, from behind, or from the front.
    RegistrationScene scene;
    const double tilt = 80;
    scene.rectangles.push_back(upright({0.2, 0, 1.5}, 0.4, tilt));
    // The wall's line meets the depth camera's plane z = 0 here.
    const double meets = 0.2 - 1.5 / std::tan(glm::radians(tilt));
    for (const double beyond : {-0.15, 0.0, 0.15}) {
        const RigParameters rig = side_by_side(320, 120, 1, meets + beyond);
        const Seen seen = see(scene, rig);
        int measured = 0;
        int colored = 0;
        int filled = 0;
        for (std::size_t i = 0; i < seen.frame.raw.size(); ++i) {
            measured += seen.frame.raw.pixels()[i] != 0;
            colored += seen.out.uv.pixels()[i].valid();
            filled += seen.out.depth_in_color_m.pixels()[i] > 0;
        }
        EXPECT_GT(measured, 500) << beyond;
        EXPECT_GT(filled, 100) << beyond;
        const bool front = (meets < 0) == (beyond > 0) && beyond != 0;
        if (front) {
            EXPECT_GT(colored, 0.95 * measured) << beyond;
        } else if (beyond != 0) {
            EXPECT_LT(colored, 0.05 * measured) << beyond;
        }
    }
}

template <class T>
bool bits_agree(const Image<T>& a, const Image<T>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
}

bool bits_agree(const RegisteredDepth& a, const RegisteredDepth& b) {
    return bits_agree(a.depth_m, b.depth_m) && bits_agree(a.uv, b.uv) &&
           bits_agree(a.depth_in_color_m, b.depth_in_color_m);
}

bool nothing_there(const RegisteredDepth& out) {
    return std::ranges::all_of(out.depth_in_color_m.pixels(), [](float z) { return z == 0; }) &&
           std::ranges::none_of(out.uv.pixels(), [](ColorUv p) { return p.valid(); });
}

TEST(RegistrationSplat, EmptyFrameAndAllInvalid) {
    RigSamples samples(25);
    RigParameters parameters = samples.rig(64, 48);
    // A depth of zero lies in the depth camera itself, which this colour camera sees before it.
    parameters.color_from_depth.translation = {0, 0, 0.05};
    DepthFrame frame = samples.room(64, 48);
    for (const Coverage coverage : {Coverage::bilinear, Coverage::splat}) {
        RigOptions options{.coverage = coverage, .fill_holes_px = 1 << 20};
        // 60 m are a reading, but out of range.
        for (const int raw : {0, 65535, 60'000}) {
            frame.raw.fill(static_cast<std::uint16_t>(raw));
            for (const bool simd : {false, true}) {
                options.simd = simd;
                EXPECT_TRUE(nothing_there(splatted(parameters, frame, options))) << raw;
            }
        }
    }
    RegisteredDepth unused;
    EXPECT_FALSE(Rig::create(parameters, kSplat).value().register_depth({}, unused));
}

TEST(RegistrationSplat, RaysThatAreNaNDrawNothing) {
    // The corners of this lens have no ray; all of it has none where it folds at once.
    RigParameters parameters = side_by_side(64, 48, 1, 0.02);
    parameters.depth = RigSamples::folding_camera(64, 48);
    DepthFrame frame;
    frame.raw = Image<std::uint16_t>(64, 48, 1500);
    const Rig rig = Rig::create(parameters, kSplat).value();
    EXPECT_TRUE(std::isnan(rig.depth_rays().at(0, 0).x));
    const RegisteredDepth out = splatted(parameters, frame);
    EXPECT_FALSE(out.uv.at(0, 0).valid());
    for (const float z : out.depth_in_color_m.pixels()) {
        EXPECT_TRUE(z == 0 || std::abs(z - 1.5f) < 0.01f) << z;
    }
    parameters.depth.k1 = -1e9;
    EXPECT_TRUE(nothing_there(splatted(parameters, frame)));
}

// Neighbours that jump, and a camera so near that one of them is a thousand colour pixels wide.
TEST(RegistrationSplat, NoiseAndExtremePosesStayInBounds) {
    RigSamples samples(26);
    DepthFrame frame = samples.room(96, 72);
    for (auto& raw : frame.raw.pixels()) {
        raw = static_cast<std::uint16_t>(samples.uniform(0, 1) < 0.2 ? 0
                                                                     : samples.uniform(300, 9000));
    }
    for (const glm::dvec3 place : {glm::dvec3(-0.03, 0, 0), glm::dvec3(0, 0, -0.999),
                                   glm::dvec3(0, 0, -2), glm::dvec3(3, 1, 0)}) {
        RigParameters parameters = samples.rig(96, 72);
        parameters.color_from_depth.translation = place;
        const RegisteredDepth out = splatted(parameters, frame);
        for (const float z : out.depth_in_color_m.pixels()) {
            EXPECT_TRUE(z == 0 || (z > 0 && z < 20)) << z;
        }
    }
}

TEST(RegistrationSplat, SameBitsAgainAndWithSimd) {
    RigSamples samples(27);
    for (int i = 0; i < 6; ++i) {
        RigParameters parameters = samples.rig(101 + i, 75);
        if (i % 2 == 1) parameters.color = samples.camera(203, 151);
        for (const Coverage coverage : {Coverage::bilinear, Coverage::splat}) {
            RigOptions options{
                .coverage = coverage, .fill_holes_px = 50, .ray_table_step = i < 3 ? 1 : 4};
            const DepthFrame first = samples.room(101 + i, 75);
            const DepthFrame second = samples.room(101 + i, 75);
            Rig rig = Rig::create(parameters, options).value();
            RegisteredDepth out;
            ASSERT_TRUE(rig.register_depth(first, out));
            ASSERT_TRUE(rig.register_depth(second, out));
            EXPECT_TRUE(bits_agree(out, splatted(parameters, second, options))) << i;
            options.simd = false;
            EXPECT_TRUE(bits_agree(out, splatted(parameters, second, options))) << i;
        }
    }
}

TEST(RegistrationOptions, RefusesWhatIsNoChoice) {
    const RigParameters parameters = side_by_side(64, 48, 1, 0.02);
    for (const int step : {-1, 0, 3, 5, 16}) {
        EXPECT_FALSE(Rig::create(parameters, {.ray_table_step = step})) << step;
    }
    EXPECT_FALSE(Rig::create(parameters, {.fill_holes_px = -1}));
    EXPECT_TRUE(Rig::create(parameters, {.fill_holes_px = 1, .ray_table_step = 8}));
}

}  // namespace
}  // namespace kino
