#include "viz/light/forward_pass.h"

#include <array>
#include <utility>
#include <vector>

#include "base/check.h"
#include "viz/light/light_passes.h"

namespace kino {
namespace {

constexpr std::uint32_t kForward[] = {
#include "forward_frag.inc"
};
constexpr std::uint32_t kToon[] = {
#include "toon_frag.inc"
};
constexpr std::uint32_t kToonSamples[] = {
#include "toon_samples_frag.inc"
};
constexpr std::uint32_t kUnlit[] = {
#include "unlit_frag.inc"
};

MeshShader shader_of(MaterialKind kind, MeshLight& light) {
    switch (kind) {
        case MaterialKind::toon:
            return mesh_light_shader(
                light, "light/forward toon",
                light.sample_z.valid() ? std::span<const std::uint32_t>(kToonSamples) : kToon);
        case MaterialKind::unlit:
            light.shadow_masks = {};
            light.sample_z = {};
            return mesh_light_shader(light, "light/forward unlit", kUnlit);
        case MaterialKind::layered:
            break;
    }
    KINO_CHECK(light.sample_z.valid());  // with one sample the surface's own pass does it
    return mesh_light_shader(light, "light/forward", kForward);
}

}  // namespace

std::uint32_t opaque_kinds(const Scene& scene) {
    std::uint32_t kinds = 0;
    for (const MeshNode& node : scene.meshes) {
        if (!is_blended(scene, node)) {
            kinds |= 1u << static_cast<std::uint32_t>(kind_of(scene, node));
        }
    }
    return kinds;
}

ForwardTargets add_forward_pass(graph::FrameGraph& graph, const Scene& scene, const View& view,
                                const MeshDrawer& meshes, const MeshLight& light,
                                std::uint32_t kinds, ForwardTargets targets) {
    kinds &= opaque_kinds(scene);
    std::vector<std::pair<MaterialKind, MeshList>> lists;
    for (const MaterialKind kind :
         {MaterialKind::layered, MaterialKind::toon, MaterialKind::unlit}) {
        const std::uint32_t bit = 1u << static_cast<std::uint32_t>(kind);
        if ((kinds & bit) == 0) continue;
        MeshList list = meshes.prepare(graph, scene, view, {.kinds = bit});
        if (list.count > 0) lists.emplace_back(kind, std::move(list));
    }
    if (lists.empty()) return targets;
    const auto execute = [=, linear = targets.linear,
                          depth = targets.depth](graph::PassContext& c) {
        const std::array<gpu::Target, 1> colors = {{{.view = c.view(linear)}}};
        const gpu::Target depth_target{.view = c.view(depth)};
        c.commands().begin_rendering({c.desc(linear).width, c.desc(linear).height}, colors,
                                     &depth_target);
        for (const auto& [kind, list] : lists) {
            MeshLight own = light;
            MeshShader shader = shader_of(kind, own);
            shader.color_formats = {kSceneLinearFormat};
            shader.depth_test = gpu::DepthTest::equal;
            shader.samples = c.desc(linear).samples;
            if (!record_mesh_light(c, list, own, shader)) break;
        }
        c.commands().end_rendering();
    };
    graph.add_pass(
        "light/forward", "light",
        [&](graph::PassBuilder& b) {
            for (const auto& [kind, list] : lists) MeshDrawer::declare(b, list);
            declare_mesh_light(b, light);
            targets.depth = b.write(targets.depth, graph::Use::depth_attachment);
            targets.linear = b.write(targets.linear, graph::Use::color_attachment);
        },
        execute);
    return targets;
}

}  // namespace kino
