#include "apps/viewer/zoom_work.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat4x4.hpp>
#include <glm/matrix.hpp>
#include <limits>
#include <utility>

namespace kino {
namespace {

/// Samples of the live depth picture along each side.
constexpr int kLiveColumns = 48, kLiveRows = 36;
constexpr std::size_t kMostBoxes = 4096;

double lobes_of(const Scene& scene, std::uint32_t material) {
    if (material == 0 || material > scene.materials.size()) return 1;
    const Material& m = scene.materials[material - 1];
    if (m.kind == MaterialKind::unlit) return 0;
    if (m.kind == MaterialKind::toon) return 1;
    std::size_t lobes = 0;
    for (const MaterialLayer& layer : m.layers) lobes += layer.lobes.size();
    return static_cast<double>(std::max<std::size_t>(1, lobes));
}

bool reaches(const Light& light, const glm::dvec3& point) {
    if (light.kind == LightKind::directional) return true;
    const glm::dvec3 to = point - light.position;
    const double d2 = glm::dot(to, to);
    if (!(d2 < static_cast<double>(light.radius_m) * light.radius_m)) return false;
    if (light.kind == LightKind::point) return true;
    const double along = glm::dot(to, light.direction);
    return along >
           std::cos(light.outer_rad) * std::sqrt(d2 * glm::dot(light.direction, light.direction));
}

}  // namespace

ZoomWork FrameWork::counted() const {
    return {.vertices = live_points + vertices,
            .triangles = triangles,
            .draws = draws,
            .pixels = {pixels, covered, lobes, shadowed}};
}

ZoomWork FrameWork::of_group(std::string_view group) const {
    if (group == "light") return {.pixels = {0, covered, lobes, 0}};
    if (group == "shadows") return {.pixels = {0, 0, 0, shadowed}};
    if (group == "meshes") {
        return {.vertices = vertices,
                .triangles = triangles,
                .draws = draws,
                .pixels = {0, covered, 0, 0}};
    }
    if (group == "raster") return {.vertices = live_points, .pixels = {pixels, 0, 0, 0}};
    if (group == "final" || group == "cull" || group == "lod" || group == "normals") {
        return {.pixels = {pixels, 0, 0, 0}};
    }
    return {.pixels = {0, 0, 0, 0}};
}

const WorkCounter::Box& WorkCounter::box_of(const std::shared_ptr<const MeshAsset>& mesh) {
    if (boxes_.size() > kMostBoxes) {
        std::erase_if(boxes_, [](const auto& entry) { return entry.second.mesh.expired(); });
    }
    Box& box = boxes_[mesh.get()];
    if (!box.mesh.expired()) return box;
    box.mesh = mesh;
    box.least = glm::vec3(std::numeric_limits<float>::max());
    box.most = -box.least;
    for (const glm::vec3& p : mesh->positions) {
        box.least = glm::min(box.least, p);
        box.most = glm::max(box.most, p);
    }
    return box;
}

void WorkCounter::add_mesh(const MeshNode& node, const Scene& scene, const View& view,
                           FrameWork& work) {
    if (!node.mesh || node.mesh->positions.empty()) return;
    const Box& box = box_of(node.mesh);
    const glm::dmat4 view_from_object =
        inverse(view.world_from_view).matrix() * node.world_from_object;
    // Cells whose rays may hit: those of the corners' bounds, or all where one is not before us.
    double left = kColumns, right = 0, top = kRows, bottom = 0;
    const Projection& p = view.projection;
    int before = 0;
    for (int corner = 0; corner < 8; ++corner) {
        const glm::dvec4 at(corner & 1 ? box.most.x : box.least.x,
                            corner & 2 ? box.most.y : box.least.y,
                            corner & 4 ? box.most.z : box.least.z, 1);
        const glm::dvec4 seen = view_from_object * at;
        if (!(seen.z > p.near_m)) continue;
        ++before;
        const double x = (p.fx * seen.x / seen.z + p.cx + 0.5) / view.width * kColumns;
        const double y = (p.fy * seen.y / seen.z + p.cy + 0.5) / view.height * kRows;
        left = std::min(left, x), right = std::max(right, x);
        top = std::min(top, y), bottom = std::max(bottom, y);
    }
    if (before == 0) return;
    if (before < 8) {
        left = top = 0;
        right = kColumns, bottom = kRows;
    }
    if (!(right > 0 && left < kColumns && bottom > 0 && top < kRows)) return;
    work.draws += 1;
    work.vertices += static_cast<double>(node.mesh->positions.size());
    work.triangles += static_cast<double>(node.mesh->indices.size()) / 3;
    const auto cell = [](double at, int most) {
        return static_cast<int>(std::clamp(at, 0.0, static_cast<double>(most)));
    };
    // A ray goes through a cell's centre.
    const int first_x = cell(std::ceil(left - 0.5), kColumns);
    const int last_x = cell(std::floor(right - 0.5) + 1, kColumns);
    const int first_y = cell(std::ceil(top - 0.5), kRows);
    const int last_y = cell(std::floor(bottom - 0.5) + 1, kRows);
    if (first_x >= last_x || first_y >= last_y) return;
    const glm::dmat4 object_from_view = glm::inverse(view_from_object);
    const glm::dvec3 eye(object_from_view[3]);
    const double lobes = lobes_of(scene, node.material);
    for (int y = first_y; y < last_y; ++y) {
        for (int x = first_x; x < last_x; ++x) {
            const glm::dvec3 ray(((x + 0.5) / kColumns * view.width - 0.5 - p.cx) / p.fx,
                                 ((y + 0.5) / kRows * view.height - 0.5 - p.cy) / p.fy, 1);
            const glm::dvec3 along(object_from_view * glm::dvec4(ray, 0));
            double enters = -std::numeric_limits<double>::infinity();
            double leaves = std::numeric_limits<double>::infinity();
            for (int axis = 0; axis < 3; ++axis) {
                const double a = (box.least[axis] - eye[axis]) / along[axis];
                const double b = (box.most[axis] - eye[axis]) / along[axis];
                // Parallel and between both planes gives two infinities, else no overlap.
                enters = std::max(enters, std::min(a, b));
                leaves = std::min(leaves, std::max(a, b));
            }
            if (!(enters <= leaves) || !(leaves > p.near_m)) continue;
            // Who stands within a box sees its far side: rooms are seen from within.
            const double z = enters > p.near_m ? enters : leaves;
            Hit& hit = hits_[static_cast<std::size_t>(y * kColumns + x)];
            if (hit.z_m > 0 && hit.z_m <= z) continue;
            hit = {.z_m = z, .lobes = lobes, .material = node.material};
        }
    }
}

void WorkCounter::add_live(const LiveDepth& live, const View& view, FrameWork& work) {
    if (!live.surface || live.surface->depth_m.empty() || !live.surface->rays) return;
    const Image<float>& depth = live.surface->depth_m;
    const Image<RayXy>& rays = *live.surface->rays;
    work.live_points = static_cast<double>(depth.size());
    const Pose view_from_depth = inverse(view.world_from_view) * live.world_from_depth;
    const int step_x = std::max(1, depth.width() / kLiveColumns);
    const int step_y = std::max(1, depth.height() / kLiveRows);
    const Projection& p = view.projection;
    for (int v = step_y / 2; v < depth.height(); v += step_y) {
        for (int u = step_x / 2; u < depth.width(); u += step_x) {
            const double d = depth.at(u, v);
            if (!(d > 0)) continue;
            const RayXy ray = rays.at(u, v);
            const glm::dvec3 seen = view_from_depth * glm::dvec3(ray.x * d, ray.y * d, d);
            if (!(seen.z > p.near_m)) continue;
            const int x = static_cast<int>(
                std::floor((p.fx * seen.x / seen.z + p.cx + 0.5) / view.width * kColumns));
            const int y = static_cast<int>(
                std::floor((p.fy * seen.y / seen.z + p.cy + 0.5) / view.height * kRows));
            if (x < 0 || y < 0 || x >= kColumns || y >= kRows) continue;
            Hit& hit = hits_[static_cast<std::size_t>(y * kColumns + x)];
            if (hit.z_m > 0 && hit.z_m <= seen.z) continue;
            hit = {.z_m = seen.z, .lobes = 1, .material = 0};
        }
    }
}

void WorkCounter::light(const Scene& scene, const View& view, FrameWork& work) const {
    const double pixels_a_cell = work.pixels / (kColumns * kRows);
    const Projection& p = view.projection;
    for (int y = 0; y < kRows; ++y) {
        for (int x = 0; x < kColumns; ++x) {
            const Hit& hit = hits_[static_cast<std::size_t>(y * kColumns + x)];
            if (!(hit.z_m > 0)) continue;
            work.covered += pixels_a_cell;
            const glm::dvec3 ray(((x + 0.5) / kColumns * view.width - 0.5 - p.cx) / p.fx,
                                 ((y + 0.5) / kRows * view.height - 0.5 - p.cy) / p.fy, 1);
            const glm::dvec3 point = view.world_from_view * (hit.z_m * ray);
            double lights = 0, shadows = 0;
            for (const Light& light : scene.lights) {
                if ((light.material_mask >> (hit.material & 31u) & 1u) == 0) continue;
                if (!reaches(light, point)) continue;
                lights += 1;
                shadows += light.shadow == LightShadow::raycast ? 1 : 0;
            }
            work.lobes += pixels_a_cell * lights * hit.lobes;
            work.shadowed += pixels_a_cell * shadows;
        }
    }
}

FrameWork WorkCounter::count(const Scene& scene, const View& view) {
    FrameWork work;
    work.pixels = static_cast<double>(std::max(0, view.width)) * std::max(0, view.height);
    if (!(work.pixels > 0)) return work;
    hits_.fill({});
    for (const MeshNode& node : scene.meshes) add_mesh(node, scene, view, work);
    if (scene.live) add_live(*scene.live, view, work);
    light(scene, view, work);
    return work;
}

}  // namespace kino
