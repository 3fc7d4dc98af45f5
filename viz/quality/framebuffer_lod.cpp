#include "viz/quality/framebuffer_lod.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <vector>

#include "base/check.h"
#include "viz/graph/executor.h"
#include "viz/quality/lod_passes.h"
#include "viz/quality/lod_shared.h"

namespace kino {
namespace {

using graph::PassBuilder;
using graph::PassContext;
using graph::TextureId;
using graph::Use;

constexpr std::uint32_t kLodPick[] = {
#include "lod_pick_frag.inc"
};
constexpr std::uint32_t kLodPickObject[] = {
#include "lod_pick_object_frag.inc"
};
constexpr std::uint32_t kLodPickVertex[] = {
#include "lod_fullscreen_vert.inc"
};

constexpr int kLeastLodWidth = 64;
constexpr int kLeastLodHeight = 48;
constexpr float kLeastAlbedo = 32.0f / 255.0f;

int coarse_side(int fine, double r, int least) {
    const int side = static_cast<int>(std::ceil(fine / r));
    return std::min(fine, std::max(side + side % 2, least));
}

/// Offset of the coarse pixels' places; see coarse_view.
double pick_bias(int fine, int coarse) {
    const int divisor = std::gcd(fine, coarse);
    return fine / divisor % 2 == 0 ? 0.5 * divisor / coarse : 0.0;
}

VkExtent2D extent_of(const View& view) {
    return {static_cast<std::uint32_t>(view.width), static_cast<std::uint32_t>(view.height)};
}

/// The least factor that memory is made for.
double least_factor(const FramebufferLodOptions& options) {
    return options.least_r >= 1 ? std::min(options.least_r, options.r) : options.r;
}

/// Farthest that a coarse pixel's place lies from its texel, fine pixels.
double most_offset(int fine, int coarse) {
    const int q = coarse / std::gcd(fine, coarse);
    return 0.5 - 0.5 / q;
}

float off_surface(const View& fine, const LodSize& size) {
    return static_cast<float>(
        std::hypot(most_offset(fine.width, size.width) / fine.projection.fx,
                   most_offset(fine.height, size.height) / fine.projection.fy));
}

struct AlongAxis {
    double scale = 1;  // coarse = scale * fine + offset
    double offset = 0;
};

AlongAxis along_axis(int fine, int coarse) {
    const double scale = static_cast<double>(coarse) / fine;
    return {scale, (0.5 - pick_bias(fine, coarse)) * scale - 0.5};
}

}  // namespace

LodSize lod_size(int width, int height, double r) {
    KINO_CHECK(width > 0 && height > 0 && r >= 1);
    return {coarse_side(width, r, kLeastLodWidth), coarse_side(height, r, kLeastLodHeight)};
}

View coarse_view(const View& fine, const LodSize& size) {
    const AlongAxis x = along_axis(fine.width, size.width);
    const AlongAxis y = along_axis(fine.height, size.height);
    View view = fine;
    view.width = size.width;
    view.height = size.height;
    view.projection.fx *= x.scale;
    view.projection.fy *= y.scale;
    view.projection.cx = view.projection.cx * x.scale + x.offset;
    view.projection.cy = view.projection.cy * y.scale + y.offset;
    return view;
}

glm::vec4 lod_ray_scale(const View& view) {
    const Projection& k = view.projection;
    return {1 / k.fx, 1 / k.fy, k.cx, k.cy};
}

glm::vec4 lod_coarse_of_fine(const View& fine, const View& coarse) {
    const AlongAxis x = along_axis(fine.width, coarse.width);
    const AlongAxis y = along_axis(fine.height, coarse.height);
    return {x.scale, y.scale, x.offset, y.offset};
}

CoarseSurface add_coarse_surface(graph::FrameGraph& graph, const SurfaceTargets& fine,
                                 const View& view, const FramebufferLodOptions& options) {
    KINO_CHECK(fine.albedo.valid() && fine.view_z.valid() && fine.normal.valid());
    const LodSize size = lod_size(view.width, view.height, options.r);
    if (size == LodSize{view.width, view.height})
        return {.surface = fine, .view = view, .guide = {}, .off_surface = 0};

    const VkExtent2D fine_room = graph.room(extent_of(view));
    const LodSize room = lod_size(static_cast<int>(fine_room.width),
                                  static_cast<int>(fine_room.height), least_factor(options));
    CoarseSurface coarse;
    coarse.view = coarse_view(view, size);
    coarse.off_surface = off_surface(view, size);
    graph.reserve(extent_of(coarse.view), {static_cast<std::uint32_t>(room.width),
                                           static_cast<std::uint32_t>(room.height)});
    const auto width = static_cast<std::uint32_t>(size.width);
    const auto height = static_cast<std::uint32_t>(size.height);
    SurfaceTargets& made = coarse.surface;
    made.albedo = graph.create_texture("coarse albedo", {width, height, VK_FORMAT_R8G8B8A8_UNORM});
    made.view_z = graph.create_texture("coarse depth", {width, height, kViewZFormat});
    made.normal = graph.create_texture("coarse normal", {width, height, kNormalFormat});
    const bool has_object = fine.object.valid();
    if (has_object) {
        made.object = graph.create_texture("coarse object", {width, height, VK_FORMAT_R32_UINT});
    }
    if (options.reconstruction == Reconstruction::geometry_aware &&
        options.format == LodFormat::packed) {
        coarse.guide = graph.create_texture("coarse guide", {width, height, VK_FORMAT_R32_UINT});
    }
    const shared::LodPickParams params{.fine_k = lod_ray_scale(view),
                                       .coarse_k = lod_ray_scale(coarse.view),
                                       .fine = {view.width, view.height},
                                       .coarse = {width, height},
                                       .least_albedo = options.fine_grained ? kLeastAlbedo : 0.0f};

    // Only what is wanted is attached: the last outputs may be missing.
    std::vector<TextureId> targets = {made.albedo, made.view_z, made.normal};
    for (const TextureId id : {made.object, coarse.guide}) {
        if (id.valid()) targets.push_back(id);
    }
    const auto execute = [fine, params, has_object, targets](PassContext& c) {
        gpu::PipelineDesc desc;
        desc.name = has_object ? "lod/pick with objects" : "lod/pick";
        desc.vertex = kLodPickVertex;
        desc.fragment = has_object ? std::span<const std::uint32_t>(kLodPickObject) : kLodPick;
        desc.bindings.assign(has_object ? 4 : 3, gpu::Binding::texture);
        desc.push_bytes = sizeof(params);
        std::vector<gpu::Target> attachments;
        for (const TextureId id : targets) {
            desc.color_formats.push_back(c.desc(id).format);
            attachments.push_back({.view = c.view(id)});
        }
        std::vector<gpu::Bound> inputs = {c.bound(fine.albedo), c.bound(fine.view_z),
                                          c.bound(fine.normal)};
        if (has_object) inputs.push_back(c.bound(fine.object));
        c.commands().begin_rendering({params.coarse.x, params.coarse.y}, attachments, nullptr);
        if (c.bind(desc, inputs)) {
            c.commands().constants(params);
            c.commands().draw(3);
        }
        c.commands().end_rendering();
    };
    graph.add_pass(
        "lod/pick", "lod",
        [&](PassBuilder& b) {
            for (const TextureId id : {fine.albedo, fine.view_z, fine.normal, fine.object}) {
                if (id.valid()) b.read(id, Use::fragment_read);
            }
            for (TextureId* id :
                 {&made.albedo, &made.view_z, &made.normal, &coarse.guide, &made.object}) {
                if (id->valid()) *id = b.write(*id, Use::color_attachment);
            }
        },
        execute);
    return coarse;
}

}  // namespace kino
