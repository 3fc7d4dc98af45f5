#include "viz/frame/supersampled_stage.h"

#include <array>

#include "viz/frame/edge_samples_shared.h"
#include "viz/graph/executor.h"
#include "viz/light/emission_pass.h"
#include "viz/light/material_upload.h"
#include "viz/quality/lod_samples.h"

namespace kino {
namespace {

using gpu::Binding;
using graph::BufferId;
using graph::FrameGraph;
using graph::PassBuilder;
using graph::PassContext;
using graph::TextureId;
using graph::Use;

constexpr std::uint32_t kEdgeSamples[] = {
#include "edge_samples_comp.inc"
};
constexpr std::uint32_t kEdgeWrite[] = {
#include "edge_write_comp.inc"
};

/// What add_coarse_surface() gives dark texels, linear: 32 of 255.
constexpr float kLeastAlbedo = 0.0144f;

}  // namespace

bool wants_edge_samples(const Scene& scene, const StageOptions& options) {
    return options.samples == kSurfaceSamples && options.lod.has_value() && !scene.meshes.empty();
}

DrawnSurface add_sampled_surface(FrameGraph& graph, const Scene& scene, const View& view,
                                 const StageParts& parts, const StageOptions& options,
                                 SampleTargets* samples) {
    const SurfaceTargets ground =
        add_ground(graph, scene, view, parts, options.raster, options.read_ids);
    const MeshList list = parts.meshes.prepare(graph, scene, view, {});
    const bool live = scene.live && scene.live->surface;
    *samples = add_sample_surface(graph, view, ground, list, !live);
    return add_meshes(graph, view, parts, list, ground);
}

TextureId add_edge_samples(FrameGraph& graph, const Scene& scene, const View& view,
                           const SampleTargets& samples, const SurfaceTargets& surface,
                           TextureId linear, const StageOptions& options) {
    if (!samples.valid()) return linear;
    const FramebufferLodOptions lod = options.lod.value_or(FramebufferLodOptions{});
    const LodFixList edges = add_edge_list(graph, samples, surface, view, lod, options.edge_share);
    const bool emission = wants_emission(scene);
    const MaterialBuffers materials =
        emission ? add_material_upload(graph, scene) : MaterialBuffers{};
    const shared::EdgeSampleParams params{
        .lod = fine_eq1_params(view, lod),
        .final = {.exposure = scene.exposure,
                  .tone_map = scene.color_mode == ColorMode::captured ? 0u : 1u},
        .least_albedo = kLeastAlbedo,
        .background = {pack_srgb(scene.background_top), pack_srgb(scene.background_bottom)}};
    const std::vector<std::uint32_t> constants = {
        lod.fine_grained ? 1u : 0u, params.lod.z_weight > 0 ? 1u : 0u,
        static_cast<std::uint32_t>(lod.metric),
        options.resolve == SampleResolve::as_shown ? 1u : 0u, emission ? 1u : 0u};
    BufferId mixed = graph.create_buffer("edge colours", {std::uint64_t{edges.cap} * 8});
    const std::array<TextureId, 6> textures = {samples.texel,  linear,         surface.albedo,
                                               surface.view_z, surface.normal, surface.object};
    graph.add_pass(
        "edges/samples", "lod",
        [&](PassBuilder& b) {
            for (const TextureId id : textures) b.read(id, Use::compute_read);
            for (const BufferId id : {edges.pixels, edges.state, materials.materials}) {
                if (id.valid()) b.read(id, Use::compute_read);
            }
            b.read(edges.state, Use::indirect_read);
            mixed = b.write(mixed, Use::compute_write);
        },
        [=, to = mixed](PassContext& c) {
            gpu::PipelineDesc desc;
            desc.name = "edges/samples";
            desc.compute = kEdgeSamples;
            desc.bindings = {Binding::words, Binding::words};
            std::vector<gpu::Bound> bound = {c.bound(edges.pixels), c.bound(edges.state)};
            for (const TextureId id : textures) {
                desc.bindings.push_back(Binding::texture);
                bound.push_back(c.bound(id));
            }
            desc.bindings.insert(desc.bindings.end(), {Binding::word_quads, Binding::storage});
            // What is compiled out still wants something bound.
            bound.push_back(c.bound(emission ? materials.materials : edges.state));
            bound.push_back(c.bound(to));
            desc.push_bytes = sizeof(params);
            desc.constants = constants;
            if (!c.bind(desc, bound)) return;
            c.commands().constants(params);
            c.commands().dispatch_indirect(c.buffer(edges.state), 0);
        });
    graph.allow_storage(linear);
    graph.add_pass(
        "edges/write", "lod",
        [&](PassBuilder& b) {
            for (const BufferId id : {edges.pixels, edges.state, mixed}) {
                b.read(id, Use::compute_read);
            }
            b.read(edges.state, Use::indirect_read);
            linear = b.write(linear, Use::compute_write);
        },
        [edges, mixed, to = linear](PassContext& c) {
            gpu::PipelineDesc desc;
            desc.name = "edges/write";
            desc.compute = kEdgeWrite;
            desc.bindings = {Binding::words, Binding::words, Binding::word_pairs, Binding::image};
            if (!c.bind(desc, {c.bound(edges.pixels), c.bound(edges.state), c.bound(mixed),
                               c.bound(to)})) {
                return;
            }
            c.commands().dispatch_indirect(c.buffer(edges.state), 0);
        });
    return linear;
}

}  // namespace kino
