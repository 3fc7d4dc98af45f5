#include "viz/quality/guided_depth.h"

#include <array>
#include <cmath>

#include "base/check.h"
#include "viz/graph/executor.h"
#include "viz/quality/guided_depth_shared.h"

namespace kino {
namespace {

constexpr std::uint32_t kGuidedDepth[] = {
#include "guided_depth_frag.inc"
};
constexpr std::uint32_t kGuidedFullscreen[] = {
#include "lod_fullscreen_vert.inc"
};

}  // namespace

graph::TextureId add_guided_depth(graph::FrameGraph& graph, graph::TextureId depth,
                                  graph::TextureId color, const GuidedDepthOptions& options) {
    const graph::TextureDesc coarse = graph.resources()[depth.index].texture;
    const graph::TextureDesc fine = graph.resources()[color.index].texture;
    KINO_CHECK(coarse.width <= fine.width && coarse.height <= fine.height);
    KINO_CHECK(options.sigma_luma > 0 && options.same_surface >= 0);
    const glm::vec2 scale(static_cast<float>(coarse.width) / static_cast<float>(fine.width),
                          static_cast<float>(coarse.height) / static_cast<float>(fine.height));
    const glm::vec2 offset = (0.5f - options.offset_px) * scale - 0.5f;
    const float ln2 = 0.69314718f;
    const shared::GuidedDepthParams params{
        .coarse_of_fine = {scale.x, scale.y, offset.x, offset.y},
        .last = {static_cast<int>(coarse.width) - 1, static_cast<int>(coarse.height) - 1},
        .fine_last = {static_cast<int>(fine.width) - 1, static_cast<int>(fine.height) - 1},
        .luma_weight = std::isinf(options.sigma_luma)
                           ? 0.0f
                           : 1 / (2 * options.sigma_luma * options.sigma_luma * ln2),
        .same_surface = options.same_surface};
    graph::TextureId out =
        graph.create_texture("guided depth", {fine.width, fine.height, VK_FORMAT_R32_SFLOAT});
    const auto execute = [=](graph::PassContext& c) {
        gpu::PipelineDesc desc;
        desc.name = "lod/guided depth";
        desc.vertex = kGuidedFullscreen;
        desc.fragment = kGuidedDepth;
        desc.bindings = {gpu::Binding::texture, gpu::Binding::texture};
        desc.push_bytes = sizeof(params);
        desc.color_formats = {VK_FORMAT_R32_SFLOAT};
        const std::array<gpu::Target, 1> targets = {{{.view = c.view(out)}}};
        c.commands().begin_rendering({fine.width, fine.height}, targets, nullptr);
        if (c.bind(desc, {c.bound(depth), c.bound(color)})) {
            c.commands().constants(params);
            c.commands().draw(3);
        }
        c.commands().end_rendering();
    };
    graph.add_pass(
        "lod/guided depth", "lod",
        [&](graph::PassBuilder& b) {
            b.read(depth, graph::Use::fragment_read);
            b.read(color, graph::Use::fragment_read);
            out = b.write(out, graph::Use::color_attachment);
        },
        execute);
    return out;
}

}  // namespace kino
