#include "viz/quality/lod_samples.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "base/check.h"
#include "viz/graph/executor.h"
#include "viz/quality/lod_passes.h"
#include "viz/quality/lod_samples_shared.h"

namespace kino {
namespace {

using graph::PassBuilder;
using graph::PassContext;
using graph::TextureId;
using graph::Use;

constexpr std::uint32_t kEdgesVertex[] = {
#include "lod_fullscreen_vert.inc"
};
constexpr std::uint32_t kSampleEdges[] = {
#include "lod_sample_edges_frag.inc"
};

constexpr VkFormat kRankFormat = VK_FORMAT_R8_UNORM;
constexpr float kNeverReached = 1e18f;  // its square is a number, too

/// Factor of a squared distance in the exponent to base 2; 0 for an infinite sigma.
float exponent_of(float sigma) {
    return std::isinf(sigma) ? 0.0f : 1.0f / (2 * sigma * sigma * std::numbers::ln2_v<float>);
}

}  // namespace

LodFixList add_edge_list(graph::FrameGraph& graph, const SampleTargets& samples,
                         const SurfaceTargets& surface, const View& view,
                         const FramebufferLodOptions& options, float share) {
    KINO_CHECK(samples.valid() && surface.object.valid());
    KINO_CHECK(options.sigma_z > 0 && options.sigma_n > 0);
    const shared::LodEdgeParams params{.fine_k = lod_ray_scale(view),
                                       .z_limit = std::min(2 * options.sigma_z, kNeverReached),
                                       .n_limit = std::min(2 * options.sigma_n, kNeverReached)};
    TextureId rank =
        graph.create_texture("edges", {static_cast<std::uint32_t>(view.width),
                                       static_cast<std::uint32_t>(view.height), kRankFormat});
    const std::array<TextureId, 5> read = {samples.texel, surface.albedo, surface.view_z,
                                           surface.normal, surface.object};
    graph.add_pass(
        "edges/find", "lod",
        [&](PassBuilder& b) {
            for (const TextureId id : read) b.read(id, Use::fragment_read);
            rank = b.write(rank, Use::color_attachment);
        },
        [read, params, to = rank](PassContext& c) {
            gpu::PipelineDesc desc;
            desc.name = "edges/find";
            desc.vertex = kEdgesVertex;
            desc.fragment = kSampleEdges;
            desc.bindings.assign(read.size(), gpu::Binding::texture);
            desc.push_bytes = sizeof(params);
            desc.color_formats = {kRankFormat};
            const std::array<gpu::Target, 1> targets = {{{.view = c.view(to)}}};
            std::vector<gpu::Bound> bound;
            for (const TextureId id : read) bound.push_back(c.bound(id));
            c.commands().begin_rendering({c.desc(to).width, c.desc(to).height}, targets, nullptr);
            if (c.bind(desc, bound)) {
                c.commands().constants(params);
                c.commands().draw(3);
            }
            c.commands().end_rendering();
        });
    return add_pixel_list(graph, "edges/list", rank, view, share, 1);
}

shared::LodParams fine_eq1_params(const View& view, const FramebufferLodOptions& options) {
    return {.fine_k = lod_ray_scale(view),
            .coarse_of_fine = {1, 1, 0, 0},
            .last = {view.width - 1, view.height - 1},
            .fine = {view.width, view.height},
            .z_weight = exponent_of(options.sigma_z),
            .n_weight = exponent_of(options.sigma_n)};
}

}  // namespace kino
