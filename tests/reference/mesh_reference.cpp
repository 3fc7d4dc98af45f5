#include "tests/reference/mesh_reference.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace kino::test {
namespace {

glm::dvec3 inverse_transposed(const glm::dmat3& m, const glm::dvec3& n) {
    return glm::normalize(glm::transpose(glm::inverse(m)) * n);
}

}  // namespace

WorldVertices place_vertices(const MeshNode& node) {
    const MeshAsset& mesh = *node.mesh;
    const bool posed = mesh.skinned() && node.pose != nullptr && !node.pose->empty();
    WorldVertices placed;
    for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
        glm::dmat4 object_from_mesh(1.0);
        if (posed) {
            double sum = 0;
            for (int k = 0; k < 4; ++k) sum += mesh.weights[v][k];
            object_from_mesh = glm::dmat4(0.0);
            for (int k = 0; k < 4; ++k) {
                const std::size_t joint =
                    std::min<std::size_t>(sum > 0 ? mesh.joints[v][k] : 0, node.pose->size() - 1);
                const double weight = sum > 0 ? mesh.weights[v][k] / sum : (k == 0 ? 1.0 : 0.0);
                object_from_mesh += weight * glm::dmat4((*node.pose)[joint]);
            }
        }
        const glm::dmat4 m = node.world_from_object * object_from_mesh;
        placed.positions.emplace_back(m * glm::dvec4(glm::dvec3(mesh.positions[v]), 1.0));
        placed.normals.push_back(inverse_transposed(glm::dmat3(m), glm::dvec3(mesh.normals[v])));
    }
    return placed;
}

Image<MeshHit> cast_meshes(const Scene& scene, const View& view) {
    Image<MeshHit> picture(view.width, view.height);
    const Pose view_from_world = inverse(view.world_from_view);
    const Projection& k = view.projection;
    for (std::size_t n = 0; n < scene.meshes.size(); ++n) {
        const MeshNode& node = scene.meshes[n];
        WorldVertices placed = place_vertices(node);
        for (glm::dvec3& p : placed.positions) p = view_from_world * p;
        for (glm::dvec3& v : placed.normals) v = view_from_world.rotation * v;
        const bool mirrored = glm::determinant(glm::dmat3(node.world_from_object)) < 0;
        for (std::size_t t = 0; t < node.mesh->indices.size(); t += 3) {
            std::array<std::uint32_t, 3> i{};
            for (std::size_t c = 0; c < 3; ++c) i[c] = node.mesh->indices[t + c];
            const glm::dvec3 a = placed.positions[i[0]];
            const glm::dvec3 ab = placed.positions[i[1]] - a;
            const glm::dvec3 ac = placed.positions[i[2]] - a;
            // Only pixels of its own bounds, where all of it lies ahead.
            int left = 0;
            int right = view.width - 1;
            int top = 0;
            int bottom = view.height - 1;
            double nearest = std::numeric_limits<double>::infinity();
            for (const std::uint32_t c : i) nearest = std::min(nearest, placed.positions[c].z);
            if (nearest > 0) {
                glm::dvec2 low(1e9);
                glm::dvec2 high(-1e9);
                for (const std::uint32_t c : i) {
                    const glm::dvec3 p = placed.positions[c];
                    const glm::dvec2 px(k.fx * p.x / p.z + k.cx, k.fy * p.y / p.z + k.cy);
                    low = glm::min(low, px);
                    high = glm::max(high, px);
                }
                left = std::max(left, static_cast<int>(std::floor(std::max(low.x, -1.0))));
                top = std::max(top, static_cast<int>(std::floor(std::max(low.y, -1.0))));
                right = std::min(right, static_cast<int>(std::ceil(std::min(high.x, 1e5))));
                bottom = std::min(bottom, static_cast<int>(std::ceil(std::min(high.y, 1e5))));
            }
            const glm::dvec3 plane = glm::cross(ab, ac);
            for (int y = top; y <= bottom; ++y) {
                for (int x = left; x <= right; ++x) {
                    const glm::dvec3 ray((x - k.cx) / k.fx, (y - k.cy) / k.fy, 1);
                    const double down = glm::dot(plane, ray);
                    if (down == 0) continue;
                    const double z = glm::dot(plane, a) / down;
                    MeshHit& hit = picture.at(x, y);
                    if (!(z >= k.near_m) || (hit.node >= 0 && z >= hit.view_z_m)) continue;
                    const glm::dvec3 q = ray * z - a;
                    const double area = glm::dot(plane, plane);
                    const double v = glm::dot(glm::cross(q, ac), plane) / area;
                    const double w = glm::dot(glm::cross(ab, q), plane) / area;
                    if (!(v >= 0) || !(w >= 0) || !(v + w <= 1)) continue;
                    glm::dvec3 normal = (1 - v - w) * placed.normals[i[0]] +
                                        v * placed.normals[i[1]] + w * placed.normals[i[2]];
                    // Seen from inside: the other side's normal. Mirroring turns triangles round.
                    const bool from_outside = (down < 0) != mirrored;
                    normal = glm::normalize(from_outside ? normal : -normal);
                    hit = {static_cast<int>(n), static_cast<std::uint32_t>(t / 3), z, normal};
                }
            }
        }
    }
    return picture;
}

bool in_frustum(const View& view, const std::array<glm::dvec3, 3>& view_corners) {
    const Projection& k = view.projection;
    const double left = (-0.5 - k.cx) / k.fx;
    const double right = (view.width - 0.5 - k.cx) / k.fx;
    const double top = (-0.5 - k.cy) / k.fy;
    const double bottom = (view.height - 0.5 - k.cy) / k.fy;
    // Inside where n.p >= d.
    const std::array<std::pair<glm::dvec3, double>, 5> planes = {{{{0, 0, 1}, k.near_m},
                                                                  {{1, 0, -left}, 0},
                                                                  {{-1, 0, right}, 0},
                                                                  {{0, 1, -top}, 0},
                                                                  {{0, -1, bottom}, 0}}};
    std::vector<glm::dvec3> polygon(view_corners.begin(), view_corners.end());
    for (const auto& [normal, distance] : planes) {
        std::vector<glm::dvec3> kept;
        for (std::size_t i = 0; i < polygon.size(); ++i) {
            const glm::dvec3 a = polygon[i];
            const glm::dvec3 b = polygon[(i + 1) % polygon.size()];
            const double da = glm::dot(normal, a) - distance;
            const double db = glm::dot(normal, b) - distance;
            if (da >= 0) kept.push_back(a);
            if ((da >= 0) != (db >= 0)) kept.push_back(a + (b - a) * (da / (da - db)));
        }
        polygon = std::move(kept);
        if (polygon.empty()) return false;
    }
    return true;
}

}  // namespace kino::test
