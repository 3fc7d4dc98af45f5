#include "viz/light/indirect.h"

#include <algorithm>
#include <cmath>

#include "base/check.h"
#include "viz/graph/executor.h"
#include "viz/light/light_records.h"
#include "viz/light/light_shared.h"

namespace kino {
namespace {

constexpr std::uint32_t kSpawn[] = {
#include "spawn_bounces_comp.inc"
};
constexpr std::uint32_t kTexels = 8;  ///< along a side of a block, as in the shader

shared::SpawnParams params_of(const Light& light, const View& camera, const ReflectiveMap& map,
                              const BounceOptions& options) {
    const Pose camera_from_light = inverse(camera.world_from_view) * map.view.world_from_view;
    const glm::dmat3 r = glm::mat3_cast(camera_from_light.rotation);
    const glm::dvec3& t = camera_from_light.translation;
    const Projection& k = map.view.projection;
    const double outer = std::cos(double{light.outer_rad});
    const double inner = std::cos(double{std::min(light.inner_rad, light.outer_rad)});
    shared::SpawnParams params{};
    params.camera_from_light_x = {r[0][0], r[1][0], r[2][0], t.x};
    params.camera_from_light_y = {r[0][1], r[1][1], r[2][1], t.y};
    params.camera_from_light_z = {r[0][2], r[1][2], r[2][2], t.z};
    params.k = {k.fx, k.fy, k.cx, k.cy};
    params.color = light.color;
    params.radius = light.radius_m;
    params.cone_cos = static_cast<float>(outer);
    params.cone_scale = static_cast<float>(1 / std::max(inner - outer, 1e-6));
    params.grid = options.grid;
    params.artist = options.mode == BounceMode::artist ? 1 : 0;
    params.gain = options.gain;
    params.cutoff = options.cutoff / static_cast<float>(options.grid * options.grid);
    return params;
}

}  // namespace

std::vector<std::size_t> bouncing_lights(const Scene& scene) {
    std::vector<std::size_t> found;
    for (std::size_t i = 0; i < scene.lights.size(); ++i) {
        const Light& light = scene.lights[i];
        if (light.indirect && light.kind == LightKind::spot && is_usable(light)) found.push_back(i);
    }
    return found;
}

View reflective_view(const Light& light, const BounceOptions& options) {
    const int size = static_cast<int>(options.grid * kTexels);
    // A picture cannot see half the space; what is outside of it returns nothing.
    const double angle = std::clamp(2.0 * light.outer_rad, 0.02, 2.6);
    const glm::dvec3 ahead = glm::normalize(light.direction);
    return {.width = size,
            .height = size,
            .projection = perspective(angle, size, size, 0.02),
            .world_from_view = look_at(light.position, light.position + ahead)};
}

SpawnedLights spawn_bounces(const Scene& scene, const View& view, std::vector<ReflectiveMap> maps,
                            const BounceOptions& options) {
    KINO_CHECK(options.grid >= 1 && options.grid <= 32);
    const std::uint32_t lights_each = options.grid * options.grid;
    SpawnedLights spawned;
    spawned.count = static_cast<std::uint32_t>(maps.size()) * lights_each;
    spawned.add = [&scene, view, maps = std::move(maps), options, lights_each](
                      graph::FrameGraph& graph, SpawnTargets& targets) {
        for (std::size_t i = 0; i < maps.size(); ++i) {
            const SurfaceTargets& surface = maps[i].surface;
            shared::SpawnParams params =
                params_of(scene.lights[maps[i].light], view, maps[i], options);
            params.first_record =
                targets.first_record + static_cast<std::uint32_t>(i) * lights_each;
            params.first_volume =
                targets.first_volume + static_cast<std::uint32_t>(i) * lights_each;
            const auto execute = [=, records = targets.records,
                                  volumes = targets.volumes](graph::PassContext& c) {
                gpu::PipelineDesc desc;
                desc.name = "light/spawn bounces";
                desc.compute = kSpawn;
                using gpu::Binding;
                desc.bindings = {Binding::texture, Binding::texture, Binding::texture,
                                 Binding::storage, Binding::storage};
                desc.push_bytes = sizeof(params);
                if (!c.bind(desc, {c.bound(surface.albedo), c.bound(surface.view_z),
                                   c.bound(surface.normal), c.bound(records), c.bound(volumes)})) {
                    return;
                }
                c.commands().constants(params);
                c.commands().dispatch((lights_each + 63) / 64);
            };
            graph.add_pass(
                "light/spawn bounces", "cull",
                [&](graph::PassBuilder& b) {
                    for (const graph::TextureId id :
                         {surface.albedo, surface.view_z, surface.normal}) {
                        b.read(id, graph::Use::compute_read);
                    }
                    targets.records = b.write(targets.records, graph::Use::compute_write);
                    targets.volumes = b.write(targets.volumes, graph::Use::compute_write);
                },
                execute);
        }
    };
    return spawned;
}

}  // namespace kino
