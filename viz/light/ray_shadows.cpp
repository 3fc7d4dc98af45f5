#include "viz/light/ray_shadows.h"

#include <algorithm>
#include <array>

#include "base/check.h"
#include "viz/graph/executor.h"
#include "viz/light/light_records.h"
#include "viz/light/shadow_shared.h"

namespace kino {
namespace {

using gpu::Binding;
using graph::BufferId;
using graph::FrameGraph;
using graph::PassBuilder;
using graph::PassContext;
using graph::Use;

constexpr std::uint32_t kShadowPixels[] = {
#include "shadow_pixels_comp.inc"
};
constexpr std::uint32_t kShadowListed[] = {
#include "shadow_listed_comp.inc"
};
constexpr std::uint32_t kShadowJobs[] = {
#include "shadow_jobs_comp.inc"
};
constexpr std::uint32_t kShadowCast[] = {
#include "shadow_cast_comp.inc"
};
constexpr std::uint32_t kShadowExpand[] = {
#include "shadow_expand_comp.inc"
};

constexpr const char* kShadowGroup = "shadows";
constexpr std::uint32_t kShadowMostSlots = 128;

struct ShadowInputs {
    ShadowSurface surface;
    LightLists lists;
    BvhBuffers meshes, live;  ///< one of them is not empty
    shared::ShadowParams params{};
    std::vector<std::uint32_t> constants;
    // Sizes that memory is made for, not below params.size and params.texels.
    VkExtent2D room{};
    VkExtent2D room_texels{};

    void read(PassBuilder& b) const {
        b.read(surface.view_z, Use::compute_read);
        b.read(surface.normal, Use::compute_read);
        b.read(lists.lights, Use::compute_read);
        if (lists.tile_px == 0) return;
        b.read(lists.headers, Use::compute_read);
        b.read(lists.indices, Use::compute_read);
    }
    void read_tree(PassBuilder& b) const {
        for (const BvhBuffers* tree : {&meshes, &live}) {
            if (tree->empty()) continue;
            b.read(tree->nodes, Use::compute_read);
            b.read(tree->triangles, Use::compute_read);
        }
    }
    /// Nodes and triangles of the meshes, then of the live frame. What is compiled out still wants
    /// something bound.
    [[nodiscard]] std::array<gpu::Bound, 4> trees(const PassContext& c) const {
        const BvhBuffers& first = meshes.empty() ? live : meshes;
        const BvhBuffers& second = live.empty() ? meshes : live;
        return {c.bound(first.nodes), c.bound(first.triangles), c.bound(second.nodes),
                c.bound(second.triangles)};
    }
    /// What shadow_head.glsl binds.
    [[nodiscard]] std::array<gpu::Bound, 5> bound(const PassContext& c) const {
        const gpu::Bound lights = c.bound(lists.lights);
        const bool has_lists = lists.tile_px != 0;
        return {c.bound(surface.view_z), c.bound(surface.normal), lights,
                has_lists ? c.bound(lists.headers) : lights,
                has_lists ? c.bound(lists.indices) : lights};
    }
    [[nodiscard]] gpu::PipelineDesc pipeline(const char* name, std::span<const std::uint32_t> code,
                                             std::initializer_list<Binding> others) const {
        gpu::PipelineDesc desc;
        desc.name = name;
        desc.compute = code;
        desc.bindings = {Binding::texture, Binding::texture, Binding::word_quads,
                         Binding::word_pairs, Binding::words};
        desc.bindings.insert(desc.bindings.end(), others);
        desc.push_bytes = sizeof(params);
        desc.constants = constants;
        return desc;
    }
};

void add_shadow_clear(FrameGraph& graph, BufferId& counters, BufferId* masks) {
    graph.add_pass(
        "light/shadow clear", kShadowGroup,
        [&](PassBuilder& b) {
            counters = b.write(counters, Use::transfer_write);
            if (masks != nullptr) *masks = b.write(*masks, Use::transfer_write);
        },
        [counters, masks = masks != nullptr ? *masks : BufferId{}](PassContext& c) {
            constexpr std::array<std::uint32_t, 6> kNone = {0, 1, 1, 0, 0, 0};
            c.commands().update(c.buffer(counters), kNone);
            if (masks.valid()) c.commands().fill(c.buffer(masks), 0);
        });
}

void add_shadow_pixels(FrameGraph& graph, const ShadowInputs& in, RayShadows& out) {
    add_shadow_clear(graph, out.counters, nullptr);
    graph.add_pass(
        "light/shadow pixels", kShadowGroup,
        [&](PassBuilder& b) {
            in.read(b);
            in.read_tree(b);
            out.masks = b.write(out.masks, Use::compute_write);
            out.counters = b.write(out.counters, Use::compute_write);
        },
        [in, masks = out.masks, counters = out.counters](PassContext& c) {
            const auto desc =
                in.pipeline("light/shadow pixels", kShadowPixels,
                            {Binding::word_quads, Binding::word_quads, Binding::storage,
                             Binding::storage, Binding::word_quads, Binding::word_quads});
            const auto head = in.bound(c);
            const auto tree = in.trees(c);
            if (!c.bind(desc, {head[0], head[1], head[2], head[3], head[4], tree[0], tree[1],
                               c.bound(masks), c.bound(counters), tree[2], tree[3]})) {
                return;
            }
            c.commands().constants(in.params);
            c.commands().dispatch((in.params.texels.x + 63) / 64, in.params.texels.y);
        });
}

/// The next band's counts, the sums of all bands kept.
void add_next_band(FrameGraph& graph, BufferId& counters) {
    graph.add_pass(
        "light/shadow next band", kShadowGroup,
        [&](PassBuilder& b) { counters = b.write(counters, Use::transfer_write); },
        [counters](PassContext& c) {
            constexpr std::array<std::uint32_t, 4> kNone = {0, 1, 1, 0};
            c.commands().update(c.buffer(counters), kNone);
        });
}

void add_shadow_jobs(FrameGraph& graph, ShadowInputs in, std::uint32_t room, RayShadows& out) {
    add_shadow_clear(graph, out.counters, &out.masks);
    shared::ShadowParams& p = in.params;
    const std::uint32_t row_jobs = std::max(p.texels.x * p.most_rays, 1u);
    const std::uint32_t band = std::min(std::max(room / row_jobs, 1u), p.texels.y);
    // One group more than is dispatched at most is never needed: 65535 groups are 2^22 - 64 jobs.
    KINO_CHECK_LE(std::uint64_t{band} * row_jobs, (std::uint64_t{1} << 22) - 64);
    // No size within the room takes more.
    const std::uint64_t room_row = std::max<std::uint64_t>(in.room_texels.width * p.most_rays, 1);
    const std::uint64_t most_jobs =
        std::max(room_row, std::min<std::uint64_t>(room, room_row * in.room_texels.height));
    BufferId jobs = graph.create_buffer("shadow jobs", {most_jobs * 4});
    for (p.first_row = 0; p.first_row < p.texels.y; p.first_row += band) {
        p.rows = std::min(band, p.texels.y - p.first_row);
        if (p.first_row > 0) add_next_band(graph, out.counters);
        graph.add_pass(
            "light/shadow jobs", kShadowGroup,
            [&](PassBuilder& b) {
                in.read(b);
                jobs = b.write(jobs, Use::compute_write);
                out.counters = b.write(out.counters, Use::compute_write);
            },
            [in, jobs, counters = out.counters](PassContext& c) {
                const auto desc = in.pipeline("light/shadow jobs", kShadowJobs,
                                              {Binding::storage, Binding::storage});
                const auto head = in.bound(c);
                if (!c.bind(desc, {head[0], head[1], head[2], head[3], head[4], c.bound(jobs),
                                   c.bound(counters)})) {
                    return;
                }
                c.commands().constants(in.params);
                c.commands().dispatch((in.params.texels.x + 63) / 64, in.params.rows);
            });
        graph.add_pass(
            "light/shadow cast", kShadowGroup,
            [&](PassBuilder& b) {
                in.read(b);
                in.read_tree(b);
                b.read(jobs, Use::compute_read);
                b.read(out.counters, Use::compute_read);
                b.read(out.counters, Use::indirect_read);
                out.masks = b.write(out.masks, Use::compute_write);
            },
            [in, jobs, counters = out.counters, masks = out.masks](PassContext& c) {
                const auto desc = in.pipeline(
                    "light/shadow cast", kShadowCast,
                    {Binding::word_quads, Binding::word_quads, Binding::words, Binding::storage,
                     Binding::storage, Binding::word_quads, Binding::word_quads});
                const auto head = in.bound(c);
                const auto tree = in.trees(c);
                if (!c.bind(desc,
                            {head[0], head[1], head[2], head[3], head[4], tree[0], tree[1],
                             c.bound(jobs), c.bound(counters), c.bound(masks), tree[2], tree[3]})) {
                    return;
                }
                c.commands().constants(in.params);
                c.commands().dispatch_indirect(c.buffer(counters), 0);
            });
    }
}

BufferId add_shadow_expand(FrameGraph& graph, const ShadowInputs& in, BufferId traced) {
    const glm::uvec2 size = in.params.size;
    BufferId masks = graph.create_buffer(
        "shadow masks", {std::uint64_t{in.room.width} * in.room.height * sizeof(glm::uvec4)});
    graph.add_pass(
        "light/shadow expand", kShadowGroup,
        [&](PassBuilder& b) {
            in.read(b);
            b.read(traced, Use::compute_read);
            masks = b.write(masks, Use::compute_write);
        },
        [in, size, traced, id = masks](PassContext& c) {
            const auto desc = in.pipeline("light/shadow expand", kShadowExpand,
                                          {Binding::word_quads, Binding::storage});
            const auto head = in.bound(c);
            if (!c.bind(desc, {head[0], head[1], head[2], head[3], head[4], c.bound(traced),
                               c.bound(id)})) {
                return;
            }
            c.commands().constants(in.params);
            c.commands().dispatch((size.x + 63) / 64, size.y);
        });
    return masks;
}

/// Texels of 2 x 2 pixels must lie within one tile.
bool tiles_are_even(const LightLists& lists, const View& view) {
    if (lists.tile_px == 0) return true;
    const std::uint32_t scaled_x = lists.tile_px * static_cast<std::uint32_t>(view.width);
    const std::uint32_t scaled_y = lists.tile_px * static_cast<std::uint32_t>(view.height);
    return scaled_x % (2 * lists.width) == 0 && scaled_y % (2 * lists.height) == 0;
}

bool casts_rays(const Scene& scene, const SceneBvhPasses& bvh, const RayShadowOptions& options) {
    KINO_CHECK_LE(options.rays_per_pixel, kShadowMostSlots);
    return !(bvh.tree.empty() && bvh.live.empty()) && options.rays_per_pixel != 0 &&
           wants_ray_shadows(scene);
}

/// `half`: a texel is 2 x 2 pixels.
ShadowInputs shadow_inputs(const View& view, const ShadowSurface& surface, const LightLists& lists,
                           const SceneBvhPasses& bvh, const RayShadowOptions& options, bool half) {
    const std::uint32_t divisor = half ? 2 : 1;
    ShadowInputs in{.surface = surface, .lists = lists, .meshes = bvh.tree, .live = bvh.live};
    shared::ShadowParams& p = in.params;
    const glm::dmat3 rotation = glm::mat3_cast(view.world_from_view.rotation);
    const glm::dvec3 translation = view.world_from_view.translation - bvh.center;
    const auto row = [&](int k) {
        return glm::vec4(rotation[0][k], rotation[1][k], rotation[2][k], translation[k]);
    };
    p.tree_from_view_x = row(0);
    p.tree_from_view_y = row(1);
    p.tree_from_view_z = row(2);
    const Projection& k = view.projection;
    p.k = {1 / k.fx, 1 / k.fy, k.cx, k.cy};
    p.size = {view.width, view.height};
    p.texels = (p.size + divisor - 1u) / divisor;
    p.tiles_x = lists.tiles_x;
    p.globals = lists.global_count;
    p.locals = lists.local_count;
    p.most_rays = options.rays_per_pixel;
    p.offset = options.offset + surface.off_surface;
    p.live_bias_m = options.live_bias_m;
    if (lists.tile_px != 0) {
        p.tile_scale = glm::vec2(lists.width, lists.height) / glm::vec2(p.size) /
                       static_cast<float>(lists.tile_px);
    }
    in.constants = {lists.tile_px != 0 ? 1u : 0u, half ? 1u : 0u, lists.has_spots ? 1u : 0u,
                    (bvh.tree.empty() ? 0u : 1u) | (bvh.live.empty() ? 0u : 2u)};
    return in;
}

}  // namespace

bool wants_ray_shadows(const Scene& scene) {
    return std::any_of(scene.lights.begin(), scene.lights.end(), [](const Light& light) {
        return light.shadow == LightShadow::raycast && is_usable(light);
    });
}

RayShadows add_ray_shadows(FrameGraph& graph, const Scene& scene, const View& view,
                           const ShadowSurface& surface, const LightLists& lists,
                           const SceneBvhPasses& bvh, const RayShadowOptions& options) {
    RayShadows out;
    if (!casts_rays(scene, bvh, options)) return out;
    const bool half = options.half_resolution && tiles_are_even(lists, view);
    ShadowInputs in = shadow_inputs(view, surface, lists, bvh, options, half);
    const shared::ShadowParams& p = in.params;
    const std::uint32_t divisor = half ? 2 : 1;
    in.room = graph.room({p.size.x, p.size.y});
    in.room_texels = {(in.room.width + divisor - 1) / divisor,
                      (in.room.height + divisor - 1) / divisor};
    const std::uint64_t texels = std::uint64_t{in.room_texels.width} * in.room_texels.height;
    KINO_CHECK(texels < (1u << 25));  // a job has seven bits for its slot
    out.masks = graph.create_buffer("shadow masks, traced", {texels * sizeof(glm::uvec4)});
    out.counters = graph.create_buffer("shadow counters", {sizeof(shared::ShadowCounters)});
    if (options.dispatch == ShadowDispatch::per_pixel) {
        add_shadow_pixels(graph, in, out);
    } else {
        add_shadow_jobs(graph, in, options.job_room, out);
    }
    if (half) out.masks = add_shadow_expand(graph, in, out.masks);
    return out;
}

BufferId add_listed_shadows(FrameGraph& graph, const Scene& scene, const View& view,
                            const ShadowSurface& surface, const LightLists& lists,
                            const SceneBvhPasses& bvh, const PixelList& list,
                            const RayShadowOptions& options) {
    if (!casts_rays(scene, bvh, options)) return {};
    const ShadowInputs in = shadow_inputs(view, surface, lists, bvh, options, false);
    BufferId masks = graph.create_buffer("shadow masks, listed",
                                         {std::uint64_t{list.most} * sizeof(glm::uvec4)});
    graph.add_pass(
        "light/shadow listed", kShadowGroup,
        [&](PassBuilder& b) {
            in.read(b);
            in.read_tree(b);
            b.read(list.pixels, Use::compute_read);
            b.read(list.dispatch, Use::compute_read);
            b.read(list.dispatch, Use::indirect_read);
            masks = b.write(masks, Use::compute_write);
        },
        [in, list, id = masks](PassContext& c) {
            const auto desc = in.pipeline(
                "light/shadow listed", kShadowListed,
                {Binding::word_quads, Binding::word_quads, Binding::storage, Binding::words,
                 Binding::word_quads, Binding::word_quads, Binding::words});
            const auto head = in.bound(c);
            const auto tree = in.trees(c);
            if (!c.bind(desc,
                        {head[0], head[1], head[2], head[3], head[4], tree[0], tree[1], c.bound(id),
                         c.bound(list.pixels), tree[2], tree[3], c.bound(list.dispatch)})) {
                return;
            }
            c.commands().constants(in.params);
            c.commands().dispatch_indirect(c.buffer(list.dispatch), 0);
        });
    return masks;
}

}  // namespace kino
