#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>
#include <tuple>

#include "viz/surface/mesh_shapes.h"

namespace kino::test {
namespace {

using Mesh = std::shared_ptr<const MeshAsset>;

struct NamedShape {
    const char* name;
    Mesh mesh;
    double volume;  ///< of the true body; 0: open
};

std::vector<NamedShape> shapes() {
    constexpr double kPi = std::numbers::pi;
    return {{"box", make_box({0.5f, 1.5f, 2.5f}), 0.5 * 1.5 * 2.5},
            {"sphere", make_sphere(0.7f, 96, 64), 4.0 / 3 * kPi * 0.343},
            {"cylinder", make_cylinder(0.5f, 2, 96), kPi * 0.25 * 2},
            {"cone", make_cone(0.5f, 2, 96), kPi * 0.25 * 2 / 3},
            {"torus", make_torus(1, 0.25f, 96, 64), 2 * kPi * kPi * 0.0625},
            {"grid", make_grid(2, 3, 4, 5), 0}};
}

glm::dvec3 corner(const MeshAsset& mesh, std::size_t i) {
    return mesh.positions[mesh.indices[i]];
}

TEST(Shapes, KeepEveryInvariantOfMeshes) {
    for (const NamedShape& shape : shapes()) {
        EXPECT_EQ(broken_invariant(*shape.mesh), "") << shape.name;
    }
    // The smallest ones asked for are bodies still.
    for (const Mesh& mesh : {make_sphere(1, 0, 0), make_cylinder(1, 1, -3), make_cone(1, 1, 1),
                             make_torus(1, 0.2f, 2, 2), make_grid(1, 1, 0, 0)}) {
        EXPECT_EQ(broken_invariant(*mesh), "") << mesh->name;
    }
}

TEST(Shapes, TrianglesFaceTheWayTheirNormalsDo) {
    for (const NamedShape& shape : shapes()) {
        for (std::size_t t = 0; t < shape.mesh->indices.size(); t += 3) {
            const glm::dvec3 n = glm::cross(corner(*shape.mesh, t + 1) - corner(*shape.mesh, t),
                                            corner(*shape.mesh, t + 2) - corner(*shape.mesh, t));
            ASSERT_GT(glm::length(n), 0) << shape.name;
            for (std::size_t k = 0; k < 3; ++k) {
                const glm::dvec3 normal = shape.mesh->normals[shape.mesh->indices[t + k]];
                ASSERT_GT(glm::dot(n, normal), 0.7 * glm::length(n)) << shape.name << " " << t;
            }
        }
    }
}

TEST(Shapes, BodiesAreClosedAndHoldTheirVolume) {
    for (const NamedShape& shape : shapes()) {
        using Key = std::tuple<long, long, long>;
        const auto key = [&](std::size_t i) {
            const glm::dvec3 p = corner(*shape.mesh, i) * 1e5;
            return Key{std::lround(p.x), std::lround(p.y), std::lround(p.z)};
        };
        std::map<std::pair<Key, Key>, int> edges;
        double volume = 0;
        for (std::size_t t = 0; t < shape.mesh->indices.size(); t += 3) {
            for (std::size_t k = 0; k < 3; ++k) {
                const Key a = key(t + k);
                const Key b = key(t + (k + 1) % 3);
                a < b ? ++edges[{a, b}] : --edges[{b, a}];
            }
            volume += glm::dot(corner(*shape.mesh, t),
                               glm::cross(corner(*shape.mesh, t + 1), corner(*shape.mesh, t + 2))) /
                      6;
        }
        int open = 0;
        for (const auto& [edge, balance] : edges) open += balance != 0;
        if (shape.volume > 0) {
            EXPECT_EQ(open, 0) << shape.name;
            EXPECT_NEAR(volume / shape.volume, 1, 0.005) << shape.name;
        } else {
            EXPECT_EQ(open, 2 * (4 + 5)) << shape.name;
        }
    }
}

TEST(Shapes, CurvedBodiesHaveTheNormalsOfTheTrueSurface) {
    const Mesh sphere = make_sphere(2);
    for (std::size_t v = 0; v < sphere->positions.size(); ++v) {
        EXPECT_LT(glm::length(sphere->positions[v] / 2.0f - sphere->normals[v]), 1e-6f);
    }
    const Mesh torus = make_torus(1, 0.25f);
    for (std::size_t v = 0; v < torus->positions.size(); ++v) {
        const glm::dvec3 p = torus->positions[v];
        const glm::dvec3 ring = glm::normalize(glm::dvec3(p.x, 0, p.z));
        EXPECT_LT(glm::length((p - ring) / 0.25 - glm::dvec3(torus->normals[v])), 1e-6);
    }
}

TEST(Shapes, BrokenInvariantsAreNamed) {
    const auto broken = [](const auto& change) {
        MeshAsset mesh = *make_box({1, 1, 1});
        change(mesh);
        return broken_invariant(mesh);
    };
    EXPECT_NE(broken([](MeshAsset& m) { m.indices[3] = 24; }), "");
    EXPECT_NE(broken([](MeshAsset& m) { m.indices.pop_back(); }), "");
    EXPECT_NE(broken([](MeshAsset& m) { m.normals.pop_back(); }), "");
    EXPECT_NE(broken([](MeshAsset& m) { m.uvs.pop_back(); }), "");
    EXPECT_NE(broken([](MeshAsset& m) { m.positions[2].y = NAN; }), "");
    EXPECT_NE(broken([](MeshAsset& m) { m.normals[2] *= 0.5f; }), "");
    EXPECT_NE(broken([](MeshAsset& m) { m.sphere_radius_m = 0.5f; }), "");
    EXPECT_NE(broken([](MeshAsset& m) { m.joints.resize(24); }), "");
    EXPECT_NE(broken([](MeshAsset& m) {
                  m.joints.resize(24);
                  m.weights.assign(24, {0.5f, 0, 0, 0});
              }),
              "");
}

}  // namespace
}  // namespace kino::test
