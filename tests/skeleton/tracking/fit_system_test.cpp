#include "skeleton/tracking/fit_system.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <vector>

#include "skeleton/tracking/small_solver.h"
#include "skeleton/tracking/surface.h"
#include "tests/support/random.h"

namespace kino {
namespace {

using glm::vec3;
using test::Random;

TEST(SmallSolver, SolvesWhatItSaysForRandomPositiveMatrices) {
    Random random(1);
    for (const int n : {1, 2, 7, 35, 52}) {
        const auto size = static_cast<std::size_t>(n);
        std::vector<double> root(size * size), a(size * size, 0), x(size), b(size, 0);
        for (double& r : root) r = random.real(-1, 1);
        for (std::size_t i = 0; i < size; ++i) {
            x[i] = random.real(-2, 2);
            for (std::size_t j = 0; j < size; ++j) {
                for (std::size_t k = 0; k < size; ++k) {
                    a[i * size + j] += root[i * size + k] * root[j * size + k];
                }
            }
            a[i * size + i] += 0.1;
        }
        for (std::size_t i = 0; i < size; ++i) {
            for (std::size_t j = 0; j < size; ++j) b[i] += a[i * size + j] * x[j];
        }
        std::vector<double> factor = a, solution = b;
        solve_symmetric(factor, solution, n);
        for (std::size_t i = 0; i < size; ++i) EXPECT_NEAR(solution[i], x[i], 1e-8) << n;
        // The inverse's diagonal against a solve of its own.
        std::vector<double> scratch(size);
        for (const int i : {0, n / 2, n - 1}) {
            std::vector<double> again = a, unit(size, 0);
            unit[static_cast<std::size_t>(i)] = 1;
            solve_symmetric(again, unit, n);
            EXPECT_NEAR(inverse_diagonal(factor, n, i, scratch), unit[static_cast<std::size_t>(i)],
                        1e-7);
        }
    }
}

TEST(SmallSolver, WhatNothingIsKnownOfStaysAndTheRestIsSolved) {
    std::vector<double> a = {2, 0, 0, 0, 0, 0, 0, 0, 4}, b = {2, 5, 8};
    solve_symmetric(a, b, 3);
    EXPECT_DOUBLE_EQ(b[0], 1);
    EXPECT_DOUBLE_EQ(b[1], 0);
    EXPECT_DOUBLE_EQ(b[2], 2);
}

// Energy of points that stick to their places on the bones; the radius there is part of it.
double energy(const JointedModel& model, const std::vector<Bone>& bones,
              const std::vector<SurfaceGap>& gaps, const std::vector<vec3>& points) {
    double sum = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const BoneShape& shape = bone_shape(bones[i]);
        const vec3 q = glm::mix(model.node[shape.from], model.node[shape.to], gaps[i].t);
        const double e = static_cast<double>(glm::dot(gaps[i].normal, points[i] - q) -
                                             model.radius_m(bones[i], gaps[i].t));
        sum += 0.5 * (1.0 + static_cast<double>(i)) * e * e;
    }
    return sum;
}

TEST(FitSystem, GradientIsTheDerivativeOfTheEnergy) {
    Random random(4);
    const auto vector = [&random] {
        return vec3(static_cast<float>(random.real(-1, 1)), static_cast<float>(random.real(-1, 1)),
                    static_cast<float>(random.real(-1, 1)));
    };
    JointedModel model;
    model.pose = resting_pose({0.1f, 0, 2}, {0, -1, 0}, {0.3f, 0, -1});
    for (vec3& d : model.pose.direction) d = unit_or(d + 0.4f * vector(), d);
    model.linearize();
    FitSystem system;
    system.clear();
    std::vector<Bone> bones;
    std::vector<SurfaceGap> gaps;
    std::vector<vec3> points;
    for (int i = 0; i < 60; ++i) {
        const auto bone = static_cast<Bone>(i % kBoneCount);
        const BoneShape& shape = bone_shape(bone);
        const vec3 p =
            glm::mix(model.node[shape.from], model.node[shape.to], 0.4f) + 0.15f * vector();
        const SurfaceGap gap = surface_gap(model, bone, 0, 1, p);
        bones.push_back(bone);
        gaps.push_back(gap);
        points.push_back(p);
        const float radius =
            shape.radius_from_m + (shape.radius_to_m - shape.radius_from_m) * gap.t;
        system.add_on_bone(bone, gap.t, gap.normal, radius, gap.gap_m,
                           1.0f + static_cast<float>(i));
    }
    system.gather(model);
    constexpr float kStep = 1e-3f;
    for (int u = 0; u < kUnknowns; ++u) {
        std::array<float, kUnknowns> step{};
        JointedModel ahead = model, back = model;
        step[static_cast<std::size_t>(u)] = kStep;
        ahead.move(step);
        step[static_cast<std::size_t>(u)] = -kStep;
        back.move(step);
        const double numeric =
            (energy(ahead, bones, gaps, points) - energy(back, bones, gaps, points)) /
            static_cast<double>(2 * kStep);
        EXPECT_NEAR(system.gradient(u), numeric, 0.02 + 0.01 * std::abs(numeric)) << u;
        EXPECT_GE(system.curvature(u, u), 0);
    }
}

TEST(FitSystem, OneStepPutsABoneOnItsPoints) {
    JointedModel model;
    model.pose = resting_pose({0, 0, 2}, {0, -1, 0}, {0, 0, -1});
    model.linearize();
    // The whole person moved by 3 cm: linear, so one step finds it.
    const vec3 moved(0.02f, -0.01f, 0.02f);
    FitSystem system;
    system.clear();
    for (int b = 0; b < kBoneCount; ++b) {
        const BoneShape& shape = bone_shape(static_cast<Bone>(b));
        for (const float t : {0.2f, 0.8f}) {
            const vec3 q = glm::mix(model.node[shape.from], model.node[shape.to], t);
            for (int k = 0; k < 3; ++k) {
                vec3 n(0);
                n[k] = 1;
                system.add_on_bone(static_cast<Bone>(b), t, n, 0, glm::dot(n, moved), 100);
            }
            static_cast<void>(q);
        }
    }
    system.gather(model);
    const std::array<vec3, kNodeCount> before = model.node;
    model.move(system.solve(kPoseUnknowns, 1e-6));
    for (std::size_t j = 0; j < kJointCount; ++j) {
        EXPECT_LT(glm::length(model.node[j] - before[j] - moved), 1e-3f) << j;
    }
}

}  // namespace
}  // namespace kino
