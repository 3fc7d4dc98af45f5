#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "base/check.h"
#include "viz/graph/executor.h"
#include "viz/quality/lod_fix_shared.h"
#include "viz/quality/lod_passes.h"

namespace kino {
namespace {

using graph::BufferId;
using graph::PassBuilder;
using graph::PassContext;
using graph::Use;

constexpr std::uint32_t kLodFix[] = {
#include "lod_fix_comp.inc"
};

/// The first step of doubt at which the confidence is below `confidence`.
std::uint32_t least_doubt(float confidence) {
    KINO_CHECK(confidence > 0 && confidence < 1);
    const double steps =
        shared::kDoubtSteps * std::sqrt(-std::log2(static_cast<double>(confidence)));
    return static_cast<std::uint32_t>(
        std::clamp(std::ceil(steps), 1.0, static_cast<double>(shared::kMostDoubt)));
}

struct FixStep {
    const char* name;
    bool one_lane;
};
constexpr std::array<FixStep, 5> kFixSteps = {
    {{" count", false}, {" cut", true}, {" recount", false}, {" places", true}, {" list", false}}};

}  // namespace

bool wants_fixes(const FramebufferLodOptions& options) {
    return options.fix_share > 0 && options.reconstruction == Reconstruction::geometry_aware;
}

LodFixList add_fix_list(graph::FrameGraph& graph, graph::TextureId doubt, const View& view,
                        const FramebufferLodOptions& options) {
    return add_pixel_list(graph, "lod/fix", doubt, view, options.fix_share,
                          least_doubt(options.fix_confidence));
}

LodFixList add_pixel_list(graph::FrameGraph& graph, const std::string& name, graph::TextureId doubt,
                          const View& view, float share, std::uint32_t least) {
    constexpr std::uint32_t kStrip = KINO_LOD_STRIP_PX;
    const auto width = static_cast<std::uint32_t>(view.width);
    const auto height = static_cast<std::uint32_t>(view.height);
    KINO_CHECK(width < (1u << 16) && height < (1u << 16));
    const double most = std::min(1.0f, share) * static_cast<double>(width) * height;
    LodFixList fix;
    fix.cap = std::max(1u, static_cast<std::uint32_t>(most));
    const std::uint32_t strips = (width + kStrip - 1) / kStrip;
    const shared::LodFixParams params{.fine = {width, height},
                                      .strips = strips,
                                      .cap = fix.cap,
                                      .least = least,
                                      .all_strips = strips * height};
    fix.pixels = graph.create_buffer("pixels to fix", {std::uint64_t{fix.cap} * 4});
    fix.state = graph.create_buffer("fix state", {sizeof(shared::LodFixState)});
    BufferId counts =
        graph.create_buffer("doubtful in strips", {std::uint64_t{params.all_strips} * 4});
    graph.add_pass(
        name + " clear", "lod",
        [&](PassBuilder& b) { fix.state = b.write(fix.state, Use::transfer_write); },
        [id = fix.state](PassContext& c) { c.commands().fill(c.buffer(id), 0); });
    for (std::uint32_t step = 0; step < kFixSteps.size(); ++step) {
        const bool one_lane = kFixSteps[step].one_lane;
        graph.add_pass(
            name + kFixSteps[step].name, "lod",
            [&](PassBuilder& b) {
                b.read(doubt, Use::compute_read);
                for (BufferId* id : {&fix.state, &counts, &fix.pixels}) {
                    *id = b.write(*id, Use::compute_write);
                }
            },
            [=](PassContext& c) {
                gpu::PipelineDesc desc;
                desc.name = std::string("lod/fix") + kFixSteps[step].name;
                desc.compute = kLodFix;
                desc.bindings = {gpu::Binding::texture, gpu::Binding::storage,
                                 gpu::Binding::storage, gpu::Binding::storage};
                desc.push_bytes = sizeof(params);
                desc.constants = {step};
                if (!c.bind(desc, {c.bound(doubt), c.bound(fix.state), c.bound(counts),
                                   c.bound(fix.pixels)})) {
                    return;
                }
                c.commands().constants(params);
                c.commands().dispatch(one_lane ? 1 : (params.all_strips + 63) / 64);
            });
    }
    return fix;
}

}  // namespace kino
