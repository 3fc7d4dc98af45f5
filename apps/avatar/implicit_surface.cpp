#include "apps/avatar/implicit_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <vector>

#include "viz/surface/mesh_shapes.h"

namespace kino {
namespace {

glm::dvec3 gradient(const std::function<double(const glm::dvec3&)>& f, const glm::dvec3& p) {
    constexpr double kStep = 1e-4;
    glm::dvec3 g(0);
    for (int axis = 0; axis < 3; ++axis) {
        glm::dvec3 d(0);
        d[axis] = kStep;
        g[axis] = (f(p + d) - f(p - d)) / (2 * kStep);
    }
    return g;
}

}  // namespace

MeshAsset polygonize(const std::function<double(const glm::dvec3&)>& distance_m,
                     const glm::dvec3& low_m, const glm::dvec3& high_m, double cell_m) {
    std::array<int, 3> n{};
    for (int axis = 0; axis < 3; ++axis) {
        n[static_cast<std::size_t>(axis)] =
            static_cast<int>(std::ceil((high_m[axis] - low_m[axis]) / cell_m)) + 1;
    }
    const auto corner = [&](int x, int y, int z) { return low_m + cell_m * glm::dvec3(x, y, z); };
    const auto index = [&](int x, int y, int z) {
        return (static_cast<std::size_t>(z) * n[1] + y) * n[0] + x;
    };
    std::vector<double> value(static_cast<std::size_t>(n[0]) * n[1] * n[2]);
    for (int z = 0; z < n[2]; ++z) {
        for (int y = 0; y < n[1]; ++y) {
            for (int x = 0; x < n[0]; ++x) value[index(x, y, z)] = distance_m(corner(x, y, z));
        }
    }
    MeshAsset mesh;
    std::vector<int> vertex_of(value.size(), -1);
    for (int z = 0; z + 1 < n[2]; ++z) {
        for (int y = 0; y + 1 < n[1]; ++y) {
            for (int x = 0; x + 1 < n[0]; ++x) {
                glm::dvec3 sum(0);
                int crossings = 0;
                for (int axis = 0; axis < 3; ++axis) {
                    for (int side = 0; side < 4; ++side) {
                        std::array<int, 3> at = {x, y, z};
                        at[static_cast<std::size_t>((axis + 1) % 3)] += side & 1;
                        at[static_cast<std::size_t>((axis + 2) % 3)] += side >> 1;
                        std::array<int, 3> to = at;
                        ++to[static_cast<std::size_t>(axis)];
                        const double a = value[index(at[0], at[1], at[2])];
                        const double b = value[index(to[0], to[1], to[2])];
                        if ((a < 0) == (b < 0)) continue;
                        sum += glm::mix(corner(at[0], at[1], at[2]), corner(to[0], to[1], to[2]),
                                        a / (a - b));
                        ++crossings;
                    }
                }
                if (crossings == 0) continue;
                glm::dvec3 p = sum / static_cast<double>(crossings);
                glm::dvec3 g(0, 1, 0);
                for (int step = 0; step < 3; ++step) {
                    g = gradient(distance_m, p);
                    const double squared = std::max(glm::dot(g, g), 1e-6);
                    glm::dvec3 move = -g * (distance_m(p) / squared);
                    const double far = glm::length(move);
                    if (far > 0.5 * cell_m) move *= 0.5 * cell_m / far;
                    p += move;
                }
                vertex_of[index(x, y, z)] = static_cast<int>(mesh.positions.size());
                mesh.positions.emplace_back(p);
                const double length = glm::length(g);
                mesh.normals.emplace_back(length > 1e-9 ? g / length : glm::dvec3(0, 1, 0));
            }
        }
    }
    // A quad across every edge of the grid that the surface crosses.
    for (int z = 1; z + 1 < n[2]; ++z) {
        for (int y = 1; y + 1 < n[1]; ++y) {
            for (int x = 1; x + 1 < n[0]; ++x) {
                for (int axis = 0; axis < 3; ++axis) {
                    std::array<int, 3> to = {x, y, z};
                    ++to[static_cast<std::size_t>(axis)];
                    const bool inside = value[index(x, y, z)] < 0;
                    if (inside == (value[index(to[0], to[1], to[2])] < 0)) continue;
                    std::array<std::uint32_t, 4> quad{};
                    for (int k = 0; k < 4; ++k) {
                        std::array<int, 3> at = {x, y, z};
                        at[static_cast<std::size_t>((axis + 1) % 3)] -= (k == 1 || k == 2) ? 1 : 0;
                        at[static_cast<std::size_t>((axis + 2) % 3)] -= k >= 2 ? 1 : 0;
                        quad[static_cast<std::size_t>(k)] =
                            static_cast<std::uint32_t>(vertex_of[index(at[0], at[1], at[2])]);
                    }
                    if (!inside) std::swap(quad[1], quad[3]);
                    for (const int k : {0, 1, 2, 0, 2, 3}) {
                        mesh.indices.push_back(quad[static_cast<std::size_t>(k)]);
                    }
                }
            }
        }
    }
    set_bounding_sphere(mesh);
    return mesh;
}

}  // namespace kino
