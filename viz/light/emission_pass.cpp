#include "viz/light/emission_pass.h"

#include <algorithm>
#include <array>

#include "viz/graph/executor.h"
#include "viz/light/light_passes.h"
#include "viz/light/material_upload.h"

namespace kino {
namespace {

constexpr std::uint32_t kEmissionFullscreen[] = {
#include "light_fullscreen_vert.inc"
};
constexpr std::uint32_t kEmission[] = {
#include "emission_frag.inc"
};

}  // namespace

bool wants_emission(const Scene& scene) {
    return std::any_of(scene.materials.begin(), scene.materials.end(),
                       [](const Material& m) { return m.emission != glm::vec3(0); });
}

graph::TextureId add_emission_pass(graph::FrameGraph& graph, const Scene& scene,
                                   graph::TextureId object, graph::TextureId linear) {
    const MaterialBuffers materials = add_material_upload(graph, scene);
    const auto execute = [=](graph::PassContext& c) {
        gpu::PipelineDesc desc;
        desc.name = "light/emission";
        desc.vertex = kEmissionFullscreen;
        desc.fragment = kEmission;
        desc.bindings = {gpu::Binding::texture, gpu::Binding::word_quads};
        desc.color_formats = {kSceneLinearFormat};
        desc.blend = gpu::Blend::additive;
        const std::array<gpu::Target, 1> targets = {{{.view = c.view(linear)}}};
        c.commands().begin_rendering({c.desc(linear).width, c.desc(linear).height}, targets,
                                     nullptr);
        if (c.bind(desc, {c.bound(object), c.bound(materials.materials)})) c.commands().draw(3);
        c.commands().end_rendering();
    };
    graph.add_pass(
        "light/emission", "light",
        [&](graph::PassBuilder& b) {
            b.read(object, graph::Use::fragment_read);
            b.read(materials.materials, graph::Use::fragment_read);
            linear = b.write(linear, graph::Use::color_attachment);
        },
        execute);
    return linear;
}

}  // namespace kino
