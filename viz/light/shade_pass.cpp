#include <array>
#include <vector>

#include "viz/light/light_passes.h"
#include "viz/light/shade_setup.h"

namespace kino {
namespace {

using graph::PassBuilder;
using graph::PassContext;
using graph::Use;

constexpr std::uint32_t kListsFullscreen[] = {
#include "light_fullscreen_vert.inc"
};
constexpr std::uint32_t kShadeLive[] = {
#include "shade_live_frag.inc"
};
constexpr std::uint32_t kShadeMaterials[] = {
#include "shade_materials_frag.inc"
};

}  // namespace

graph::TextureId add_shade_pass(graph::FrameGraph& graph, const Scene& scene, const View& view,
                                const ShadeInputs& inputs) {
    const ShadeSetup setup = make_shade_setup(graph, scene, view, inputs);
    const auto width = static_cast<std::uint32_t>(view.width);
    const auto height = static_cast<std::uint32_t>(view.height);
    const bool adds = inputs.onto.valid();
    graph::TextureId linear =
        adds ? inputs.onto
             : graph.create_texture("scene, linear", {width, height, kSceneLinearFormat});
    const auto execute = [=](PassContext& c) {
        const bool has_materials = setup.has_materials();
        gpu::PipelineDesc desc;
        desc.name = has_materials ? "light/shade materials" : "light/shade live";
        desc.vertex = kListsFullscreen;
        desc.fragment = has_materials ? std::span<const std::uint32_t>(kShadeMaterials)
                                      : std::span<const std::uint32_t>(kShadeLive);
        desc.bindings = ShadeSetup::bindings();
        desc.push_bytes = sizeof(setup.params);
        desc.constants = setup.constants;
        desc.color_formats = {kSceneLinearFormat};
        if (adds) desc.blend = gpu::Blend::additive;
        std::vector<gpu::Bound> bound = setup.bound(c);
        setup.append_materials(c, desc.bindings, bound);
        const std::array<gpu::Target, 1> targets = {{{.view = c.view(linear)}}};
        c.commands().begin_rendering({width, height}, targets, nullptr);
        if (c.bind(desc, bound)) {
            c.commands().constants(setup.params);
            c.commands().draw(3);
        }
        c.commands().end_rendering();
    };
    graph.add_pass(
        "light/shade lists", "light",
        [&](PassBuilder& b) {
            setup.read(b, Use::fragment_read);
            linear = b.write(linear, Use::color_attachment);
        },
        execute);
    return linear;
}

}  // namespace kino
