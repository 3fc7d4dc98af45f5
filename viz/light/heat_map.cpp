#include <array>

#include "base/check.h"
#include "viz/graph/executor.h"
#include "viz/light/light_lists.h"
#include "viz/light/light_passes.h"

namespace kino {
namespace {
constexpr std::uint32_t kHeatFullscreen[] = {
#include "light_fullscreen_vert.inc"
};
constexpr std::uint32_t kHeatMap[] = {
#include "heat_map_frag.inc"
};
}  // namespace

graph::TextureId add_light_heat_map(graph::FrameGraph& graph, const LightLists& lists, float full) {
    KINO_CHECK(lists.tile_px != 0);
    graph::TextureId map =
        graph.create_texture("light heat map", {lists.width, lists.height, kSceneLinearFormat});
    struct Push {
        std::uint32_t tiles_x, tiles_y;
        float tile_px, full;
    };
    const Push push{lists.tiles_x, lists.tiles_y, static_cast<float>(lists.tile_px), full};
    graph.add_pass(
        "light/heat map", "debug",
        [&](graph::PassBuilder& b) {
            b.read(lists.headers, graph::Use::fragment_read);
            map = b.write(map, graph::Use::color_attachment);
        },
        [=](graph::PassContext& c) {
            gpu::PipelineDesc desc;
            desc.name = "light/heat map";
            desc.vertex = kHeatFullscreen;
            desc.fragment = kHeatMap;
            desc.bindings = {gpu::Binding::word_pairs};
            desc.push_bytes = sizeof(push);
            desc.color_formats = {kSceneLinearFormat};
            const std::array<gpu::Target, 1> targets = {{{.view = c.view(map)}}};
            c.commands().begin_rendering({lists.width, lists.height}, targets, nullptr);
            if (c.bind(desc, {c.bound(lists.headers)})) {
                c.commands().constants(push);
                c.commands().draw(3);
            }
            c.commands().end_rendering();
        });
    return map;
}

}  // namespace kino
