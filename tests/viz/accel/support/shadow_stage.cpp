#include "tests/viz/accel/support/shadow_stage.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <optional>
#include <stdexcept>

#include "tests/support/random.h"
#include "tests/viz/accel/support/gpu_frame.h"
#include "tests/viz/accel/support/ray_meshes.h"

namespace kino::test {
namespace {

constexpr std::uint32_t kStageTilePx = 16;

std::int16_t snorm16(float x) {
    return static_cast<std::int16_t>(std::lround(std::clamp(x, -1.0f, 1.0f) * 32767));
}

std::array<std::int16_t, 2> to_octahedral(const glm::vec3& n) {
    glm::vec2 o = glm::vec2(n) / (std::abs(n.x) + std::abs(n.y) + std::abs(n.z));
    if (n.z < 0) {
        o = {(1 - std::abs(o.y)) * (o.x >= 0 ? 1.0f : -1.0f),
             (1 - std::abs(o.x)) * (o.y >= 0 ? 1.0f : -1.0f)};
    }
    return {snorm16(o.x), snorm16(o.y)};
}

glm::vec3 from_octahedral(const std::array<std::int16_t, 2>& bits) {
    const float x = std::max(static_cast<float>(bits[0]) / 32767.0f, -1.0f);
    const float y = std::max(static_cast<float>(bits[1]) / 32767.0f, -1.0f);
    glm::vec3 n(x, y, 1 - std::abs(x) - std::abs(y));
    const float fold = std::max(-n.z, 0.0f);
    n.x += n.x >= 0 ? -fold : fold;
    n.y += n.y >= 0 ? -fold : fold;
    return glm::normalize(n);
}

}  // namespace

MeshNode mesh_node(const std::vector<Triangle>& triangles, std::uint32_t id) {
    auto mesh = std::make_shared<MeshAsset>();
    for (const Triangle& t : triangles) {
        for (const glm::vec3& p : {t.a, t.b, t.c}) {
            mesh->indices.push_back(static_cast<std::uint32_t>(mesh->positions.size()));
            mesh->positions.push_back(p);
            mesh->normals.emplace_back(0, 1, 0);
        }
    }
    return {.id = id, .mesh = mesh};
}

ShadowStage::ShadowStage(const Options& options) {
    const auto triangles = room_mesh(options.balls, options.rings, 31);
    scene.meshes = {mesh_node(triangles)};
    const glm::dvec3 room(40, -3, 7);
    scene.meshes[0].world_from_object[3] = glm::dvec4(room, 1);
    view = {.width = options.width, .height = options.height};
    view.projection = perspective(1.1, view.width, view.height);
    view.world_from_view =
        look_at(room + glm::dvec3(2.5, 2.2, 2.1), room + glm::dvec3(-0.5, 0.4, -0.5));
    Random random(32);
    for (int i = 0; i < options.lights; ++i) {
        Light light;
        light.kind = options.spots && i % 3 == 1 ? LightKind::spot : LightKind::point;
        light.position = room + glm::dvec3(random.real(-2.8, 2.8), random.real(0.3, 2.9),
                                           random.real(-2.3, 2.3));
        light.direction = {random.real(-1, 1), -1, random.real(-1, 1)};
        light.outer_rad = 0.7f;
        light.radius_m =
            static_cast<float>(random.real(options.smallest_radius, options.largest_radius));
        light.shadow = options.unshadowed && i % 4 == 3 ? LightShadow::none : LightShadow::raycast;
        scene.lights.push_back(light);
    }
    scene.lights.push_back({.kind = LightKind::directional,
                            .direction = {0.3, -1, 0.2},
                            .shadow = LightShadow::raycast});
    const Bvh bvh = build_bvh(triangles);
    const glm::dmat3 rotation = glm::mat3_cast(view.world_from_view.rotation);
    const Projection& k = view.projection;
    for (int y = 0; y < view.height; ++y) {
        for (int x = 0; x < view.width; ++x) {
            const glm::dvec3 ray((x - k.cx) / k.fx, (y - k.cy) / k.fy, 1);
            const RayHit hit = closest_hit(bvh, {.origin = view.world_from_view.translation - room,
                                                 .direction = rotation * ray});
            const bool hole = options.hole && x < 9 && y < 9 && !(x == 5 && y == 5);
            view_z.push_back(hole || !hit.hit() ? 0.0f : hit.t);
            const Triangle& t = triangles[hit.hit() ? hit.triangle : 0];
            glm::dvec3 n = glm::transpose(rotation) *
                           glm::dvec3(glm::normalize(glm::cross(t.b - t.a, t.c - t.a)));
            if (glm::dot(n, ray) > 0) n = -n;
            normals.push_back(to_octahedral(n));
        }
    }
}

LiveDepth live_shell(const ShadowStage& stage, int width, int height) {
    const glm::dvec3 room = stage.scene.meshes[0].world_from_object[3];
    const Projection k = perspective(1.0, width, height);
    auto surface = std::make_shared<DepthSurface>();
    auto rays = std::make_shared<Image<RayXy>>(width, height);
    surface->depth_m.resize(width, height);
    surface->focal_px = k.fx;
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const glm::vec2 ray((x - k.cx) / k.fx, (y - k.cy) / k.fy);
            rays->at(x, y) = {ray.x, ray.y};
            const float across = glm::dot(ray, ray) / 0.3f;
            surface->depth_m.at(x, y) =
                across < 1 ? 1.5f - 0.3f * std::sqrt(1 - across) + 0.02f * std::sin(9 * ray.x) : 0;
        }
    }
    surface->rays = rays;
    return {
        .surface = surface,
        .world_from_depth = look_at(room + glm::dvec3(0, 2.9, 0), room + glm::dvec3(0.2, 0, 0.1)),
        .casts_shadows = true};
}

ShadowCast cast_shadows(gpu::Device& device, graph::Executor& executor, const ShadowStage& stage,
                        SceneBvh& bvh, const RayShadowOptions& options) {
    const auto width = static_cast<std::uint32_t>(stage.view.width);
    const auto height = static_cast<std::uint32_t>(stage.view.height);
    const auto z = make_texture(device, {width, height}, kViewZFormat, stage.view_z);
    const auto n = make_texture(device, {width, height}, kNormalFormat, stage.normals);
    graph::FrameGraph graph(executor.history());
    const ShadowSurface surface{
        graph.import_texture("z", z.image(), z.view(), {width, height, kViewZFormat}),
        graph.import_texture("n", n.image(), n.view(), {width, height, kNormalFormat})};
    ShadowCast found;
    found.lists =
        add_light_lists(graph, stage.scene, stage.view, surface.view_z, {.tile_px = kStageTilePx});
    const RayShadows shadows = add_ray_shadows(graph, stage.scene, stage.view, surface, found.lists,
                                               bvh.add(graph), options);
    const Readback<glm::uvec4> masks(device, graph, shadows.masks, std::size_t{width} * height);
    const Readback<shared::ShadowCounters> counters(device, graph, shadows.counters, 1);
    const Readback<shared::LightRecord> lights(device, graph, found.lists.lights,
                                               found.lists.global_count + found.lists.local_count);
    const bool has_lists = found.lists.tile_px != 0;
    const std::size_t tiles = has_lists ? found.lists.tiles_x * found.lists.tiles_y : 0;
    std::optional<Readback<glm::uvec2>> headers;
    std::optional<Readback<std::uint32_t>> indices;
    if (has_lists) {
        headers.emplace(device, graph, found.lists.headers, tiles);
        const std::uint32_t most = std::min(LightListOptions{}.capacity, found.lists.local_count);
        indices.emplace(device, graph, found.lists.indices, tiles * most);
    }
    const auto report = executor.run(graph, graph::Timing::every_group);
    if (!report) throw std::runtime_error(report.error().to_string());
    for (const graph::GroupTime& group : executor.group_times()) {
        if (group.group == "shadows") found.shadow_ms = group.ms;
        if (group.group == "accel build") found.build_ms = group.ms;
    }
    found.masks = masks.values();
    found.counters = counters.values()[0];
    found.lights = lights.values();
    if (has_lists) {
        found.headers = headers->values();
        found.indices = indices->values();
    }
    return found;
}

std::vector<ShadowRay> shadow_rays(const ShadowStage& stage, const ShadowCast& cast,
                                   const glm::dvec3& center, float offset, int x, int y) {
    std::vector<ShadowRay> rays;
    const float z = stage.view_z[stage.at(x, y)];
    if (!(z > 0)) return rays;
    const Projection& k = stage.view.projection;
    const glm::vec2 inverse(1 / k.fx, 1 / k.fy);
    const glm::vec3 at((static_cast<float>(x) - static_cast<float>(k.cx)) * inverse.x * z,
                       (static_cast<float>(y) - static_cast<float>(k.cy)) * inverse.y * z, z);
    const glm::vec3 n = from_octahedral(stage.normals[stage.at(x, y)]);
    const bool has_lists = cast.lists.tile_px != 0;
    const std::uint32_t globals = cast.lists.global_count;
    const auto tile = static_cast<std::uint32_t>(y) / kStageTilePx * cast.lists.tiles_x +
                      static_cast<std::uint32_t>(x) / kStageTilePx;
    const glm::uvec2 header =
        has_lists ? cast.headers[tile] : glm::uvec2(0, cast.lists.local_count);
    for (std::uint32_t slot = 0; slot < std::min(globals + header.y, 128u); ++slot) {
        const std::uint32_t entry = slot - globals;
        const std::uint32_t light = slot < globals ? slot
                                    : has_lists    ? cast.indices[header.x + entry]
                                                   : slot;
        const shared::LightRecord& record = cast.lights[light];
        const glm::vec3 way = record.kind == 0 ? record.place : record.place - at;
        const float squared = way.x * way.x + way.y * way.y + way.z * way.z;
        if (record.casts_shadow == 0) continue;
        if (!(way.x * n.x + way.y * n.y + way.z * n.z > 0)) continue;
        if (record.kind != 0 && !(squared < record.radius * record.radius)) continue;
        if (record.kind == 2 &&
            !(-(way.x * record.axis.x + way.y * record.axis.y + way.z * record.axis.z) >
              record.cone_cos * std::sqrt(squared))) {
            continue;
        }
        const Pose& pose = stage.view.world_from_view;
        const glm::dvec3 place = pose * glm::dvec3(at) - center;
        const glm::dvec3 normal = pose.rotation * glm::dvec3(n);
        const double step = double{offset} * std::max({std::abs(place.x), std::abs(place.y),
                                                       std::abs(place.z), double{at.z}});
        const glm::dvec3 to_light = pose.rotation * glm::dvec3(way);
        Ray ray{.origin = place + normal * step};
        ray.direction = record.kind == 0 ? to_light : to_light - normal * step;
        if (record.kind != 0) {
            ray.t_max = static_cast<float>(1 - step / glm::length(glm::dvec3(ray.direction)));
        }
        rays.push_back({slot, ray});
    }
    return rays;
}

}  // namespace kino::test
