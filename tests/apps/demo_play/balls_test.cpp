#include "apps/demo/balls.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <limits>

#include "apps/demo/act.h"
#include "tests/support/random.h"

namespace kino::demo {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

glm::dvec3 any(test::Random& random, double reach) {
    const double x = random.real(-reach, reach), y = random.real(-reach, reach);
    return {x, y, random.real(-reach, reach)};
}

glm::dvec3 any_direction(test::Random& random) {
    for (;;) {
        const glm::dvec3 v = any(random, 1);
        if (glm::length(v) > 0.1 && glm::length(v) <= 1) return glm::normalize(v);
    }
}

Solid floor() {
    return {.kind = SolidKind::half_space};
}

/// A closed box of half-spaces.
std::vector<Solid> chamber(const glm::dvec3& least, const glm::dvec3& most) {
    std::vector<Solid> solids;
    for (int k = 0; k < 3; ++k) {
        glm::dvec3 normal(0);
        normal[k] = 1;
        solids.push_back({.kind = SolidKind::half_space, .normal = normal, .offset_m = least[k]});
        solids.push_back({.kind = SolidKind::half_space, .normal = -normal, .offset_m = -most[k]});
    }
    return solids;
}

/// Signed distance to a solid by its definition, from the outside only; slow and obvious.
double distance_to(const Solid& solid, const glm::dvec3& at) {
    const glm::dvec3 p = glm::inverse(solid.stage_from_solid) * (at - solid.center_m);
    switch (solid.kind) {
        case SolidKind::box: {
            glm::dvec3 out(0);
            for (int k = 0; k < 3; ++k) out[k] = std::max(0.0, std::abs(p[k]) - solid.half_m[k]);
            return glm::length(out);
        }
        case SolidKind::sphere:
            return std::max(0.0, glm::length(p) - solid.half_m.x);
        case SolidKind::cylinder: {
            const double aside = std::max(0.0, std::hypot(p.x, p.z) - solid.half_m.x);
            return std::hypot(aside, std::max(0.0, std::abs(p.y) - solid.half_m.y));
        }
        default:
            return glm::dot(solid.normal, at) - solid.offset_m;
    }
}

Solid any_solid(test::Random& random) {
    constexpr SolidKind kKinds[] = {SolidKind::box, SolidKind::sphere, SolidKind::cylinder,
                                    SolidKind::half_space};
    Solid solid{.kind = kKinds[random.integer(0, 3)], .center_m = any(random, 1)};
    solid.stage_from_solid =
        glm::mat3_cast(glm::angleAxis(random.real(-3, 3), any_direction(random)));
    solid.half_m = {random.real(0.1, 0.8), random.real(0.1, 0.8), random.real(0.1, 0.8)};
    if (solid.kind == SolidKind::cylinder) solid.half_m.z = solid.half_m.x;
    solid.normal = any_direction(random);
    solid.offset_m = random.real(-1, 1);
    return solid;
}

TEST(Solids, TouchWhereTheyAreNearAndPushOutAsFarAsNeeded) {
    test::Random random(3);
    int touched = 0;
    for (int i = 0; i < 20000; ++i) {
        const Solid solid = any_solid(random);
        const glm::dvec3 at = any(random, 2);
        const double radius = random.real(0.01, 0.5);
        const double distance = distance_to(solid, at);
        const auto contact = touch(solid, at, radius);
        ASSERT_EQ(contact.has_value(), distance < radius) << i;
        if (!contact) continue;
        ++touched;
        ASSERT_NEAR(glm::length(contact->normal), 1, 1e-9);
        ASSERT_GT(contact->depth_m, 0);
        const glm::dvec3 out = at + contact->depth_m * contact->normal;
        ASSERT_NEAR(distance_to(solid, out), radius, 1e-9) << i;
        // Nobody is pushed farther than through the whole solid.
        ASSERT_LT(contact->depth_m, 2 * glm::length(solid.half_m) + radius + 5) << i;
    }
    EXPECT_GT(touched, 3000);
}

TEST(Balls, FlyOnParabolas) {
    Balls balls;
    ASSERT_TRUE(balls.throw_ball({0, 3, 0}, {1, 2, -3}, 0, 0));
    for (int i = 0; i < 10; ++i) balls.step(0.1);
    const double t = 240 * Balls::kStepS;
    const Ball& ball = balls.all().at(0);
    EXPECT_NEAR(ball.at_m.x, 1 * t, 1e-9);
    EXPECT_NEAR(ball.at_m.y, 3 + 2 * t - 0.5 * 9.81 * t * t, 1e-9);
    EXPECT_NEAR(ball.at_m.z, -3 * t, 1e-9);
}

TEST(Balls, ElasticBouncesKeepEnergyWithinOnePercent) {
    Balls balls({.restitution = 1, .rolling_per_s = 0, .grip = 0, .life_s = 60});
    balls.set_solids({floor()});
    ASSERT_TRUE(balls.throw_ball({0, 1.3, 0}, {0.3, 0, 0.1}, 0, 0));
    const double before = balls.energy();
    int bounces = 0;
    double down = 0;
    while (bounces < 10) {
        balls.step(Balls::kStepS);
        const double up = balls.all().at(0).speed_m_s.y;
        bounces += up > 0 && down < 0;
        down = up;
        ASSERT_NEAR(balls.energy(), before, 0.01 * before) << bounces;
    }
    // Between walls, floor and a leaning box as well.
    Balls wild({.restitution = 1, .rolling_per_s = 0, .grip = 0, .life_s = 60});
    auto solids = chamber({-2, 0, -2}, {2, 3, 2});
    solids.insert(solids.begin(),
                  {.kind = SolidKind::box,
                   .center_m = {0.4, 0.3, 0.2},
                   .stage_from_solid = glm::mat3_cast(glm::angleAxis(0.5, glm::dvec3(0, 0.6, 0.8))),
                   .half_m = {0.5, 0.3, 0.4}});
    wild.set_solids(solids);
    ASSERT_TRUE(wild.throw_ball({-1, 1, -1}, {4, 3, 5}, 0, 0));
    const double whole = wild.energy();
    for (int i = 0; i < 50; ++i) {
        wild.step(0.1);
        ASSERT_NEAR(wild.energy(), whole, 0.01 * whole) << i;
    }
}

TEST(Balls, EnergyNeverGrows) {
    test::Random random(11);
    for (int run = 0; run < 40; ++run) {
        Balls balls({.restitution = random.real(0, 1), .life_s = 60});
        auto solids = chamber({-2, 0, -2}, {2, 3, 2});
        for (int i = 0; i < 4; ++i) solids.insert(solids.begin(), any_solid(random));
        std::erase_if(solids, [](const Solid& s) {
            return s.kind == SolidKind::half_space && std::abs(glm::length(s.normal) - 1) > 1e-9;
        });
        balls.set_solids(solids);
        if (!balls.throw_ball({-1.5, 2, 1.5}, 10.0 * any_direction(random), 0, 0)) continue;
        double before = balls.energy();
        for (int i = 0; i < 2000 && !balls.all().empty(); ++i) {
            balls.step(Balls::kStepS);
            if (balls.all().empty()) break;
            ASSERT_LE(balls.energy(), before + 1e-9) << run << " " << i;
            before = balls.energy();
        }
    }
}

TEST(Balls, NeverLeaveTheRoomNorEnterThingsAtTenMetresASecond) {
    test::Random random(5);
    for (const std::string& name : acts_or_default({})) {
        auto act = open_act(name, 0);
        ASSERT_TRUE(act.has_value()) << act.error().to_string();
        // The walls as the file has them, not as the solids do.
        const SceneFile& file = act->director->file();
        glm::dvec3 least(-1e9, 0, -1e9), most(1e9, 1e9, 1e9);
        for (const SceneMesh& mesh : file.meshes) {
            if (mesh.shape != SceneShape::room) continue;
            least = mesh.at_m - 0.5 * glm::dvec3(mesh.size_m.x, 0, mesh.size_m.z);
            most = mesh.at_m + glm::dvec3(0.5 * mesh.size_m.x, mesh.size_m.y, 0.5 * mesh.size_m.z);
        }
        Balls balls({.restitution = 0.98, .life_s = 60});
        balls.set_solids(act->solids);
        const double r = balls.rules().radius_m;
        for (int i = 0; i < 24; ++i) {
            balls.throw_ball(
                {random.real(-0.6, 0.6), random.real(0.6, 1.8), random.real(-0.4, 0.4)},
                10.0 * any_direction(random), 0, 0);
        }
        for (int i = 0; i < 60; ++i) {
            balls.step(0.1);
            for (const Ball& ball : balls.all()) {
                for (int k = 0; k < 3; ++k) {
                    ASSERT_GT(ball.at_m[k] - r, least[k] - 0.5 * r) << name << " " << i;
                    ASSERT_LT(ball.at_m[k] + r, most[k] + 0.5 * r) << name << " " << i;
                }
                ASSERT_LT(ball.at_m.z, file.camera.eye_m.z) << name;
                for (const Solid& solid : act->solids) {
                    if (solid.kind == SolidKind::sheet) continue;
                    const auto contact = touch(solid, ball.at_m, r);
                    ASSERT_LT(contact ? contact->depth_m : 0, 0.5 * r) << name << " " << i;
                }
            }
        }
        EXPECT_EQ(balls.all().size(), 24u) << name;
    }
}

TEST(Balls, DoNotCareHowMomentsAreCut) {
    const auto bits = [](const std::vector<double>& moments) {
        Balls balls;
        balls.set_solids(chamber({-2, 0, -2}, {2, 3, 2}));
        for (int i = 0; i < 5; ++i) {
            balls.throw_ball({-1.0 + 0.4 * i, 1.2, 0.1 * i}, {3.0 - i, 2, 1}, 0, 0);
        }
        for (const double dt : moments) balls.step(dt);
        std::string out;
        for (const Ball& ball : balls.all()) {
            out.append(reinterpret_cast<const char*>(&ball.at_m), sizeof ball.at_m);
            out.append(reinterpret_cast<const char*>(&ball.speed_m_s), sizeof ball.speed_m_s);
        }
        return out;
    };
    // Sums of these are exact.
    const std::string once = bits(std::vector<double>(32, 1.0 / 16));
    EXPECT_EQ(once, bits(std::vector<double>(128, 1.0 / 64)));
    EXPECT_EQ(once, bits(std::vector<double>(512, 1.0 / 256)));
    EXPECT_NE(once, bits(std::vector<double>(31, 1.0 / 16)));
}

TEST(Balls, RollToRestAndGoOut) {
    Balls balls;
    balls.set_solids(chamber({-3, 0, -3}, {3, 3, 3}));
    ASSERT_TRUE(balls.throw_ball({0, 1.2, 0}, {1.2, 0.5, 0}, 0, 0));
    double fastest = 0;
    for (int i = 0; i < 75; ++i) {
        balls.step(0.1);
        fastest = std::max(fastest, glm::length(balls.all().at(0).speed_m_s));
    }
    EXPECT_GT(fastest, 2);
    EXPECT_LT(glm::length(balls.all().at(0).speed_m_s), 0.15);
    EXPECT_NEAR(balls.all().at(0).at_m.y, balls.rules().radius_m, 2e-3);
    EXPECT_LT(balls.weight(balls.all()[0]), 0.95);
    for (int i = 0; i < 6; ++i) balls.step(0.1);
    EXPECT_TRUE(balls.all().empty());
}

TEST(Balls, BounceOffEachOther) {
    Balls balls({.gravity_m_s2 = 0});
    balls.throw_ball({-0.5, 1, 0}, {2, 0, 0}, 0, 0);
    balls.throw_ball({0.5, 1.03, 0}, {-2, 0, 0}, 0, 0);
    const double before = balls.energy();
    double nearest = 1;
    for (int i = 0; i < 10; ++i) {
        balls.step(0.05);
        nearest = std::min(nearest, glm::distance(balls.all()[0].at_m, balls.all()[1].at_m));
    }
    const glm::dvec3 a = balls.all()[0].speed_m_s, b = balls.all()[1].speed_m_s;
    EXPECT_LT(a.x, -1);
    EXPECT_GT(b.x, 1);
    EXPECT_LT(glm::length(a + b), 1e-9);  // momentum
    EXPECT_GE(nearest, 1.5 * balls.rules().radius_m);
    EXPECT_LT(balls.energy(), before);
    EXPECT_GT(balls.all()[0].flash, 0);
    // Those that part already are let go, though they are still in each other.
    Balls parting({.gravity_m_s2 = 0});
    parting.throw_ball({0, 1, 0}, {-0.5, 0, 0}, 0, 0);
    parting.throw_ball({0.05, 1, 0}, {0.5, 0, 0}, 0, 0);
    parting.step(0.1);
    EXPECT_EQ(parting.all()[0].speed_m_s.x, -0.5);
    EXPECT_EQ(parting.all()[1].speed_m_s.x, 0.5);
}

TEST(Balls, HardThrows) {
    Balls balls;
    balls.set_solids(chamber({-2, 0, -2}, {2, 3, 2}));
    EXPECT_FALSE(balls.throw_ball({kNan, 0, 0}, {0, 0, 0}, 0, 0));
    EXPECT_FALSE(balls.throw_ball({0, 1, 0}, {0, kInfinity, 0}, 0, 0));
    EXPECT_FALSE(balls.throw_ball({0, 1, 1e9}, {0, 1, 0}, 0, 0));
    EXPECT_TRUE(balls.throw_ball({-5, -1, 0}, {0, 0, 1e200}, 0, 0));  // in a wall, and too fast
    EXPECT_GE(balls.all()[0].at_m.x, -2);
    EXPECT_LE(glm::length(balls.all()[0].speed_m_s), balls.rules().fastest_m_s + 1e-9);
    for (const double dt : {0.0, kNan, -1.0, 10.0, kInfinity}) balls.step(dt);
    EXPECT_LT(balls.all().at(0).age_s, 0.25);
    for (int i = 0; i < 100; ++i) balls.throw_ball({0, 1, 0}, {0.01 * i, 1, 0}, 0, 0);
    EXPECT_EQ(balls.all().size(), balls.rules().most);
    for (int i = 0; i < 20; ++i) balls.step(0.1);
    for (const Ball& ball : balls.all()) {
        EXPECT_TRUE(std::isfinite(ball.at_m.x + ball.at_m.y + ball.at_m.z));
    }
}

}  // namespace
}  // namespace kino::demo
