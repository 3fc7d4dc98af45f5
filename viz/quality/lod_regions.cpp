#include "viz/quality/lod_regions.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/check.h"
#include "viz/graph/executor.h"
#include "viz/quality/lod_passes.h"
#include "viz/quality/lod_regions_shared.h"
#include "viz/quality/lod_shared.h"

namespace kino {
namespace {

using graph::BufferId;
using graph::PassBuilder;
using graph::PassContext;
using graph::Use;

constexpr std::uint32_t kLodRegions[] = {
#include "lod_regions_comp.inc"
};

constexpr double kRegionPx = 64;
/// A texel is doubtful where the likest coarse one weighs less than FramebufferLodOptions'
/// fix_confidence. Exponents of Eq. 1 are to base 2.
constexpr double kRegionLn2 = 0.69314718;
constexpr float kHugeLimit = 3e38f;

float region_weight(float sigma) {
    return std::isinf(sigma) ? 0.0f : static_cast<float>(1 / (2.0 * sigma * sigma * kRegionLn2));
}

struct RegionStep {
    const char* pass;
    enum : std::uint8_t { rows, tiles, one } lanes;
};
constexpr std::array<RegionStep, 4> kRegionSteps = {{{"lod/region rows", RegionStep::rows},
                                                     {"lod/region choice", RegionStep::tiles},
                                                     {"lod/region places", RegionStep::one},
                                                     {"lod/region list", RegionStep::rows}}};

}  // namespace

bool allows_regions(const FramebufferLodOptions& lod) {
    return lod.reconstruction == Reconstruction::geometry_aware && lod.format == LodFormat::packed;
}

std::uint32_t region_side(double r0, const RegionLodOptions& options, int level) {
    KINO_CHECK(options.levels >= 1 && options.levels <= 3 && level <= options.levels);
    const double unit = std::exp2(options.levels);
    const double side = unit * std::max(1.0, std::round(kRegionPx / r0 / unit));
    return static_cast<std::uint32_t>(side) >> level;
}

LodRegionList add_region_list(graph::FrameGraph& graph, graph::TextureId coarse_linear,
                              const CoarseSurface& coarse, const CoarseSurface& fine,
                              std::uint32_t side, float exposure, const LodRegionList* parents,
                              const RegionLodOptions& options, const FramebufferLodOptions& lod) {
    KINO_CHECK(side > 0 && options.limit >= 0 && options.doubt_share >= 0);
    const glm::uvec2 size(fine.view.width, fine.view.height);
    KINO_CHECK(size.x < (1u << 16) && size.y < (1u << 16));
    KINO_CHECK(coarse.guide.valid());
    const bool doubted = std::isfinite(options.doubt_share);
    LodRegionList list;
    list.side = side;
    list.tiles = (size + side - 1u) / side;
    list.most = size.x * size.y;
    const VkExtent2D room = graph.room({size.x, size.y});
    const glm::uvec2 room_tiles = (glm::uvec2(room.width, room.height) + side - 1u) / side;
    const std::uint64_t most_tiles = std::uint64_t{room_tiles.x} * room_tiles.y;
    list.pixels =
        graph.create_buffer("region texels", {std::uint64_t{room.width} * room.height * 4});
    list.dispatch = graph.create_buffer("region state", {sizeof(shared::LodRegionState)});
    list.texels = graph.create_buffer("region tiles", {most_tiles * 4});
    BufferId places = graph.create_buffer("region places", {most_tiles * 4});
    BufferId rows = graph.create_buffer("region rows", {most_tiles * side * 8});
    const shared::LodRegionParams params{
        .fine_k = lod_ray_scale(fine.view),
        .coarse_of_fine = lod_coarse_of_fine(fine.view, coarse.view),
        .last = {coarse.view.width - 1, coarse.view.height - 1},
        .fine = size,
        .tiles = list.tiles,
        .parents = parents != nullptr ? parents->tiles : glm::uvec2(0),
        .side = side,
        .parent_side = parents != nullptr ? parents->side : 1,
        .limit = std::min(options.limit, kHugeLimit),
        .doubt_limit = -std::log2(lod.fix_confidence),
        .doubt_share = options.doubt_share,
        .exposure = exposure,
        .z_weight = region_weight(lod.sigma_z),
        .n_weight = region_weight(lod.sigma_n),
        // Two sigmas: neighbours that Eq. 1 lets share their light.
        .depth_steps = std::min(
            1e9f, 2 * lod.sigma_z * shared::kGuideStepsPerOctave / static_cast<float>(kRegionLn2)),
        .normal_steps = std::min(1e9f, 2 * lod.sigma_n * shared::kGuideNormalSteps)};
    const BufferId before = parents != nullptr ? parents->texels : BufferId{};
    const std::uint32_t tile_count = list.tiles.x * list.tiles.y;
    for (std::uint32_t step = 0; step < kRegionSteps.size(); ++step) {
        const std::uint32_t lanes = kRegionSteps[step].lanes == RegionStep::rows ? tile_count * side
                                    : kRegionSteps[step].lanes == RegionStep::tiles ? tile_count
                                                                                    : 1;
        const std::vector<std::uint32_t> constants = {step,
                                                      std::isinf(lod.sigma_z) ? 0u : 1u,
                                                      static_cast<std::uint32_t>(lod.metric),
                                                      doubted ? 1u : 0u,
                                                      static_cast<std::uint32_t>(options.measure),
                                                      lod.fine_grained ? 1u : 0u};
        graph.add_pass(
            kRegionSteps[step].pass, "lod",
            [&](PassBuilder& b) {
                for (const graph::TextureId id :
                     {coarse_linear, coarse.surface.albedo, coarse.guide, fine.surface.view_z,
                      fine.surface.normal}) {
                    if (id.valid()) b.read(id, Use::compute_read);
                }
                if (before.valid()) b.read(before, Use::compute_read);
                for (BufferId* id : {&rows, &list.texels, &places, &list.dispatch, &list.pixels}) {
                    *id = b.write(*id, Use::compute_write);
                }
            },
            [=](PassContext& c) {
                gpu::PipelineDesc desc;
                desc.name = kRegionSteps[step].pass;
                desc.compute = kLodRegions;
                using gpu::Binding;
                desc.bindings = {Binding::texture, Binding::texture, Binding::texture,
                                 Binding::texture, Binding::texture, Binding::words,
                                 Binding::storage, Binding::storage, Binding::storage,
                                 Binding::storage, Binding::storage};
                desc.push_bytes = sizeof(params);
                desc.constants = constants;
                if (!c.bind(desc, {c.bound(coarse_linear), c.bound(coarse.surface.albedo),
                                   c.bound(coarse.guide), c.bound(fine.surface.view_z),
                                   c.bound(fine.surface.normal),
                                   // No parents: nobody asks.
                                   c.bound(before.valid() ? before : list.texels), c.bound(rows),
                                   c.bound(list.texels), c.bound(places), c.bound(list.dispatch),
                                   c.bound(list.pixels)})) {
                    return;
                }
                c.commands().constants(params);
                c.commands().dispatch((lanes + 63) / 64);
            });
    }
    return list;
}

}  // namespace kino
