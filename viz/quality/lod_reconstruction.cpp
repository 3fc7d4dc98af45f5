#include <array>
#include <cmath>
#include <vector>

#include "base/check.h"
#include "viz/graph/executor.h"
#include "viz/light/light_shared.h"
#include "viz/quality/framebuffer_lod.h"
#include "viz/quality/lod_passes.h"
#include "viz/quality/lod_shared.h"

namespace kino {
namespace {

using graph::BufferId;
using graph::FrameGraph;
using graph::PassBuilder;
using graph::PassContext;
using graph::TextureId;
using graph::Use;

constexpr std::uint32_t kLodFullscreen[] = {
#include "lod_fullscreen_vert.inc"
};
constexpr std::uint32_t kLodRunsVertex[] = {
#include "lod_runs_vert.inc"
};
constexpr std::uint32_t kLodPack[] = {
#include "lod_pack_frag.inc"
};
constexpr std::uint32_t kLodPackObject[] = {
#include "lod_pack_object_frag.inc"
};
constexpr std::uint32_t kLodBilinear[] = {
#include "lod_bilinear_frag.inc"
};
constexpr std::uint32_t kLodFlat[] = {
#include "lod_flat_frag.inc"
};
constexpr std::uint32_t kLodEdge[] = {
#include "lod_edge_frag.inc"
};
constexpr std::uint32_t kLodEdgeObject[] = {
#include "lod_edge_object_frag.inc"
};
constexpr std::uint32_t kLodWide[] = {
#include "lod_wide_frag.inc"
};
constexpr std::uint32_t kLodWideObject[] = {
#include "lod_wide_object_frag.inc"
};
constexpr std::uint32_t kLodFlatCheck[] = {
#include "lod_flat_check_frag.inc"
};
constexpr std::uint32_t kLodFlatCheckObject[] = {
#include "lod_flat_check_object_frag.inc"
};
constexpr std::uint32_t kLodClassify[] = {
#include "lod_classify_comp.inc"
};
constexpr std::uint32_t kLodClassifyObject[] = {
#include "lod_classify_object_comp.inc"
};
constexpr std::uint32_t kLodRuns[] = {
#include "lod_runs_comp.inc"
};

constexpr VkFormat kLodLinearFormat = VK_FORMAT_R16G16B16A16_SFLOAT;
constexpr VkFormat kDoubtFormat = VK_FORMAT_R8_UNORM;
constexpr float kLn2 = 0.69314718f;

/// Factor of a squared distance in the exponent to base 2; 0 for an infinite sigma.
float range_weight(float sigma) {
    KINO_CHECK(sigma > 0);
    return std::isinf(sigma) ? 0.0f : 1.0f / (2 * sigma * sigma * kLn2);
}

/// Push constants of the kernels that make the picture.
struct UpParams {
    shared::LodParams lod;
    shared::FinalParams finish;
};
static_assert(sizeof(UpParams) == sizeof(shared::LodParams) + sizeof(shared::FinalParams));

/// All that the passes of one reconstruction share.
struct Upsampling {
    TextureId linear;  ///< as shaded
    TextureId light;   ///< finite, without albedo
    CoarseSurface coarse;
    SurfaceTargets fine;
    TextureId out;
    TextureId doubt;  ///< valid: pixels are to be listed
    FramebufferLodOptions options;
    shared::LodParams params;
    shared::FinalParams finish;
    bool finishes = false;  ///< the picture leaves ready to be shown
    shared::LodTileParams tiles;
    bool has_object = false;
    // Where tiles are told apart:
    BufferId edge_of_tile;
    BufferId draws;
    BufferId flat_runs;
    BufferId edge_runs;

    [[nodiscard]] bool keeps_background() const { return params.z_weight > 0; }
    [[nodiscard]] std::uint32_t tile_count() const { return tiles.tiles.x * tiles.tiles.y; }
    /// Specialisation of all kernels.
    [[nodiscard]] std::vector<std::uint32_t> constants() const {
        return {options.fine_grained ? 1u : 0u,
                keeps_background() ? 1u : 0u,
                static_cast<std::uint32_t>(options.metric),
                doubt.valid() ? 1u : 0u,
                static_cast<std::uint32_t>(options.kernel),
                finishes ? 1u : 0u};
    }
    [[nodiscard]] UpParams push() const { return {params, finish}; }
    [[nodiscard]] std::vector<VkFormat> formats(const PassContext& c) const {
        std::vector<VkFormat> formats = {c.desc(out).format};
        if (doubt.valid()) formats.push_back(kDoubtFormat);
        return formats;
    }
};

gpu::PipelineDesc fragment_pipeline(const char* name, std::span<const std::uint32_t> fragment,
                                    std::size_t textures, std::uint32_t push_bytes) {
    gpu::PipelineDesc desc;
    desc.name = name;
    desc.vertex = kLodFullscreen;
    desc.fragment = fragment;
    desc.bindings.assign(textures, gpu::Binding::texture);
    desc.push_bytes = push_bytes;
    return desc;
}

void add_pack(FrameGraph& graph, Upsampling& up) {
    const shared::LodTileParams& tiles = up.tiles;
    const auto width = static_cast<std::uint32_t>(tiles.last.x + 1);
    const auto height = static_cast<std::uint32_t>(tiles.last.y + 1);
    up.light = graph.create_texture("coarse light", {width, height, kLodLinearFormat});
    const auto execute = [up, width, height](PassContext& c) {
        gpu::PipelineDesc desc =
            up.has_object ? fragment_pipeline("lod/pack with objects", kLodPackObject, 3, 0)
                          : fragment_pipeline("lod/pack", kLodPack, 2, 0);
        desc.constants = {up.options.fine_grained ? 1u : 0u};
        desc.color_formats = {kLodLinearFormat};
        const std::array<gpu::Target, 1> targets = {{{.view = c.view(up.light)}}};
        c.commands().begin_rendering({width, height}, targets, nullptr);
        std::vector<gpu::Bound> inputs = {c.bound(up.linear), c.bound(up.coarse.surface.albedo)};
        if (up.has_object) inputs.push_back(c.bound(up.coarse.surface.object));
        if (c.bind(desc, inputs)) {
            c.commands().draw(3);
        }
        c.commands().end_rendering();
    };
    graph.add_pass(
        "lod/pack", "lod",
        [&](PassBuilder& b) {
            b.read(up.linear, Use::fragment_read);
            b.read(up.coarse.surface.albedo, Use::fragment_read);
            if (up.has_object) b.read(up.coarse.surface.object, Use::fragment_read);
            up.light = b.write(up.light, Use::color_attachment);
        },
        execute);
}

void add_tiles(FrameGraph& graph, Upsampling& up) {
    up.edge_of_tile = graph.create_buffer("edge tiles", {up.tile_count() * 4});
    up.draws = graph.create_buffer("tile draws", {sizeof(shared::LodRuns)});
    up.flat_runs = graph.create_buffer("flat runs", {up.tile_count() * 8});
    up.edge_runs = graph.create_buffer("edge runs", {up.tile_count() * 8});
    const auto classify = [up](PassContext& c) {
        gpu::PipelineDesc desc;
        desc.name = up.has_object ? "lod/classify with objects" : "lod/classify";
        desc.compute =
            up.has_object ? std::span<const std::uint32_t>(kLodClassifyObject) : kLodClassify;
        desc.bindings = {gpu::Binding::texture, gpu::Binding::storage};
        desc.push_bytes = sizeof(up.tiles);
        desc.constants = {up.options.metric == RangeMetric::plane ? 1u : 0u};
        std::vector<gpu::Bound> inputs = {c.bound(up.coarse.guide), c.bound(up.edge_of_tile)};
        if (up.has_object) {
            desc.bindings.push_back(gpu::Binding::texture);
            inputs.push_back(c.bound(up.coarse.surface.object));
        }
        // Six vertices a rectangle, none yet.
        constexpr std::array<std::uint32_t, 8> kNoRuns = {6, 0, 0, 0, 6, 0, 0, 0};
        c.commands().update(c.buffer(up.draws), kNoRuns);
        if (c.bind(desc, inputs)) {
            c.commands().constants(up.tiles);
            c.commands().dispatch((up.tile_count() + 63) / 64);
        }
    };
    graph.add_pass(
        "lod/classify", "lod",
        [&](PassBuilder& b) {
            b.read(up.coarse.guide, Use::compute_read);
            if (up.has_object) b.read(up.coarse.surface.object, Use::compute_read);
            up.edge_of_tile = b.write(up.edge_of_tile, Use::compute_write);
            up.draws = b.write(up.draws, Use::transfer_write);
        },
        classify);
    const auto runs = [up](PassContext& c) {
        gpu::PipelineDesc desc;
        desc.name = "lod/runs";
        desc.compute = kLodRuns;
        desc.bindings = {gpu::Binding::words, gpu::Binding::storage, gpu::Binding::storage,
                         gpu::Binding::storage};
        desc.push_bytes = sizeof(up.tiles);
        if (c.bind(desc, {c.bound(up.edge_of_tile), c.bound(up.draws), c.bound(up.flat_runs),
                          c.bound(up.edge_runs)})) {
            c.commands().constants(up.tiles);
            c.commands().dispatch((up.tiles.tiles.y + 63) / 64);
        }
    };
    graph.add_pass(
        "lod/runs", "lod",
        [&](PassBuilder& b) {
            b.read(up.edge_of_tile, Use::compute_read);
            for (BufferId* id : {&up.draws, &up.flat_runs, &up.edge_runs}) {
                *id = b.write(*id, Use::compute_write);
            }
        },
        runs);
}

/// Light alone, over the whole picture or the flat runs.
void draw_flat(PassContext& c, const Upsampling& up) {
    const bool runs = up.flat_runs.valid();
    gpu::PipelineDesc desc =
        fragment_pipeline(runs ? "lod/flat tiles" : "lod/flat", kLodFlat, 3, sizeof(UpParams));
    if (runs) desc.vertex = kLodRunsVertex;
    desc.bindings[0] = gpu::Binding::storage;
    desc.constants = up.constants();
    desc.color_formats = up.formats(c);
    const gpu::Bound rectangles =
        runs ? c.bound(up.flat_runs) : c.upload(&up.params, sizeof(up.params));
    if (!c.bind(desc, {rectangles, c.bound(up.light), c.bound(up.fine.albedo)})) return;
    c.commands().constants(up.push());
    if (runs) {
        c.commands().draw_indirect(c.buffer(up.draws));
    } else {
        c.commands().draw(3);
    }
}

/// Draws with a kernel that compares guides, over the whole picture or the runs of one kind.
void draw_guided(PassContext& c, const Upsampling& up, const char* name,
                 std::span<const std::uint32_t> plain, std::span<const std::uint32_t> with_objects,
                 BufferId rectangles, std::size_t command) {
    const bool runs = rectangles.valid();
    gpu::PipelineDesc desc = fragment_pipeline(name, up.has_object ? with_objects : plain,
                                               up.has_object ? 7 : 6, sizeof(UpParams));
    if (runs) desc.name += " tiles";
    if (up.has_object) desc.name += " with objects";
    if (runs) desc.vertex = kLodRunsVertex;
    desc.bindings[0] = gpu::Binding::storage;
    desc.constants = up.constants();
    desc.color_formats = up.formats(c);
    std::vector<gpu::Bound> inputs = {
        runs ? c.bound(rectangles) : c.upload(&up.params, sizeof(up.params)),
        c.bound(up.light),
        c.bound(up.coarse.guide),
        c.bound(up.fine.albedo),
        c.bound(up.fine.view_z),
        c.bound(up.fine.normal)};
    if (up.has_object) inputs.push_back(c.bound(up.fine.object));
    if (!c.bind(desc, inputs)) return;
    c.commands().constants(up.push());
    if (runs) {
        c.commands().draw_indirect(c.buffer(up.draws), command);
    } else {
        c.commands().draw(3);
    }
}

/// Eq. 1.
void draw_edges(PassContext& c, const Upsampling& up) {
    draw_guided(c, up, "lod/edge", kLodEdge, kLodEdgeObject, up.edge_runs,
                offsetof(shared::LodRuns, edge_vertices));
}

/// Flat runs whose pixels are compared with what they get.
void draw_flat_checked(PassContext& c, const Upsampling& up) {
    draw_guided(c, up, "lod/flat checked", kLodFlatCheck, kLodFlatCheckObject, up.flat_runs, 0);
}

void draw_wide(PassContext& c, const Upsampling& up) {
    gpu::PipelineDesc desc = fragment_pipeline(
        "lod/wide", up.has_object ? std::span<const std::uint32_t>(kLodWideObject) : kLodWide,
        up.has_object ? 9 : 7, sizeof(UpParams));
    if (up.has_object) desc.name += " with objects";
    desc.constants = up.constants();
    desc.color_formats = up.formats(c);
    const SurfaceTargets& coarse = up.coarse.surface;
    std::vector<gpu::Bound> inputs = {c.bound(up.linear),      c.bound(coarse.albedo),
                                      c.bound(coarse.view_z),  c.bound(coarse.normal),
                                      c.bound(up.fine.albedo), c.bound(up.fine.view_z),
                                      c.bound(up.fine.normal)};
    if (up.has_object) {
        inputs.push_back(c.bound(coarse.object));
        inputs.push_back(c.bound(up.fine.object));
    }
    if (!c.bind(desc, inputs)) return;
    c.commands().constants(up.push());
    c.commands().draw(3);
}

void draw_bilinear(PassContext& c, const Upsampling& up) {
    gpu::PipelineDesc desc = fragment_pipeline("lod/bilinear", kLodBilinear, 1, sizeof(UpParams));
    desc.constants = up.constants();
    desc.color_formats = up.formats(c);
    if (!c.bind(desc, {c.bound(up.linear)})) return;
    c.commands().constants(up.push());
    c.commands().draw(3);
}

enum class Kernel : std::uint8_t { bilinear, flat, tiles, edges, wide };

Kernel kernel_of(const FramebufferLodOptions& options) {
    if (options.reconstruction == Reconstruction::bilinear) {
        return options.fine_grained ? Kernel::flat : Kernel::bilinear;
    }
    if (options.format == LodFormat::wide) return Kernel::wide;
    const bool tiles = options.flat_tolerance > 0 && options.kernel == LodKernel::tent;
    return tiles ? Kernel::tiles : Kernel::edges;
}

void add_up(FrameGraph& graph, Upsampling& up, Kernel kernel) {
    const auto execute = [up, kernel](PassContext& c) {
        std::vector<gpu::Target> targets = {{.view = c.view(up.out)}};
        if (up.doubt.valid()) targets.push_back({.view = c.view(up.doubt)});
        c.commands().begin_rendering({up.params.fine.x, up.params.fine.y}, targets, nullptr);
        if (kernel == Kernel::bilinear) draw_bilinear(c, up);
        if (kernel == Kernel::flat || kernel == Kernel::tiles) {
            up.doubt.valid() ? draw_flat_checked(c, up) : draw_flat(c, up);
        }
        if (kernel == Kernel::edges || kernel == Kernel::tiles) draw_edges(c, up);
        if (kernel == Kernel::wide) draw_wide(c, up);
        c.commands().end_rendering();
    };
    const bool guided = kernel != Kernel::bilinear && kernel != Kernel::flat;
    graph.add_pass(
        "lod/up", "lod",
        [&](PassBuilder& b) {
            const auto read = [&](TextureId id) {
                if (id.valid()) b.read(id, Use::fragment_read);
            };
            if (kernel == Kernel::bilinear || kernel == Kernel::wide) read(up.linear);
            if (kernel == Kernel::wide) {
                read(up.coarse.surface.albedo);
                read(up.coarse.surface.view_z);
                read(up.coarse.surface.normal);
            }
            if (kernel != Kernel::bilinear) read(up.fine.albedo);
            read(up.light);
            if (guided) {
                if (kernel != Kernel::wide) read(up.coarse.guide);
                read(up.fine.view_z);
                read(up.fine.normal);
                if (up.has_object) read(up.fine.object);
                if (up.has_object && kernel == Kernel::wide) read(up.coarse.surface.object);
            }
            if (kernel == Kernel::tiles) {
                b.read(up.draws, Use::indirect_read);
                b.read(up.flat_runs, Use::vertex_read);
                b.read(up.edge_runs, Use::vertex_read);
            }
            up.out = b.write(up.out, Use::color_attachment);
            if (up.doubt.valid()) up.doubt = b.write(up.doubt, Use::color_attachment);
        },
        execute);
}

}  // namespace

graph::TextureId add_reconstruction(graph::FrameGraph& graph, graph::TextureId coarse_linear,
                                    const CoarseSurface& coarse, const SurfaceTargets& fine,
                                    const View& view, const FramebufferLodOptions& options,
                                    LodFixList* fix, const LodFinish* finish) {
    if (coarse.view.width == view.width && coarse.view.height == view.height) return coarse_linear;
    const auto width = static_cast<std::uint32_t>(view.width);
    const auto height = static_cast<std::uint32_t>(view.height);
    Upsampling up;
    up.linear = coarse_linear;
    up.coarse = coarse;
    up.fine = fine;
    up.options = options;
    up.has_object = fine.object.valid() && coarse.surface.object.valid();
    const bool bilinear = options.reconstruction == Reconstruction::bilinear;
    const glm::ivec2 last(coarse.view.width - 1, coarse.view.height - 1);
    up.params = {.fine_k = lod_ray_scale(view),
                 .coarse_of_fine = lod_coarse_of_fine(view, coarse.view),
                 .last = last,
                 .fine = {width, height},
                 .z_weight = bilinear ? 0.0f : range_weight(options.sigma_z),
                 .n_weight = bilinear ? 0.0f : range_weight(options.sigma_n)};
    constexpr auto kTile = static_cast<std::uint32_t>(kLodTilePx);
    // One sigma of ln z in steps of the guide; for metres, at 4 m.
    const float ln_sigma =
        options.metric == RangeMetric::depth ? options.sigma_z / 4 : options.sigma_z;
    constexpr float kMost = 1e9f;
    up.tiles = {.coarse_of_fine = up.params.coarse_of_fine,
                .coarse_k = lod_ray_scale(coarse.view),
                .fine = {width, height},
                .last = last,
                .tiles = {(width + kTile - 1) / kTile, (height + kTile - 1) / kTile},
                .depth_steps = std::min(
                    kMost, options.flat_tolerance * ln_sigma * shared::kGuideStepsPerOctave / kLn2),
                .normal_steps = std::min(
                    kMost, options.flat_tolerance * options.sigma_n * shared::kGuideNormalSteps)};
    const bool fixes = fix != nullptr && wants_fixes(options);
    if (finish != nullptr) {
        KINO_CHECK(!fixes);
        up.finishes = true;
        up.out = finish->target;
        up.finish = {.exposure = finish->exposure, .tone_map = finish->tone_map ? 1u : 0u};
    } else {
        up.out = graph.create_texture("reconstructed, linear",
                                      {width, height, kLodLinearFormat, 1, fixes});
    }
    if (fixes) up.doubt = graph.create_texture("doubt", {width, height, kDoubtFormat});

    const Kernel kernel = kernel_of(options);
    if (kernel == Kernel::flat) up.has_object = false;  // nobody asks
    if (kernel != Kernel::bilinear && kernel != Kernel::wide) add_pack(graph, up);
    if (kernel == Kernel::tiles) add_tiles(graph, up);
    add_up(graph, up, kernel);
    if (fixes) *fix = add_fix_list(graph, up.doubt, view, options);
    return up.out;
}

}  // namespace kino
