#include "viz/light/shade_list.h"

#include "base/check.h"
#include "viz/light/shade_setup.h"

namespace kino {
namespace {

using gpu::Binding;
using graph::PassBuilder;
using graph::PassContext;
using graph::Use;

constexpr std::uint32_t kShadeListLive[] = {
#include "shade_list_live_comp.inc"
};
constexpr std::uint32_t kShadeListMaterials[] = {
#include "shade_list_materials_comp.inc"
};

}  // namespace

graph::TextureId add_shade_list(graph::FrameGraph& graph, const Scene& scene, const View& view,
                                const ShadeInputs& inputs, const PixelList& list,
                                graph::TextureId linear) {
    KINO_CHECK(!inputs.onto.valid());
    ShadeSetup setup = make_shade_setup(graph, scene, view, inputs);
    setup.params.row_px = 0;  // masks are by place in the list
    const auto execute = [=, target = linear](PassContext& c) {
        const bool has_materials = setup.has_materials();
        gpu::PipelineDesc desc;
        desc.name = has_materials ? "light/shade listed materials" : "light/shade listed live";
        desc.compute = has_materials ? std::span<const std::uint32_t>(kShadeListMaterials)
                                     : std::span<const std::uint32_t>(kShadeListLive);
        desc.bindings = ShadeSetup::bindings();
        desc.bindings.insert(desc.bindings.end(), {Binding::words, Binding::words, Binding::image});
        desc.push_bytes = sizeof(setup.params);
        desc.constants = setup.constants;
        std::vector<gpu::Bound> bound = setup.bound(c);
        bound.insert(bound.end(), {c.bound(list.pixels), c.bound(list.dispatch), c.bound(target)});
        setup.append_materials(c, desc.bindings, bound);
        if (!c.bind(desc, bound)) return;
        c.commands().constants(setup.params);
        c.commands().dispatch_indirect(c.buffer(list.dispatch), 0);
    };
    graph.add_pass(
        "light/shade listed", "light",
        [&](PassBuilder& b) {
            setup.read(b, Use::compute_read);
            b.read(list.pixels, Use::compute_read);
            b.read(list.dispatch, Use::compute_read);
            b.read(list.dispatch, Use::indirect_read);
            linear = b.write(linear, Use::compute_write);
        },
        execute);
    return linear;
}

}  // namespace kino
