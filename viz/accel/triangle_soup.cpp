#include "viz/accel/triangle_soup.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <glm/vec4.hpp>

#include "base/check.h"

namespace kino {
namespace {

constexpr float kFarthest = 1e9f;

bool is_near(const glm::vec3& p) {
    // False for NaN, too.
    return std::abs(p.x) < kFarthest && std::abs(p.y) < kFarthest && std::abs(p.z) < kFarthest;
}

glm::dvec3 posed(const MeshNode& node, std::uint32_t vertex) {
    const MeshAsset& mesh = *node.mesh;
    const glm::vec4 rest(mesh.positions[vertex], 1);
    if (!mesh.skinned() || node.pose == nullptr) return rest;
    glm::vec4 sum(0);
    for (int k = 0; k < 4; ++k) {
        const float weight = mesh.weights[vertex][k];
        if (weight == 0) continue;
        sum += weight * (node.pose->at(mesh.joints[vertex][static_cast<std::size_t>(k)]) * rest);
    }
    return sum;
}

void gather_mesh(const MeshNode& node, TriangleSoup& soup) {
    const MeshAsset& mesh = *node.mesh;
    std::vector<glm::vec3> places(mesh.positions.size());
    for (std::uint32_t i = 0; i < places.size(); ++i) {
        const glm::dvec3 world = node.world_from_object * glm::dvec4(posed(node, i), 1);
        places[i] = world - soup.center;
    }
    for (std::uint32_t face = 0; 3 * face + 2 < mesh.indices.size(); ++face) {
        const std::uint32_t* corner = &mesh.indices[std::size_t{3} * face];
        soup.add({places[corner[0]], places[corner[1]], places[corner[2]]}, {node.id, face});
    }
}

// The same triangles as the rasterisers draw (viz/surface/depth_grid.glsl).
float edge_limit(const LiveDepth& live, float z, double focal_px) {
    if (live.edge_rule == EdgeRule::fixed) return 0.075f;
    return 3.0f * 0.00307f * z * z + 5.6712818f * z / static_cast<float>(focal_px);
}

void gather_live(const LiveDepth& live, int stride, TriangleSoup& soup) {
    const DepthSurface& surface = *live.surface;
    KINO_CHECK(stride > 0 && surface.rays != nullptr);
    const int width = (surface.depth_m.width() + stride - 1) / stride;
    const int height = (surface.depth_m.height() + stride - 1) / stride;
    const double focal_px = surface.focal_px / stride;
    Image<glm::vec3> places(std::max(width, 0), std::max(height, 0));
    const auto depth = [&](int x, int y) { return surface.depth_m.at(x * stride, y * stride); };
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const double z = depth(x, y);
            const RayXy ray = surface.rays->at(x * stride, y * stride);
            places.at(x, y) =
                live.world_from_depth * glm::dvec3(ray.x * z, ray.y * z, z) - soup.center;
        }
    }
    const auto whole = [&](float a, float b, float c) {
        const float nearest = std::min({a, b, c});
        const float farthest = std::max({a, b, c});
        return nearest > 0.1f && farthest - nearest < edge_limit(live, nearest, focal_px);
    };
    for (int y = 0; y + 1 < height; ++y) {
        for (int x = 0; x + 1 < width; ++x) {
            const auto cell = static_cast<std::uint32_t>(y * (width - 1) + x);
            const float z10 = depth(x + 1, y);
            const float z01 = depth(x, y + 1);
            const glm::vec3 p10 = places.at(x + 1, y);
            const glm::vec3 p01 = places.at(x, y + 1);
            if (whole(depth(x, y), z10, z01)) soup.add({places.at(x, y), p10, p01}, {0, 2 * cell});
            if (whole(z10, depth(x + 1, y + 1), z01)) {
                soup.add({p10, places.at(x + 1, y + 1), p01}, {0, 2 * cell + 1});
            }
        }
    }
}

bool is_finite(const glm::dvec3& p) {
    return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

}  // namespace

TriangleFault fault_of(const Triangle& t) {
    if (!(is_near(t.a) && is_near(t.b) && is_near(t.c))) return TriangleFault::not_finite;
    const glm::dvec3 a = t.a;
    const glm::dvec3 normal = glm::cross(glm::dvec3(t.b) - a, glm::dvec3(t.c) - a);
    return normal == glm::dvec3(0) ? TriangleFault::zero_area : TriangleFault::none;
}

void TriangleSoup::add(const Triangle& triangle, Source source) {
    switch (fault_of(triangle)) {
        case TriangleFault::not_finite:
            ++not_finite;
            return;
        case TriangleFault::zero_area:
            ++zero_area;
            return;
        case TriangleFault::none:
            break;
    }
    triangles.push_back(triangle);
    sources.push_back(source);
}

TriangleSoup gather_live_triangles(const LiveDepth& live, int stride, const glm::dvec3& center) {
    TriangleSoup soup;
    soup.center = center;
    gather_live(live, stride, soup);
    return soup;
}

TriangleSoup gather_triangles(const Scene& scene, const GatherOptions& options) {
    TriangleSoup soup;
    glm::dvec3 sum(0);
    int places = 0;
    if (options.meshes) {
        for (const MeshNode& node : scene.meshes) {
            const glm::dvec3 middle =
                node.world_from_object * glm::dvec4(node.mesh->sphere_center, 1);
            if (!is_finite(middle)) continue;
            sum += middle;
            ++places;
        }
    }
    const bool live = options.live && scene.live.has_value() && scene.live->surface != nullptr;
    if (live) {
        sum += scene.live->world_from_depth * glm::dvec3(0, 0, 2);
        ++places;
    }
    if (places > 0) soup.center = sum / double(places);
    if (options.meshes) {
        for (const MeshNode& node : scene.meshes) gather_mesh(node, soup);
    }
    if (live) gather_live(*scene.live, options.live_stride, soup);
    return soup;
}

}  // namespace kino
