#include "viz/surface/mesh_shapes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <utility>

namespace kino {
namespace {

constexpr double kTau = 2 * std::numbers::pi;

struct SurfacePoint {
    glm::dvec3 position;
    glm::dvec3 normal;
};

/// A patch of columns x rows cells; `at(u, v)` for u, v in 0 .. 1 runs so that the cross product
/// of the steps along u and along v points outwards.
void add_patch(MeshAsset& mesh, int columns, int rows,
               const std::function<SurfacePoint(double, double)>& at) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    const auto stride = static_cast<std::uint32_t>(columns + 1);
    for (int row = 0; row <= rows; ++row) {
        for (int column = 0; column <= columns; ++column) {
            const double u = static_cast<double>(column) / columns;
            const double v = static_cast<double>(row) / rows;
            const SurfacePoint point = at(u, v);
            mesh.positions.emplace_back(point.position);
            mesh.normals.emplace_back(point.normal);
            mesh.uvs.emplace_back(u, 1 - v);
        }
    }
    for (std::uint32_t row = 0; row < static_cast<std::uint32_t>(rows); ++row) {
        for (std::uint32_t column = 0; column + 1 < stride; ++column) {
            const std::uint32_t a = first + row * stride + column;
            const std::array<std::uint32_t, 6> corners = {a, a + 1,          a + stride + 1,
                                                          a, a + stride + 1, a + stride};
            for (int t = 0; t < 6; t += 3) {
                const glm::vec3 p = mesh.positions[corners[t]];
                const glm::vec3 n = glm::cross(mesh.positions[corners[t + 1]] - p,
                                               mesh.positions[corners[t + 2]] - p);
                // At poles and tips one of the two has no area.
                if (glm::dot(n, n) < 1e-20f * glm::dot(p, p)) continue;
                mesh.indices.insert(mesh.indices.end(), corners.begin() + t,
                                    corners.begin() + t + 3);
            }
        }
    }
}

std::shared_ptr<const MeshAsset> finish(MeshAsset mesh, const char* name) {
    mesh.name = name;
    set_bounding_sphere(mesh);
    return std::make_shared<const MeshAsset>(std::move(mesh));
}

/// A flat disc at height y, seen from above (up > 0) or below.
void add_disc(MeshAsset& mesh, double radius, double y, double up, int segments) {
    const auto center = static_cast<std::uint32_t>(mesh.positions.size());
    const auto add = [&](double x, double z) {
        mesh.positions.emplace_back(x * radius, y, z * radius);
        mesh.normals.emplace_back(0, up, 0);
        mesh.uvs.emplace_back(0.5 + 0.5 * x, 0.5 + 0.5 * up * z);
    };
    add(0, 0);
    for (int s = 0; s < segments; ++s) {
        const double angle = kTau * s / segments;
        add(std::sin(angle), std::cos(angle));
    }
    const auto count = static_cast<std::uint32_t>(segments);
    for (std::uint32_t s = 0; s < count; ++s) {
        const std::uint32_t a = center + 1 + s;
        const std::uint32_t b = center + 1 + (s + 1) % count;
        // From above, growing angles (z towards x) run counter-clockwise.
        for (const std::uint32_t corner : {center, up > 0 ? a : b, up > 0 ? b : a}) {
            mesh.indices.push_back(corner);
        }
    }
}

}  // namespace

std::shared_ptr<const MeshAsset> make_box(const glm::vec3& size_m) {
    MeshAsset mesh;
    const glm::dvec3 half = 0.5 * glm::dvec3(size_m);
    for (int axis = 0; axis < 3; ++axis) {
        for (const double side : {-1.0, 1.0}) {
            glm::dvec3 normal(0);
            glm::dvec3 right(0);
            glm::dvec3 up(0);
            normal[axis] = side;
            // Upright sides have v along y; right x up = normal.
            up[axis == 1 ? 2 : 1] = axis == 1 ? -side : 1;
            right = glm::cross(up, normal);
            add_patch(mesh, 1, 1, [&](double u, double v) {
                return SurfacePoint{half * (normal + (2 * u - 1) * right + (2 * v - 1) * up),
                                    normal};
            });
        }
    }
    return finish(std::move(mesh), "box");
}

std::shared_ptr<const MeshAsset> make_sphere(float radius_m, int segments, int rings) {
    MeshAsset mesh;
    add_patch(mesh, std::max(segments, 3), std::max(rings, 2), [&](double u, double v) {
        const double latitude = std::numbers::pi * (v - 0.5);
        // Exactly at the poles, so that all of a pole's vertices are one point.
        const double across = v == 0 || v == 1 ? 0 : std::cos(latitude);
        const glm::dvec3 n(across * std::sin(kTau * u), std::sin(latitude),
                           across * std::cos(kTau * u));
        return SurfacePoint{n * static_cast<double>(radius_m), n};
    });
    return finish(std::move(mesh), "sphere");
}

std::shared_ptr<const MeshAsset> make_cylinder(float radius_m, float height_m, int segments) {
    MeshAsset mesh;
    const int round = std::max(segments, 3);
    add_patch(mesh, round, 1, [&](double u, double v) {
        const glm::dvec3 n(std::sin(kTau * u), 0, std::cos(kTau * u));
        return SurfacePoint{
            n * static_cast<double>(radius_m) + glm::dvec3(0, (v - 0.5) * height_m, 0), n};
    });
    add_disc(mesh, radius_m, -0.5 * height_m, -1, round);
    add_disc(mesh, radius_m, 0.5 * height_m, 1, round);
    return finish(std::move(mesh), "cylinder");
}

std::shared_ptr<const MeshAsset> make_cone(float radius_m, float height_m, int segments) {
    MeshAsset mesh;
    const int round = std::max(segments, 3);
    add_patch(mesh, round, 1, [&](double u, double v) {
        const glm::dvec3 out(std::sin(kTau * u), 0, std::cos(kTau * u));
        return SurfacePoint{
            out * (radius_m * (1 - v)) + glm::dvec3(0, (v - 0.5) * height_m, 0),
            glm::normalize(out * static_cast<double>(height_m) + glm::dvec3(0, radius_m, 0))};
    });
    add_disc(mesh, radius_m, -0.5 * height_m, -1, round);
    return finish(std::move(mesh), "cone");
}

std::shared_ptr<const MeshAsset> make_grid(float width_m, float depth_m, int columns, int rows) {
    MeshAsset mesh;
    add_patch(mesh, std::max(columns, 1), std::max(rows, 1), [&](double u, double v) {
        return SurfacePoint{{(u - 0.5) * width_m, 0, (0.5 - v) * depth_m}, {0, 1, 0}};
    });
    return finish(std::move(mesh), "grid");
}

std::shared_ptr<const MeshAsset> make_torus(float ring_radius_m, float tube_radius_m, int segments,
                                            int sides) {
    MeshAsset mesh;
    add_patch(mesh, std::max(segments, 3), std::max(sides, 3), [&](double u, double v) {
        const glm::dvec3 out(std::sin(kTau * u), 0, std::cos(kTau * u));
        const glm::dvec3 n = out * std::cos(kTau * v) + glm::dvec3(0, std::sin(kTau * v), 0);
        return SurfacePoint{
            out * static_cast<double>(ring_radius_m) + n * static_cast<double>(tube_radius_m), n};
    });
    return finish(std::move(mesh), "torus");
}

void set_bounding_sphere(MeshAsset& mesh) {
    if (mesh.positions.empty()) return;
    glm::vec3 low = mesh.positions.front();
    glm::vec3 high = low;
    for (const glm::vec3& p : mesh.positions) {
        low = glm::min(low, p);
        high = glm::max(high, p);
    }
    mesh.sphere_center = 0.5f * low + 0.5f * high;
    double squared = 0;
    for (const glm::vec3& p : mesh.positions) {
        const glm::dvec3 d = glm::dvec3(p) - glm::dvec3(mesh.sphere_center);
        squared = std::max(squared, glm::dot(d, d));
    }
    // One float up at least, so that rounding leaves nobody outside.
    mesh.sphere_radius_m = std::nextafter(static_cast<float>(std::sqrt(squared)), INFINITY);
}

std::string broken_invariant(const MeshAsset& mesh) {
    const std::size_t vertices = mesh.positions.size();
    const auto finite = [](const auto& v) {
        for (int i = 0; i < v.length(); ++i) {
            if (!std::isfinite(v[i])) return false;
        }
        return true;
    };
    if (vertices == 0 || mesh.indices.empty()) return "no triangles";
    if (mesh.normals.size() != vertices) return "normals differ from positions in number";
    if (!mesh.uvs.empty() && mesh.uvs.size() != vertices) return "uvs differ in number";
    if (mesh.joints.size() != mesh.weights.size()) return "joints and weights differ in number";
    if (mesh.skinned() && mesh.joints.size() != vertices) return "joints differ in number";
    if (mesh.indices.size() % 3 != 0) return "indices are not whole triangles";
    for (const std::uint32_t index : mesh.indices) {
        if (index >= vertices) return "an index lies beyond the vertices";
    }
    for (std::size_t v = 0; v < vertices; ++v) {
        if (!finite(mesh.positions[v])) return "a position is not finite";
        const float length = glm::length(mesh.normals[v]);
        if (!(std::abs(length - 1) < 1e-3f)) return "a normal is not of unit length";
        if (!mesh.uvs.empty() && !finite(mesh.uvs[v])) return "a uv is not finite";
        if (!mesh.skinned()) continue;
        float sum = 0;
        for (int k = 0; k < 4; ++k) {
            if (!(mesh.weights[v][k] >= 0)) return "a weight is negative or not a number";
            sum += mesh.weights[v][k];
        }
        if (!(std::abs(sum - 1) < 1e-3f)) return "weights do not sum to one";
    }
    if (!finite(mesh.sphere_center) || !std::isfinite(mesh.sphere_radius_m)) {
        return "the bounding sphere is not finite";
    }
    for (const glm::vec3& p : mesh.positions) {
        if (glm::length(p - mesh.sphere_center) > mesh.sphere_radius_m * (1 + 1e-5f) + 1e-6f) {
            return "a vertex lies outside the bounding sphere";
        }
    }
    return {};
}

}  // namespace kino
