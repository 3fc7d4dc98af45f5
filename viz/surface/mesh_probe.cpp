#include "viz/surface/mesh_probe.h"

namespace kino {
namespace {

constexpr std::uint32_t kProbeCode[] = {
#include "mesh_fetch_probe_comp.inc"
};

struct ProbeParams {
    std::uint32_t row = 0;
    std::uint32_t corners = 0;
};

}  // namespace

MeshProbe add_fetch_probe(graph::FrameGraph& graph, const MeshList& list, std::uint32_t row,
                          std::uint32_t corners, MeshProbe into) {
    MeshProbe made;
    graph.add_pass(
        "meshes/fetch probe", "meshes",
        [&](graph::PassBuilder& b) {
            b.read(list.rows, graph::Use::compute_read);
            b.read(list.vertices, graph::Use::compute_read);
            if (list.skinned.index != list.vertices.index) {
                b.read(list.skinned, graph::Use::compute_read);
            }
            made.out = b.write(into.out, graph::Use::compute_write);
            made.errors = b.write(into.errors, graph::Use::compute_write);
        },
        [=](graph::PassContext& c) {
            gpu::PipelineDesc desc;
            desc.name = "meshes/fetch probe";
            desc.compute = kProbeCode;
            desc.bindings = {gpu::Binding::word_quads, gpu::Binding::word_quads,
                             gpu::Binding::word_quads, gpu::Binding::words,
                             gpu::Binding::storage,    gpu::Binding::storage};
            desc.push_bytes = sizeof(ProbeParams);
            desc.constants = {list.formats, KINO_CARRIER_FIRST_INSTANCE};
            if (!c.bind(desc, {c.bound(list.rows), c.bound(list.vertices), c.bound(list.skinned),
                               c.bound(list.rows), c.bound(into.out), c.bound(into.errors)})) {
                return;
            }
            c.commands().constants(ProbeParams{row, corners});
            c.commands().dispatch((corners + 63) / 64);
        });
    return made;
}

}  // namespace kino
