#include "viz/light/blended_pass.h"

#include <algorithm>
#include <array>

#include "viz/graph/executor.h"
#include "viz/light/light_passes.h"
#include "viz/light/mesh_light.h"

namespace kino {
namespace {

constexpr std::uint32_t kBlended[] = {
#include "blended_frag.inc"
};

}  // namespace

bool wants_blended(const Scene& scene) {
    return std::any_of(scene.meshes.begin(), scene.meshes.end(),
                       [&](const MeshNode& node) { return is_blended(scene, node); });
}

graph::TextureId add_blended_pass(graph::FrameGraph& graph, const Scene& scene, const View& view,
                                  const MeshDrawer& meshes, const LightLists& lists,
                                  graph::TextureId linear, graph::TextureId depth) {
    const MeshList list = meshes.prepare(graph, scene, view, {.filter = MeshFilter::blended});
    if (list.count == 0) return linear;
    const MeshLight light = make_mesh_light(graph, scene, view, lists);
    const auto execute = [=](graph::PassContext& c) {
        MeshShader shader = mesh_light_shader(light, "light/blended", kBlended);
        shader.color_formats = {kSceneLinearFormat};
        shader.depth_test = gpu::DepthTest::not_farther;
        shader.blend = gpu::Blend::alpha;
        shader.samples = c.desc(linear).samples;
        const std::array<gpu::Target, 1> targets = {{{.view = c.view(linear)}}};
        const gpu::Target depth_target{.view = c.view(depth)};
        c.commands().begin_rendering({c.desc(linear).width, c.desc(linear).height}, targets,
                                     &depth_target);
        (void)record_mesh_light(c, list, light, shader);
        c.commands().end_rendering();
    };
    graph.add_pass(
        "light/blended", "light",
        [&](graph::PassBuilder& b) {
            MeshDrawer::declare(b, list);
            declare_mesh_light(b, light);
            depth = b.write(depth, graph::Use::depth_attachment);
            linear = b.write(linear, graph::Use::color_attachment);
        },
        execute);
    return linear;
}

}  // namespace kino
