#include "viz/surface/mesh_table.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/packing.hpp>

#include "base/check.h"
#include "viz/scene/joint_turn.h"

namespace kino {
namespace {

const Material& material_of(const Scene& scene, const MeshNode& node) {
    static const Material kPlain;
    return node.material == 0 || node.material > scene.materials.size()
               ? kPlain
               : scene.materials[node.material - 1];
}

glm::dmat4 view_from_world(const View& view) {
    const Pose pose = inverse(view.world_from_view);
    glm::dmat4 m = glm::mat4_cast(pose.rotation);
    m[3] = glm::dvec4(pose.translation, 1.0);
    return m;
}

bool is_finite(const glm::dmat4& m) {
    for (int c = 0; c < 4; ++c) {
        for (int r = 0; r < 4; ++r) {
            // Also what float cannot hold.
            if (!(std::abs(m[c][r]) < 1e30)) return false;
        }
    }
    return true;
}

glm::vec4 row_of(const glm::dmat4& m, int r) {
    return {m[0][r], m[1][r], m[2][r], m[3][r]};
}

/// Rows of the inverse transpose up to a positive factor: cofactors, which exist for flat
/// matrices, too.
glm::dmat3 normal_matrix(const glm::dmat3& m) {
    const glm::dmat3 t = glm::transpose(m);
    glm::dmat3 cofactors(glm::cross(t[1], t[2]), glm::cross(t[2], t[0]), glm::cross(t[0], t[1]));
    double largest = 0;
    for (int r = 0; r < 3; ++r) {
        for (int c = 0; c < 3; ++c) largest = std::max(largest, std::abs(cofactors[r][c]));
    }
    const double sign = glm::dot(t[0], cofactors[0]) < 0 ? -1 : 1;
    return largest > 0 ? cofactors * (sign / largest) : cofactors;
}

struct Sphere {
    glm::dvec3 center{0};
    double radius_m = 0;
};

/// Round a posed mesh. Blended linearly, every vertex is a mean of where its joints take it, so it
/// lies in the hull of the joints' spheres. Blended dual quaternions take it as far from any point
/// as that mean of the distances over the length of the blended quaternion, which is at least the
/// largest weight: a quarter.
Sphere posed_sphere(const PooledMesh& mesh, const std::vector<glm::mat4>& pose, SkinBlend blend) {
    std::vector<Sphere> moved;
    glm::dvec3 low(INFINITY);
    glm::dvec3 high(-INFINITY);
    for (std::size_t j = 0; j < mesh.joint_spheres.size(); ++j) {
        const glm::vec4 sphere = mesh.joint_spheres[j];
        if (sphere.w < 0) continue;
        const glm::dmat4 m(pose[std::min(j, pose.size() - 1)]);
        Sphere s{glm::dvec3(m * glm::dvec4(glm::dvec3(sphere), 1.0)),
                 sphere.w * largest_stretch(glm::dmat3(m))};
        low = glm::min(low, s.center - s.radius_m);
        high = glm::max(high, s.center + s.radius_m);
        moved.push_back(s);
    }
    if (moved.empty()) return {};
    Sphere all{0.5 * (low + high), 0};
    for (const Sphere& s : moved) {
        all.radius_m = std::max(all.radius_m, glm::length(s.center - all.center) + s.radius_m);
    }
    if (blend == SkinBlend::dual_quaternion) all.radius_m *= 4;
    return all;
}

}  // namespace

bool is_blended(const Scene& scene, const MeshNode& node) {
    return material_of(scene, node).opacity < 1;
}

MaterialKind kind_of(const Scene& scene, const MeshNode& node) {
    return material_of(scene, node).kind;
}

double largest_stretch(const glm::dmat3& m) {
    // Largest eigenvalue of the symmetric m^T m by its characteristic polynomial (Smith 1961,
    // "Eigenvalues of a symmetric 3 x 3 matrix").
    const glm::dmat3 b = glm::transpose(m) * m;
    const double off = b[1][0] * b[1][0] + b[2][0] * b[2][0] + b[2][1] * b[2][1];
    const double mean = (b[0][0] + b[1][1] + b[2][2]) / 3;
    double eigenvalue = std::max({b[0][0], b[1][1], b[2][2]});
    if (off > 0) {
        const double p2 = (b[0][0] - mean) * (b[0][0] - mean) +
                          (b[1][1] - mean) * (b[1][1] - mean) +
                          (b[2][2] - mean) * (b[2][2] - mean) + 2 * off;
        const double p = std::sqrt(p2 / 6);
        const glm::dmat3 scaled = (b - mean * glm::dmat3(1.0)) * (1 / p);
        const double r = std::clamp(glm::determinant(scaled) / 2, -1.0, 1.0);
        eigenvalue = mean + 2 * p * std::cos(std::acos(r) / 3);
    }
    return std::sqrt(std::max(eigenvalue, 0.0)) * (1 + 1e-6);
}

std::array<glm::dvec3, 4> side_planes(const View& view) {
    const Projection& p = view.projection;
    // Where the picture's edges cut the plane z = 1.
    const double left = (-0.5 - p.cx) / p.fx;
    const double right = (view.width - 0.5 - p.cx) / p.fx;
    const double top = (-0.5 - p.cy) / p.fy;
    const double bottom = (view.height - 0.5 - p.cy) / p.fy;
    return {glm::normalize(glm::dvec3(1, 0, -left)), glm::normalize(glm::dvec3(-1, 0, right)),
            glm::normalize(glm::dvec3(0, 1, -top)), glm::normalize(glm::dvec3(0, -1, bottom))};
}

bool may_be_seen(const std::array<glm::dvec3, 4>& sides, double near_m, const glm::dvec3& center,
                 double radius_m) {
    // Floats of the shader and of the table are off by less than this.
    const double reach = radius_m + 1e-5 * (glm::length(center) + radius_m);
    // Written so that nothing which is not a number passes.
    bool seen = radius_m >= 0 && center.z + reach >= near_m && reach < 1e30;
    for (const glm::dvec3& side : sides) seen = seen && glm::dot(side, center) >= -reach;
    return seen;
}

VkDrawIndexedIndirectCommand call_of(const shared::MeshDraw& draw, std::uint32_t row) {
    // The draw's first vertex travels in its row; a vertex offset would add it once more.
    return {.indexCount = draw.index_count,
            .instanceCount = 1,
            .firstIndex = draw.first_index,
            .vertexOffset = 0,
            .firstInstance = row};
}

MeshTable make_mesh_table(const Scene& scene, const View& view, const MeshPool& pool,
                          MeshFilter filter, std::uint32_t kinds) {
    MeshTable table;
    table.rows.reserve(scene.meshes.size());
    const glm::dmat4 from_world = view_from_world(view);
    const auto sides = side_planes(view);
    for (const MeshNode& node : scene.meshes) {
        if (is_blended(scene, node) != (filter == MeshFilter::blended)) continue;
        if ((kinds >> static_cast<std::uint32_t>(kind_of(scene, node)) & 1u) == 0) continue;
        const PooledMesh* mesh = pool.find(node.mesh.get());
        if (mesh == nullptr) continue;
        const glm::dmat4 m = from_world * node.world_from_object;
        const bool posed = mesh->asset->skinned() && node.pose != nullptr && !node.pose->empty();
        Sphere sphere = posed ? posed_sphere(*mesh, *node.pose, node.skin)
                              : Sphere{mesh->asset->sphere_center, mesh->asset->sphere_radius_m};
        sphere.center = glm::dvec3(m * glm::dvec4(sphere.center, 1.0));
        sphere.radius_m *= largest_stretch(glm::dmat3(m));
        if (!is_finite(m) || !(sphere.radius_m < 1e30)) {
            ++table.refused;
            continue;
        }
        // Skinning what nobody sees is the dearest of all waste.
        if (posed && !may_be_seen(sides, view.projection.near_m, sphere.center, sphere.radius_m)) {
            continue;
        }
        const Material& material = material_of(scene, node);
        const std::uint32_t texture = node.material == 0 ? 0 : pool.texture_of(node.material - 1);
        const glm::dmat3 normals = normal_matrix(glm::dmat3(m));
        shared::MeshDraw row{};
        row.view_from_object_x = row_of(m, 0);
        row.view_from_object_y = row_of(m, 1);
        row.view_from_object_z = row_of(m, 2);
        row.normal_x = normals[0];
        row.normal_y = normals[1];
        row.normal_z = normals[2];
        row.object = node.material << 16 | (node.id & 0xFFFFu);
        row.color_rg = glm::packHalf2x16({material.base_color.r, material.base_color.g});
        row.color_b_texture = glm::packHalf2x16({material.base_color.b, 0}) | texture << 16;
        if (glm::determinant(glm::dmat3(m)) < 0) row.color_b_texture |= 1u << 31;
        row.sphere_center = sphere.center;
        row.sphere_radius_m = static_cast<float>(sphere.radius_m);
        row.first_index = mesh->first_index;
        row.index_count = static_cast<std::uint32_t>(mesh->asset->indices.size());
        row.static_first = mesh->first_vertex;
        std::uint32_t format = KINO_FORMAT_STATIC;
        std::uint32_t first = mesh->first_vertex;
        if (posed) {
            const bool dual = node.skin == SkinBlend::dual_quaternion;
            format = KINO_FORMAT_SKINNED;
            first = table.skinned_vertices;
            table.skins.push_back(
                {.vertices = mesh->vertices,
                 .source_first = mesh->first_vertex,
                 .target_first = first,
                 .weights_first = mesh->first_weight,
                 .joints_first = static_cast<std::uint32_t>(table.joint_rows.size()),
                 .joints = static_cast<std::uint32_t>(node.pose->size()),
                 .blend = dual ? KINO_SKIN_DUAL : KINO_SKIN_LINEAR});
            for (const glm::mat4& joint : *node.pose) {
                for (int r = 0; r < 3; ++r) table.joint_rows.push_back(row_of(joint, r));
                if (!dual) continue;
                const glm::dquat turn = nearest_rotation(glm::dmat3(joint));
                table.joint_rows.emplace_back(turn.x, turn.y, turn.z, turn.w);
            }
            table.skinned_vertices += mesh->vertices;
            KINO_CHECK_LT(table.skinned_vertices, 1u << KINO_FIRST_VERTEX_BITS);
        }
        row.id = format << KINO_FIRST_VERTEX_BITS | first;
        table.formats |= 1u << format;
        table.textured = table.textured || texture != 0;
        table.rows.push_back(row);
    }
    if (filter == MeshFilter::blended) {
        std::stable_sort(table.rows.begin(), table.rows.end(), [](const auto& a, const auto& b) {
            return a.sphere_center.z > b.sphere_center.z;
        });
    }
    return table;
}

}  // namespace kino
