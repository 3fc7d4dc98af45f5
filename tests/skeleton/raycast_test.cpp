#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/matrix.hpp>
#include <string>
#include <utility>
#include <vector>

#include "skeleton/synthetic/depth_sensor.h"
#include "skeleton/synthetic/visibility.h"
#include "tests/reference/raycast_reference.h"
#include "tests/support/random.h"

namespace kino {
namespace {

using glm::dvec3;

Visibility see(const SyntheticScene& scene, double t_s) {
    Visibility seen(scene, CastView(scene.rig.depth, inverse(scene.world_from_depth)),
                    scene.emitter_x_m());
    std::vector<Primitive> person;
    scene.person_at(t_s, person);
    seen.draw(person);
    return seen;
}

// True where a neighbour differs.
template <class T>
bool near_change(const Image<T>& image, int x, int y) {
    for (int dy = -1; dy <= 1; ++dy) {
        for (int dx = -1; dx <= 1; ++dx) {
            if (image.contains(x + dx, y + dy) && image.at(x + dx, y + dy) != image.at(x, y)) {
                return true;
            }
        }
    }
    return false;
}

constexpr double kDepthBoundM = 2e-4;

struct Difference {
    int other_id = 0, far_from_edge = 0, depth_off = 0, other_lit = 0, lit_far_from_edge = 0;
    int other_raw = 0, pixels = 0;
};

Difference compare(const SyntheticScene& scene, double t_s) {
    const Visibility fast = see(scene, t_s);
    const reference::RaycastPicture slow = reference::raycast_depth(scene, t_s);
    DepthSensorOptions quiet;
    quiet.noise = false;
    DepthSensor sensor(scene.rig, quiet);
    Image<std::uint16_t> raw;
    sensor.measure(fast, 0, raw);
    Difference out;
    out.pixels = static_cast<int>(slow.id.size());
    for (int y = 0; y < slow.id.height(); ++y) {
        for (int x = 0; x < slow.id.width(); ++x) {
            out.other_raw += raw.at(x, y) != slow.raw.at(x, y);
            const bool lit = fast.lit().at(x, y) != 0;
            if (fast.id().at(x, y) != slow.id.at(x, y)) {
                ++out.other_id;
                // A silhouette, or two surfaces that lie in each other.
                const double apart = std::abs(fast.z_m().at(x, y) - slow.depth_m.at(x, y));
                out.far_from_edge += apart > kDepthBoundM && !near_change(slow.id, x, y);
                continue;
            }
            if (slow.id.at(x, y) >= 0) {
                out.depth_off +=
                    std::abs(fast.z_m().at(x, y) - slow.depth_m.at(x, y)) > kDepthBoundM;
            }
            if (lit != (slow.lit.at(x, y) != 0)) {
                ++out.other_lit;
                out.lit_far_from_edge += !near_change(slow.lit, x, y);
            }
        }
    }
    return out;
}

void expect_close(const Difference& d) {
    SCOPED_TRACE(testing::Message() << "id " << d.other_id << " depth " << d.depth_off << " lit "
                                    << d.other_lit << " raw " << d.other_raw << " of " << d.pixels);
    EXPECT_LE(d.other_id, d.pixels / 2000);
    EXPECT_EQ(d.far_from_edge, 0);
    EXPECT_EQ(d.depth_off, 0);
    EXPECT_LE(d.other_lit, d.pixels / 5000);
    EXPECT_EQ(d.lit_far_from_edge, 0);
    EXPECT_LE(d.other_raw, d.pixels / 5000);
}

class FastAgainstReference : public testing::TestWithParam<Motion> {};
INSTANTIATE_TEST_SUITE_P(Motions, FastAgainstReference, testing::ValuesIn(all_motions()),
                         [](const auto& test) { return std::string(motion_name(test.param)); });

TEST_P(FastAgainstReference, AgreesAtAQuarterSize) {
    expect_close(compare(make_scene(GetParam(), 320, 240), 3.7));
}

TEST(FastPath, AgreesWithTheReferenceAtFullSize) {
    expect_close(compare(make_scene(Motion::walk), 1.2));
}

TEST(FastPath, AgreesThroughADistortedDepthCamera) {
    SyntheticScene scene = make_scene(Motion::dance, 320, 240);
    scene.rig.depth.k1 = -0.12;
    scene.rig.depth.k2 = 0.05;
    scene.rig.depth.p1 = 0.002;
    expect_close(compare(scene, 8.2));
}

// A room with nothing in it but what the test puts there; the camera looks along -z, level.
SyntheticScene bare_scene(int width = 320, int height = 240) {
    SyntheticScene scene = make_scene(Motion::idle, width, height);
    scene.furniture.clear();
    scene.person = false;
    scene.world_from_depth = Pose{glm::dquat(1, 0, 0, 0), {0, 1, 0}} * world_from_camera_axes();
    return scene;
}

Primitive random_solid(test::Random& random) {
    const auto spot = [&] {
        return dvec3(random.real(-1.5, 1.5), random.real(0.1, 2.3), random.real(-3.8, 0.5));
    };
    const dvec3 a = spot();
    const dvec3 b =
        a + dvec3(random.real(-0.4, 0.4), random.real(-0.4, 0.4), random.real(-0.4, 0.4));
    const double ra = random.real(0.02, 0.2), rb = random.real(0.02, 0.2);
    switch (random.integer(0, 3)) {
        case 0:
            return round_cone(a, b, ra, rb, kPartThing, Covering::red);
        case 1:
            return flat_cone(a, b, ra, rb, {1, 0.2, 0.1}, random.real(0.5, 1.6),
                             random.real(0.4, 1.3), kPartThing, Covering::red);
        case 2:
            return ellipsoid(
                a, glm::mat3_cast(glm::angleAxis(random.real(0, 6), glm::normalize(b - a))),
                {ra, rb, random.real(0.02, 0.2)}, kPartThing, Covering::red);
        default:
            return box(a, {ra, rb, random.real(0.02, 0.2)}, kPartThing, Covering::red,
                       glm::mat3_cast(glm::angleAxis(random.real(0, 6), glm::normalize(b - a))));
    }
}

TEST(FastPath, AgreesOnRandomSolidsAllRoundTheCamera) {
    // Some stand behind it, some across its plane, some hold it inside.
    test::Random random(11);
    for (int round = 0; round < 12; ++round) {
        SyntheticScene scene = bare_scene();
        for (int i = 0; i < 25; ++i) scene.furniture.push_back(random_solid(random));
        SCOPED_TRACE(round);
        expect_close(compare(scene, 0));
    }
}

TEST(HardCases, CameraInsideASolidLooksThroughIt) {
    SyntheticScene scene = bare_scene();
    const Visibility empty = see(scene, 0);
    scene.furniture = {
        ellipsoid({0, 1, 0}, glm::dmat3(1), {0.3, 0.4, 0.3}, kPartThing, Covering::red),
        box({0, 1, 0}, {0.2, 0.2, 0.2}, kPartThing, Covering::red),
        round_cone({0, 0.8, 0}, {0, 1.4, 0.1}, 0.2, 0.3, kPartThing, Covering::red)};
    const Visibility within = see(scene, 0);
    EXPECT_EQ(empty.z_m(), within.z_m());
    expect_close(compare(scene, 0));
}

TEST(HardCases, SolidsBehindTheCameraAreNotSeen) {
    SyntheticScene scene = bare_scene();
    const Visibility empty = see(scene, 0);
    scene.furniture = {
        round_cone({0, 1, 0.3}, {0.2, 1.1, 0.6}, 0.1, 0.2, kPartThing, Covering::red),
        box({0, 1, 0.3}, {0.5, 0.5, 0.1}, kPartThing, Covering::red)};
    EXPECT_EQ(empty.z_m(), see(scene, 0).z_m());
}

TEST(HardCases, ACapsuleOfZeroLengthIsABall) {
    const dvec3 at(0.2, 1.1, -2);
    const Primitive capsule = round_cone(at, at, 0.15, 0.10, kPartThing, Covering::red);
    EXPECT_EQ(capsule.height, 0);
    EXPECT_EQ(capsule.radius_a, 0.15);
    SyntheticScene scene = bare_scene();
    scene.furniture = {capsule};
    const Visibility seen = see(scene, 0);
    scene.furniture = {ellipsoid(at, glm::dmat3(1), dvec3(0.15), kPartThing, Covering::red)};
    const Visibility ball = see(scene, 0);
    EXPECT_EQ(seen.id(), ball.id());
    EXPECT_GT(std::count(seen.id().pixels().begin(), seen.id().pixels().end(), 0), 500);
    expect_close(compare(scene, 0));
}

TEST(HardCases, ABallWithinTheOtherVanishes) {
    const Primitive p =
        round_cone({0, 1, -2}, {0, 1.05, -2}, 0.05, 0.20, kPartThing, Covering::red);
    EXPECT_EQ(p.height, 0);
    EXPECT_EQ(p.radius_a, 0.20);
    EXPECT_EQ(p.origin_m, dvec3(0, 1.05, -2));
}

TEST(HardCases, PosesThatAreNotRigidAreRefused) {
    SyntheticScene scene = bare_scene();
    EXPECT_TRUE(validate(scene));
    scene.world_from_depth.translation.x = std::nan("");
    EXPECT_FALSE(validate(scene));
    scene = bare_scene();
    scene.world_from_depth.rotation = {2, 0, 0, 0};
    EXPECT_FALSE(validate(scene));
    scene = bare_scene();
    scene.furniture = {box({0, INFINITY, 0}, {1, 1, 1}, kPartThing, Covering::red)};
    EXPECT_FALSE(validate(scene));
    scene = bare_scene();
    scene.room.max_m.y = -1;
    EXPECT_FALSE(validate(scene));
}

TEST(FastPath, DrawsTheSameWhateverWasDrawnBefore) {
    const SyntheticScene scene = make_scene(Motion::walk, 320, 240);
    Visibility seen(scene, CastView(scene.rig.depth, inverse(scene.world_from_depth)),
                    scene.emitter_x_m());
    std::vector<Primitive> person;
    for (const double t : {0.0, 2.4, 5.1, 9.0}) {
        scene.person_at(t, person);
        seen.draw(person);
        const Visibility fresh = see(scene, t);
        EXPECT_EQ(seen.z_m(), fresh.z_m());
        EXPECT_EQ(seen.id(), fresh.id());
        EXPECT_EQ(seen.lit(), fresh.lit());
    }
    seen.draw({});
    SyntheticScene nobody = scene;
    nobody.person = false;
    EXPECT_EQ(seen.lit(), see(nobody, 0).lit());
}

TEST(Kernels, TheTwinsGiveTheSameBits) {
    const raycast::Kernels* wide = raycast::avx2_kernels();
    if (!wide || &raycast::kernels() != wide) GTEST_SKIP() << "no AVX2 here";
    const raycast::Kernels& plain = raycast::portable_kernels();
    const SyntheticScene scene = bare_scene();
    const CastView view(scene.rig.depth, inverse(scene.world_from_depth));
    const int n = view.width() * view.height();
    struct Pictures {
        std::vector<float> z;
        std::vector<std::int32_t> id, lit;
        std::vector<std::uint32_t> rgba;
    };
    test::Random random(5);
    const auto count = static_cast<std::size_t>(n);
    Pictures a{std::vector<float>(count, 5.0f), std::vector<std::int32_t>(count, -1),
               std::vector<std::int32_t>(count, -1), std::vector<std::uint32_t>(count, 0)};
    Pictures b = a;
    const auto target = [&](Pictures& p) {
        return raycast::Target{view.ray_x().data(), view.ray_y().data(), p.z.data(),
                               p.id.data(),         p.lit.data(),        view.width()};
    };
    for (int i = 0; i < 40; ++i) {
        const Primitive p = random_solid(random);
        const raycast::Solid solid = view.prepare(p, i), shadow = view.prepare(p, i, 0.075);
        raycast::Paint paint;
        paint.albedo[0] = 0.5f;
        paint.fold = 0.1f;
        paint.fold_x = paint.fold_y = 11;
        raycast::Lights lights;
        lights.key[1] = -1;
        lights.key_color[0] = lights.sky_color[0] = 0.7f;
        for (const auto& [kernels, pictures] : {std::pair{&plain, &a}, std::pair{wide, &b}}) {
            kernels->nearest(solid, view.bounds(p), target(*pictures));
            kernels->block(shadow, view.shadow_bounds(p, 0.075), target(*pictures), 0.075f, 0.001f,
                           0);
            kernels->shade(solid, paint, lights, view.bounds(p), target(*pictures),
                           pictures->rgba.data());
        }
    }
    EXPECT_EQ(a.z, b.z);
    EXPECT_EQ(a.id, b.id);
    EXPECT_EQ(a.lit, b.lit);
    EXPECT_EQ(a.rgba, b.rgba);
    EXPECT_GT(std::count(a.lit.begin(), a.lit.end(), 0), 100);
}

TEST(Kernels, TheTwinsMeasureAndDarkenTheSameBits) {
    const raycast::Kernels* wide = raycast::avx2_kernels();
    if (!wide || &raycast::kernels() != wide) GTEST_SKIP() << "no AVX2 here";
    const raycast::Kernels& plain = raycast::portable_kernels();
    constexpr int kWidth = 64, kPitch = kWidth + 16;
    test::Random random(8);
    std::vector<float> z(5 * kPitch), quantiles(4096), raw_a(5 * kPitch), raw_b(5 * kPitch);
    for (float& value : z) value = static_cast<float>(random.real(0.3, 9));
    for (float& value : quantiles) value = static_cast<float>(random.real(-3, 3));
    z[3] = 0;
    z[4] = INFINITY;
    const raycast::Quantiser quantiser{.offset = 1086.2f,
                                       .factor = 345.5f,
                                       .raw_min = 300,
                                       .raw_max = 1040,
                                       .sigma = 0.46f,
                                       .normal_quantiles = quantiles.data(),
                                       .jump = 6,
                                       .drop_next = 400000,
                                       .drop_second = 150000,
                                       .seed = 77};
    plain.disparity(quantiser, z.data(), 5 * kPitch, raw_a.data());
    wide->disparity(quantiser, z.data(), 5 * kPitch, raw_b.data());
    EXPECT_EQ(raw_a, raw_b);
    std::vector<std::int32_t> lit(kWidth), id(kWidth);
    for (std::int32_t& value : lit) value = random.chance(0.8) ? -1 : 0;
    const float* rows[5];
    for (std::size_t i = 0; i < 5; ++i) rows[i] = raw_a.data() + i * kPitch + 8;
    std::vector<std::uint16_t> out_a(kWidth), out_b(kWidth);
    plain.measure(quantiser, rows, lit.data(), 1234, kWidth, out_a.data());
    wide->measure(quantiser, rows, lit.data(), 1234, kWidth, out_b.data());
    EXPECT_EQ(out_a, out_b);
    const auto lost = std::count(out_a.begin(), out_a.end(), 2047);
    EXPECT_GT(lost, 5);
    EXPECT_LT(lost, kWidth - 5);

    std::vector<std::uint32_t> rgba_a(kWidth), rgba_b;
    for (std::uint32_t& value : rgba_a) value = static_cast<std::uint32_t>(random.bits());
    rgba_b = rgba_a;
    raycast::FloorSpots spots;
    spots.count = 2;
    spots.x[1] = 3;
    spots.inverse_radius2[0] = spots.inverse_radius2[1] = 0.02f;
    spots.strength[0] = spots.strength[1] = 0.4f;
    raycast::Target target;
    target.id = id.data();
    target.pitch = kWidth;
    plain.darken(spots, {0, 0, kWidth, 1}, target, z.data(), z.data() + 64, 5, rgba_a.data());
    wide->darken(spots, {0, 0, kWidth, 1}, target, z.data(), z.data() + 64, 5, rgba_b.data());
    EXPECT_EQ(rgba_a, rgba_b);
}

TEST(CastView, BoundsHoldEveryPixelThatHits) {
    test::Random random(3);
    SyntheticScene scene = bare_scene();
    scene.rig.depth.k1 = 0.2;
    scene.rig.depth.p2 = 0.01;
    const CastView view(scene.rig.depth, inverse(scene.world_from_depth));
    const Pose& pose = scene.world_from_depth;
    int hits = 0;
    for (int round = 0; round < 60; ++round) {
        const Primitive p = random_solid(random);
        const raycast::Rect r = view.bounds(p);
        const glm::dmat3 to_local = glm::inverse(p.axes);
        for (int i = 0; i < 2000; ++i) {
            const int x = random.integer(0, view.width() - 1);
            const int y = random.integer(0, view.height() - 1);
            const dvec3 d = pose.rotation * dvec3(view.ray_x().at(x, y), view.ray_y().at(x, y), 1);
            if (std::isinf(reference::enter_solid(p, to_local, pose.translation, d, 1e-3)))
                continue;
            ++hits;
            ASSERT_TRUE(x >= r.x0 && x < r.x1 && y >= r.y0 && y < r.y1);
        }
    }
    EXPECT_GT(hits, 500);
}

}  // namespace
}  // namespace kino
