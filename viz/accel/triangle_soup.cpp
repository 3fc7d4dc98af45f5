#include "viz/accel/triangle_soup.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/matrix.hpp>
#include <glm/vec4.hpp>

#include "base/check.h"
#include "viz/scene/joint_turn.h"

namespace kino {
namespace {

constexpr float kFarthest = 1e9f;

bool is_near(const glm::vec3& p) {
    // False for NaN, too.
    return std::abs(p.x) < kFarthest && std::abs(p.y) < kFarthest && std::abs(p.z) < kFarthest;
}

/// Vertices of a node as they are drawn (viz/surface/mesh_skin.comp), object space, in double.
class PosedVertices {
  public:
    explicit PosedVertices(const MeshNode& node) : node_(node) {
        if (!is_posed() || node.skin != SkinBlend::dual_quaternion) return;
        for (const glm::mat4& joint : *node.pose) {
            turns_.push_back(nearest_rotation(glm::dmat3(glm::dmat4(joint))));
        }
    }

    [[nodiscard]] glm::dvec3 operator()(std::uint32_t vertex) const {
        const glm::dvec4 rest(node_.mesh->positions[vertex], 1);
        if (!is_posed()) return rest;
        const auto& joints = node_.mesh->joints[vertex];
        const glm::vec4 weights = node_.mesh->weights[vertex];
        glm::dvec4 mean(0);
        glm::dquat turn(0, 0, 0, 0);
        glm::dquat moved(0, 0, 0, 0);
        int strongest = 0;
        for (int k = 1; k < 4; ++k) strongest = weights[k] > weights[strongest] ? k : strongest;
        for (int k = 0; k < 4; ++k) {
            if (weights[k] == 0) continue;
            const std::size_t joint = joints[static_cast<std::size_t>(k)];
            const glm::dvec4 place = glm::dmat4(node_.pose->at(joint)) * rest;
            mean += static_cast<double>(weights[k]) * place;
            if (turns_.empty()) continue;
            const glm::dquat& first = turns_[joints[static_cast<std::size_t>(strongest)]];
            const double side = glm::dot(turns_[joint], first) < 0 ? -1 : 1;
            const glm::dquat part = turns_[joint] * (side * static_cast<double>(weights[k]));
            turn = turn + part;
            moved = moved + glm::dquat(0, glm::dvec3(place)) * part;
        }
        const double squared = glm::dot(turn, turn);
        if (!(squared > 0)) return mean;
        const glm::dquat v = moved * glm::conjugate(turn);
        return glm::dvec3(v.x, v.y, v.z) / squared;
    }

  private:
    [[nodiscard]] bool is_posed() const { return node_.mesh->skinned() && node_.pose != nullptr; }

    const MeshNode& node_;
    std::vector<glm::dquat> turns_;  // dual quaternions alone
};

void gather_mesh(const MeshNode& node, TriangleSoup& soup) {
    const MeshAsset& mesh = *node.mesh;
    const PosedVertices posed(node);
    std::vector<glm::vec3> places(mesh.positions.size());
    for (std::uint32_t i = 0; i < places.size(); ++i) {
        const glm::dvec3 world = node.world_from_object * glm::dvec4(posed(i), 1);
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
