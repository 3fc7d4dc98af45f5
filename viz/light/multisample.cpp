#include "viz/light/multisample.h"

#include <algorithm>
#include <array>

#include "viz/graph/executor.h"
#include "viz/light/light_passes.h"
#include "viz/light/light_shared.h"

namespace kino {
namespace {

using graph::FrameGraph;
using graph::PassBuilder;
using graph::PassContext;
using graph::TextureId;
using graph::Use;

constexpr std::uint32_t kSampleFullscreen[] = {
#include "light_fullscreen_vert.inc"
};
constexpr std::uint32_t kSampleDepths[] = {
#include "sample_depths_frag.inc"
};
constexpr std::uint32_t kSpread[] = {
#include "spread_samples_frag.inc"
};
constexpr std::uint32_t kResolve[] = {
#include "resolve_samples_frag.inc"
};

/// A pass that reads one picture and writes every pixel of another.
template <class Push>
TextureId add_picture(FrameGraph& graph, const char* name, std::span<const std::uint32_t> fragment,
                      TextureId from, TextureId to, const Push& push,
                      const std::vector<std::uint32_t>& constants) {
    const auto execute = [=](PassContext& c) {
        gpu::PipelineDesc desc;
        desc.name = name;
        desc.vertex = kSampleFullscreen;
        desc.fragment = fragment;
        desc.bindings = {gpu::Binding::texture};
        desc.push_bytes = sizeof(Push);
        desc.constants = constants;
        desc.color_formats = {c.desc(to).format};
        desc.samples = c.desc(to).samples;
        const std::array<gpu::Target, 1> targets = {{{.view = c.view(to)}}};
        c.commands().begin_rendering({c.desc(to).width, c.desc(to).height}, targets, nullptr);
        if (c.bind(desc, {c.bound(from)})) {
            c.commands().constants(push);
            c.commands().draw(3);
        }
        c.commands().end_rendering();
    };
    graph.add_pass(
        name, "light",
        [&](PassBuilder& b) {
            b.read(from, Use::fragment_read);
            to = b.write(to, Use::color_attachment);
        },
        execute);
    return to;
}

}  // namespace

TextureId add_mesh_depths(FrameGraph& graph, const MeshList& list, TextureId depth) {
    if (list.count == 0) return depth;
    const auto execute = [list, depth](PassContext& c) {
        MeshShader shader;
        shader.name = "light/mesh depths";
        shader.samples = c.desc(depth).samples;
        const gpu::Target target{.view = c.view(depth)};
        c.commands().begin_rendering({c.desc(depth).width, c.desc(depth).height}, {}, &target);
        (void)MeshDrawer::record(c, list, shader);
        c.commands().end_rendering();
    };
    graph.add_pass(
        "light/mesh depths", "meshes",
        [&](PassBuilder& b) {
            MeshDrawer::declare(b, list);
            depth = b.write(depth, Use::depth_attachment);
        },
        execute);
    return depth;
}

View sample_view(const View& view) {
    View fine = view;
    fine.width = 2 * view.width;
    fine.height = 2 * view.height;
    Projection& k = fine.projection;
    k.fx *= 2;
    k.fy *= 2;
    // Pixel centres are at whole numbers.
    k.cx = 2 * k.cx + 0.5f;
    k.cy = 2 * k.cy + 0.5f;
    return fine;
}

TextureId add_sample_depths(FrameGraph& graph, const View& view, TextureId depth) {
    const graph::TextureDesc size = graph.resources()[depth.index].texture;
    const TextureId fine =
        graph.create_texture("sample depths", {2 * size.width, 2 * size.height, kViewZFormat});
    return add_picture(graph, "light/sample depths", kSampleDepths, depth, fine,
                       static_cast<float>(view.projection.near_m), {});
}

LightListOptions sample_lists(LightListOptions options) {
    options.tile_px = std::min(2 * options.tile_px, 32u);
    return options;
}

TextureId add_spread(FrameGraph& graph, TextureId picture) {
    graph::TextureDesc desc = graph.resources()[picture.index].texture;
    desc.samples = kMostSamples;
    return add_picture(graph, "light/spread samples", kSpread, picture,
                       graph.create_texture("scene, samples", desc), 0u, {});
}

TextureId add_resolve(FrameGraph& graph, const Scene& scene, TextureId samples,
                      SampleResolve resolve) {
    graph::TextureDesc desc = graph.resources()[samples.index].texture;
    const std::uint32_t count = desc.samples;
    desc.samples = 1;
    const shared::FinalParams params{.exposure = scene.exposure,
                                     .tone_map = scene.color_mode == ColorMode::captured ? 0u : 1u};
    return add_picture(graph, "light/resolve samples", kResolve, samples,
                       graph.create_texture("scene, linear", desc), params,
                       {count, resolve == SampleResolve::as_shown ? 1u : 0u});
}

}  // namespace kino
