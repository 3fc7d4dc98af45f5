#include "viz/frame/renderer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <utility>

#include "base/check.h"
#include "viz/effects/skeleton/skeleton.h"
#include "viz/light/light_passes.h"
#include "viz/quality/lod_fix_shared.h"
#include "viz/quality/zoom/zoom_view.h"

namespace kino {
namespace {

using graph::BufferId;
using graph::FrameGraph;
using graph::PassBuilder;
using graph::PassContext;
using graph::TextureId;
using graph::Use;

/// Copies a rectangle of a texture to the front of a host-visible buffer.
void add_readback(FrameGraph& graph, const char* name, TextureId texture, VkOffset2D from,
                  VkExtent2D extent, const gpu::Buffer& into) {
    BufferId host = graph.import_buffer(name, into);
    const auto execute = [=](PassContext& c) {
        const VkBufferImageCopy region{
            .imageSubresource = {.aspectMask = VK_IMAGE_ASPECT_COLOR_BIT, .layerCount = 1},
            .imageOffset = {from.x, from.y, 0},
            .imageExtent = {extent.width, extent.height, 1}};
        vkCmdCopyImageToBuffer(c.commands().handle(), c.image(texture), VK_IMAGE_LAYOUT_GENERAL,
                               c.buffer(host), 1, &region);
    };
    graph.add_pass(
        name, "readback",
        [&](PassBuilder& b) {
            b.read(texture, Use::transfer_read);
            host = b.write(host, Use::transfer_write);
        },
        execute);
    graph.require(host);
}

Result<void> fit(gpu::Device& device, gpu::Buffer& buffer, const char* name, std::uint64_t bytes) {
    if (buffer.bytes() >= bytes) return {};
    buffer = gpu::Buffer();
    KINO_ASSIGN(buffer, gpu::Buffer::create(device, name, bytes, gpu::MemoryUse::readback));
    return {};
}

template <class T>
void copy_out(const gpu::Buffer& buffer, int width, int height, Image<T>& out) {
    out.resize(width, height);
    std::memcpy(out.data(), buffer.mapped(), out.size() * sizeof(T));
}

/// A picture without a live depth node: just the background.
TextureId add_background_only(FrameGraph& graph, const Scene& scene, TextureId target) {
    const glm::vec3 color = 0.5f * (scene.background_top + scene.background_bottom);
    graph.add_pass(
        "frame/background", "raster",
        [&](PassBuilder& b) { target = b.write(target, Use::color_attachment); },
        [id = target, color](PassContext& c) {
            const std::array<gpu::Target, 1> targets = {
                {{.view = c.view(id),
                  .clear = true,
                  .clear_value = {.color = {.float32 = {color.r, color.g, color.b, 1}}}}}};
            c.commands().begin_rendering({c.desc(id).width, c.desc(id).height}, targets, nullptr);
            c.commands().end_rendering();
        });
    return target;
}

}  // namespace

Renderer::Renderer(gpu::Device& device)
    : device_(device),
      pipelines_(device),
      executor_(device, pipelines_),
      rasterizer_(device),
      meshes_(device),
      bvh_(device),
      zoom_(device) {}

Renderer::~Renderer() {
    device_.wait_idle();
}

void Renderer::cut() {
    executor_.history().cut();
}

Result<FrameResult> Renderer::render(const Scene& scene, const View& shown,
                                     const PictureTarget& target, const FrameOptions& options) {
    KINO_CHECK(shown.width > 0 && shown.height > 0);
    KINO_CHECK_EQ(static_cast<std::uint32_t>(shown.width), target.extent.width);
    KINO_CHECK_EQ(static_cast<std::uint32_t>(shown.height), target.extent.height);
    ZoomOptions zoom = options.zoom;
    zoom.z = usable_zoom(zoom.z, shown.width, shown.height);
    const DeflectOptions* deflect = options.deflect ? &*options.deflect : nullptr;
    const bool zooms = zoom.z > 1 || deflect != nullptr;
    const int guard_px = deflect != nullptr ? (deflect->guard_px + zoom.z - 1) / zoom.z : 0;
    // What is drawn; the same as what is shown unless that is enlarged.
    const View view = zoomed_view(shown, zoom.z, guard_px);
    const auto width = static_cast<std::uint32_t>(view.width);
    const auto height = static_cast<std::uint32_t>(view.height);
    const bool live = scene.live.has_value() && scene.live->surface != nullptr;
    if (live) {
        KINO_TRY(rasterizer_.upload(*scene.live->surface));
    } else {
        rasterizer_.clear();
    }
    KINO_TRY(meshes_.upload(scene));
    if (wants_stage(scene) && wants_ray_shadows(scene)) {
        KINO_TRY(bvh_.upload(scene, {.live_columns = options.ray_shadows.live_columns}));
    } else {
        bvh_.clear();
    }

    FrameGraph graph(executor_.history());
    const TextureId full =
        graph.import_texture("picture", target.image, target.view,
                             {target.extent.width, target.extent.height, target.format});
    TextureId picture =
        zooms ? graph.create_texture("small picture", {width, height, target.format}) : full;
    const auto skeleton = skeleton_wanted(scene, view);
    const bool staged = wants_stage(scene);
    const bool wanted = live && !staged && wants_light(scene);
    const bool lit = wanted && options.light_rate == LightRate::picture_pixel;
    const bool lit_points = wanted && options.light_rate == LightRate::depth_pixel;
    const bool has_surface = live || staged;
    const bool probing = has_surface && options.probe_px.has_value() && options.probe_px->x >= 0 &&
                         options.probe_px->y >= 0 && options.probe_px->x < shown.width &&
                         options.probe_px->y < shown.height;
    SurfaceTargets surface;
    BufferId fix_state;
    if (staged) {
        const Stage stage = add_stage(graph, scene, view, {rasterizer_, meshes_, bvh_},
                                      {.raster = options.raster,
                                       .lists = options.light_lists,
                                       .shadows = options.ray_shadows,
                                       .bounces = options.bounces,
                                       .lod = options.lod,
                                       .rates = options.part_rates,
                                       .regions = options.regions,
                                       .finish = LodFinish{.target = picture,
                                                           .exposure = scene.exposure,
                                                           .tone_map = wants_tone_map(scene)},
                                       .read_ids = options.read_surface,
                                       .samples = options.samples,
                                       .resolve = options.resolve,
                                       .edge_share = options.edge_share});
        surface = stage.surface;
        fix_state = stage.fixed.state;
        picture = stage.picture.valid()
                      ? stage.picture
                      : add_final_pass(graph, scene, stage.linear, picture, stage.emitting);
    } else if (live) {
        // Without light the surface's colour is the picture, so it is drawn straight into it.
        surface.albedo =
            lit ? graph.create_texture("albedo", {width, height, VK_FORMAT_R8G8B8A8_UNORM})
                : picture;
        if (lit || skeleton || probing || options.read_surface || options.read_view_z ||
            deflect != nullptr) {
            surface.view_z = graph.create_texture("view depth", {width, height, kViewZFormat});
        }
        if (lit || options.read_surface) {
            surface.normal = graph.create_texture("normal", {width, height, kNormalFormat});
        }
        if (options.read_surface) {
            surface.id = graph.create_texture("id", {width, height, kIdFormat});
        }
        surface =
            rasterizer_.add(graph, *scene.live, view, options.raster, surface,
                            pack_srgb(scene.background_top), pack_srgb(scene.background_bottom),
                            lit_points ? Recolor([&](FrameGraph& g, const auto& inputs) {
                                return add_point_light_pass(g, scene, view, inputs);
                            })
                                       : Recolor());
        if (lit) {
            const TextureId linear = add_light_pass(graph, scene, view, surface);
            picture = add_final_pass(graph, scene, linear, picture);
        } else {
            picture = surface.albedo;
        }
    } else {
        picture = add_background_only(graph, scene, picture);
        if (skeleton) {
            surface.view_z = graph.create_texture("view depth", {width, height, kViewZFormat});
            graph.add_pass(
                "frame/empty depth", "raster",
                [&](PassBuilder& b) {
                    surface.view_z = b.write(surface.view_z, Use::color_attachment);
                },
                [id = surface.view_z](PassContext& c) {
                    const std::array<gpu::Target, 1> targets = {
                        {{.view = c.view(id), .clear = true}}};
                    c.commands().begin_rendering({c.desc(id).width, c.desc(id).height}, targets,
                                                 nullptr);
                    c.commands().end_rendering();
                });
        }
    }
    if (skeleton) picture = add_skeleton(graph, view, picture, surface.view_z, *skeleton);
    if (zooms) {
        KINO_ASSIGN(
            picture,
            zoom_.add(
                graph,
                {.picture = picture, .view = view, .view_z = surface.view_z, .guard_px = guard_px},
                full, shown, zoom, deflect));
    } else {
        zoom_.clear();
    }
    if (options.overlay) picture = options.overlay(graph, picture);
    graph.require(picture);

    const VkExtent2D drawn{width, height};
    const std::uint64_t pixels = std::uint64_t{width} * height;
    if (options.read_picture) {
        KINO_TRY(fit(device_, picture_readback_, "picture readback",
                     std::uint64_t{target.extent.width} * target.extent.height * 4));
        add_readback(graph, "frame/read picture", picture, {}, target.extent, picture_readback_);
    }
    if ((options.read_surface || options.read_view_z) && has_surface) {
        KINO_TRY(fit(device_, view_z_readback_, "view depth readback", pixels * 4));
        add_readback(graph, "frame/read depth", surface.view_z, {}, drawn, view_z_readback_);
    }
    if (options.read_surface && has_surface) {
        KINO_TRY(fit(device_, id_readback_, "id readback", pixels * 4));
        add_readback(graph, "frame/read id", surface.id, {}, drawn, id_readback_);
        KINO_TRY(fit(device_, normal_readback_, "normal readback", pixels * 4));
        add_readback(graph, "frame/read normal", surface.normal, {}, drawn, normal_readback_);
    }
    if (probing) {
        KINO_TRY(fit(device_, probe_readback_, "probe", 16));
        add_readback(
            graph, "frame/probe", surface.view_z,
            {options.probe_px->x / zoom.z + guard_px, options.probe_px->y / zoom.z + guard_px},
            {1, 1}, probe_readback_);
    }
    const bool counting = options.count_fixed && fix_state.valid();
    if (counting) {
        KINO_TRY(fit(device_, fixed_readback_, "fixed pixels", sizeof(shared::LodFixState)));
        BufferId host = graph.import_buffer("frame/read fixed", fixed_readback_);
        graph.add_pass(
            "frame/read fixed", "readback",
            [&](PassBuilder& b) {
                b.read(fix_state, Use::transfer_read);
                host = b.write(host, Use::transfer_write);
            },
            [fix_state, host](PassContext& c) {
                const VkBufferCopy region{.size = sizeof(shared::LodFixState)};
                vkCmdCopyBuffer(c.commands().handle(), c.buffer(fix_state), c.buffer(host), 1,
                                &region);
            });
        graph.require(host);
    }
    if (keep_graphviz_) graphviz_ = graph.to_graphviz();

    FrameResult result;
    KINO_ASSIGN(result.report, executor_.run(graph, options.timing));
    result.ms = to_ms(result.report.submit_to_fence);
    if (options.read_picture) {
        copy_out(picture_readback_, shown.width, shown.height, result.picture);
        if (target.format == VK_FORMAT_B8G8R8A8_UNORM) {
            for (Rgba8& pixel : result.picture.pixels()) std::swap(pixel.r, pixel.b);
        }
        for (Rgba8& pixel : result.picture.pixels()) pixel.a = 255;
    }
    if ((options.read_surface || options.read_view_z) && has_surface) {
        copy_out(view_z_readback_, view.width, view.height, result.surface.view_z_m);
    }
    if (options.read_surface && has_surface) {
        copy_out(id_readback_, view.width, view.height, result.surface.id);
        copy_out(normal_readback_, view.width, view.height, result.surface.normal);
    }
    if (probing) {
        const float z = probe_readback_.read<float>()[0];
        if (z > 0) result.depth_at_m = z;
    }
    if (counting) {
        const auto state = fixed_readback_.read<shared::LodFixState>()[0];
        result.fixed = FixedPixels{.failed = state.failed, .shaded = state.count};
    }
    return result;
}

Result<FrameResult> Renderer::render_to_image(const Scene& scene, const View& view,
                                              const FrameOptions& options) {
    const VkExtent2D extent{static_cast<std::uint32_t>(view.width),
                            static_cast<std::uint32_t>(view.height)};
    if (own_target_.extent().width != extent.width ||
        own_target_.extent().height != extent.height) {
        own_target_ = gpu::Texture();
        KINO_ASSIGN(own_target_,
                    gpu::Texture::create(device_, "own picture", extent, VK_FORMAT_R8G8B8A8_UNORM));
        const auto moved = device_.submit_and_wait([&](VkCommandBuffer commands) {
            gpu::Commands(device_, commands).to_general(own_target_.image());
        });
        if (!moved) return fail(moved.error());
    }
    FrameOptions reading = options;
    reading.read_picture = true;
    return render(scene, view,
                  {.image = own_target_.image(),
                   .view = own_target_.view(),
                   .extent = extent,
                   .format = own_target_.format()},
                  reading);
}

}  // namespace kino
