#include "tests/viz/lights/light_baselines.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "viz/graph/executor.h"
#include "viz/light/buffer_upload.h"
#include "viz/light/light_passes.h"

namespace kino::test {
namespace {

using gpu::Binding;
using graph::BufferId;
using graph::FrameGraph;
using graph::PassBuilder;
using graph::PassContext;
using graph::TextureId;
using graph::Use;

constexpr std::uint32_t kFullscreenTriangle[] = {
#include "baseline_fullscreen_vert.inc"
};
constexpr std::uint32_t kDeferred[] = {
#include "deferred_comp.inc"
};
constexpr std::uint32_t kDeferredFinal[] = {
#include "deferred_final_frag.inc"
};
constexpr std::uint32_t kClustered[] = {
#include "clustered_frag.inc"
};

template <class Params>
void fullscreen(PassContext& c, gpu::PipelineDesc desc, TextureId target, const Params& params,
                std::initializer_list<gpu::Bound> resources) {
    desc.vertex = kFullscreenTriangle;
    desc.push_bytes = sizeof(Params);
    desc.color_formats = {c.desc(target).format};
    const std::array<gpu::Target, 1> targets = {{{.view = c.view(target)}}};
    c.commands().begin_rendering({c.desc(target).width, c.desc(target).height}, targets, nullptr);
    if (c.bind(desc, resources)) {
        c.commands().constants(params);
        c.commands().draw(3);
    }
    c.commands().end_rendering();
}

TextureId linear_target(FrameGraph& graph, const View& view) {
    return graph.create_texture("baseline, linear",
                                {static_cast<std::uint32_t>(view.width),
                                 static_cast<std::uint32_t>(view.height), kSceneLinearFormat});
}

glm::vec4 intrinsics(const View& view) {
    const Projection& k = view.projection;
    return {k.fx, k.fy, k.cx, k.cy};
}

}  // namespace

TextureId add_deferred(FrameGraph& graph, const Scene& scene, const View& view,
                       const SurfaceTargets& surface) {
    const PackedLights packed = pack_lights(scene, view, UINT32_MAX);
    const auto width = static_cast<std::uint32_t>(view.width);
    const auto height = static_cast<std::uint32_t>(view.height);
    BufferId lights =
        graph.create_buffer("lights", {roomy_bytes<shared::LightRecord>(packed.records.size())});
    BufferId volumes =
        graph.create_buffer("volumes", {roomy_bytes<shared::LightVolume>(packed.volumes.size())});
    BufferId irradiance = graph.create_buffer("irradiance", {std::uint64_t{width} * height * 16});
    graph.add_pass(
        "baseline/upload", "cull",
        [&](PassBuilder& b) {
            lights = b.write(lights, Use::transfer_write);
            volumes = b.write(volumes, Use::transfer_write);
        },
        [=](PassContext& c) {
            write_buffer(c, lights, packed.records);
            write_buffer(c, volumes, packed.volumes);
        });
    const shared::CullParams params{.k = intrinsics(view),
                                    .size = {width, height},
                                    .locals = packed.local_count,
                                    .first_local = packed.global_count};
    graph.add_pass(
        "baseline/deferred", "cull",
        [&](PassBuilder& b) {
            b.read(surface.view_z, Use::compute_read);
            b.read(surface.normal, Use::compute_read);
            b.read(lights, Use::compute_read);
            b.read(volumes, Use::compute_read);
            irradiance = b.write(irradiance, Use::compute_write);
        },
        [=](PassContext& c) {
            gpu::PipelineDesc desc;
            desc.name = "baseline/deferred";
            desc.compute = kDeferred;
            desc.bindings = {Binding::texture, Binding::texture, Binding::word_quads,
                             Binding::word_quads, Binding::storage};
            desc.push_bytes = sizeof(params);
            desc.constants = {8, 0, 32, 0, 1};
            if (!c.bind(desc, {c.bound(surface.view_z), c.bound(surface.normal), c.bound(volumes),
                               c.bound(lights), c.bound(irradiance)})) {
                return;
            }
            c.commands().constants(params);
            c.commands().dispatch((width + 7) / 8, (height + 7) / 8);
        });
    TextureId linear = linear_target(graph, view);
    struct Push {
        glm::vec3 ambient;
        std::uint32_t row_px;
    };
    const Push push{scene.ambient, width};
    graph.add_pass(
        "baseline/deferred final", "light",
        [&](PassBuilder& b) {
            b.read(surface.albedo, Use::fragment_read);
            b.read(irradiance, Use::fragment_read);
            linear = b.write(linear, Use::color_attachment);
        },
        [=](PassContext& c) {
            gpu::PipelineDesc desc;
            desc.name = "baseline/deferred final";
            desc.fragment = kDeferredFinal;
            desc.bindings = {Binding::texture, Binding::word_quads};
            fullscreen(c, desc, linear, push, {c.bound(surface.albedo), c.bound(irradiance)});
        });
    return linear;
}

TextureId add_clustered(FrameGraph& graph, const Scene& scene, const View& view,
                        const SurfaceTargets& surface, std::uint32_t slices) {
    constexpr std::uint32_t kTile = 32;
    const double near_m = 0.1;
    const double far_m = 40;
    const DepthSlices depth{slices, near_m, slices / std::log(far_m / near_m)};
    PackedLights packed = pack_lights(scene, view, UINT32_MAX);
    HostLists made = make_host_lists(packed, view, kTile, depth);
    const LightLists lists = add_made_lists(graph, std::move(packed), std::move(made), view, kTile);
    struct Push {
        shared::ListShadeParams p;
        std::uint32_t cells_a_slice, slices;
        float near_m, slice_scale;
    };
    const Push push{.p = {.k = intrinsics(view),
                          .ambient = scene.ambient,
                          .tiles_x = lists.tiles_x,
                          .tile_scale = glm::vec2(1.0f / kTile),
                          .row_px = lists.width},
                    .cells_a_slice = lists.tiles_x * lists.tiles_y,
                    .slices = slices,
                    .near_m = static_cast<float>(near_m),
                    .slice_scale = static_cast<float>(depth.scale)};
    TextureId linear = linear_target(graph, view);
    graph.add_pass(
        "baseline/clustered", "light",
        [&](PassBuilder& b) {
            for (const TextureId id : {surface.albedo, surface.view_z, surface.normal}) {
                b.read(id, Use::fragment_read);
            }
            for (const BufferId id : {lists.lights, lists.headers, lists.indices}) {
                b.read(id, Use::fragment_read);
            }
            linear = b.write(linear, Use::color_attachment);
        },
        [=](PassContext& c) {
            gpu::PipelineDesc desc;
            desc.name = "baseline/clustered";
            desc.fragment = kClustered;
            desc.bindings = {Binding::texture,    Binding::texture,    Binding::texture,
                             Binding::word_quads, Binding::word_pairs, Binding::words,
                             Binding::words};
            fullscreen(c, desc, linear, push,
                       {c.bound(surface.albedo), c.bound(surface.view_z), c.bound(surface.normal),
                        c.bound(lists.lights), c.bound(lists.headers), c.bound(lists.indices),
                        c.bound(lists.indices)});
        });
    return linear;
}

namespace {

/// Boxes round spheres; a leaf holds one light, children of inner nodes follow by index.
struct TreeNode {
    glm::vec3 low{1e30f}, high{-1e30f};
    std::int32_t left = -1, right = -1;
    std::uint32_t light = 0;
};

std::int32_t build(const std::vector<shared::LightVolume>& volumes, std::span<std::uint32_t> part,
                   std::vector<TreeNode>& nodes) {
    TreeNode node;
    for (const std::uint32_t i : part) {
        node.low = glm::min(node.low, volumes[i].center - volumes[i].radius);
        node.high = glm::max(node.high, volumes[i].center + volumes[i].radius);
    }
    const auto place = static_cast<std::int32_t>(nodes.size());
    nodes.push_back(node);
    if (part.size() == 1) {
        nodes.back().light = part[0];
        return place;
    }
    const glm::vec3 size = node.high - node.low;
    const int axis = size.x > size.y ? (size.x > size.z ? 0 : 2) : (size.y > size.z ? 1 : 2);
    const std::size_t half = part.size() / 2;
    std::nth_element(part.begin(), part.begin() + static_cast<std::ptrdiff_t>(half), part.end(),
                     [&](std::uint32_t a, std::uint32_t b) {
                         return volumes[a].center[axis] < volumes[b].center[axis];
                     });
    const std::int32_t left = build(volumes, part.first(half), nodes);
    const std::int32_t right = build(volumes, part.subspan(half), nodes);
    nodes[static_cast<std::size_t>(place)].left = left;
    nodes[static_cast<std::size_t>(place)].right = right;
    return place;
}

}  // namespace

HostLists make_tree_lists(const PackedLights& packed, const View& view, std::uint32_t tile_px) {
    HostLists lists;
    lists.tiles_x = (static_cast<std::uint32_t>(view.width) + tile_px - 1) / tile_px;
    lists.tiles_y = (static_cast<std::uint32_t>(view.height) + tile_px - 1) / tile_px;
    std::vector<std::uint32_t> order(packed.volumes.size());
    std::iota(order.begin(), order.end(), 0u);
    std::vector<TreeNode> nodes;
    if (!order.empty()) (void)build(packed.volumes, order, nodes);
    const Projection& k = view.projection;
    std::vector<std::int32_t> stack;
    std::vector<std::uint32_t> found;
    for (std::uint32_t ty = 0; ty < lists.tiles_y; ++ty) {
        for (std::uint32_t tx = 0; tx < lists.tiles_x; ++tx) {
            const std::array<glm::vec3, 4> planes = [&] {
                const auto slope = [&](std::uint32_t tile, double f, double c) {
                    return static_cast<float>((1.0 * tile_px * tile - 0.5 - c) / f);
                };
                const float l = slope(tx, k.fx, k.cx);
                const float r = slope(tx + 1, k.fx, k.cx);
                const float t = slope(ty, k.fy, k.cy);
                const float b = slope(ty + 1, k.fy, k.cy);
                return std::array{
                    glm::normalize(glm::vec3(-1, 0, l)), glm::normalize(glm::vec3(1, 0, -r)),
                    glm::normalize(glm::vec3(0, -1, t)), glm::normalize(glm::vec3(0, 1, -b))};
            }();
            found.clear();
            stack.assign(nodes.empty() ? 0 : 1, 0);
            while (!stack.empty()) {
                const TreeNode& node = nodes[static_cast<std::size_t>(stack.back())];
                stack.pop_back();
                const glm::vec3 middle = 0.5f * (node.low + node.high);
                const glm::vec3 half = 0.5f * (node.high - node.low);
                const bool leaf = node.left < 0;
                bool outside = node.high.z <= 0;
                for (const glm::vec3& plane : planes) {
                    const float reach = leaf ? half.x : glm::dot(glm::abs(plane), half) * 1.0001f;
                    outside = outside || glm::dot(plane, middle) > reach;
                }
                if (outside) continue;
                if (leaf) {
                    found.push_back(packed.global_count + node.light);
                } else {
                    stack.push_back(node.left);
                    stack.push_back(node.right);
                }
            }
            std::sort(found.begin(), found.end());
            lists.headers.push_back(static_cast<std::uint32_t>(lists.indices.size()));
            lists.headers.push_back(static_cast<std::uint32_t>(found.size()));
            lists.indices.insert(lists.indices.end(), found.begin(), found.end());
        }
    }
    return lists;
}

}  // namespace kino::test
