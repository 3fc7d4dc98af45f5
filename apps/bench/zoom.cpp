#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "apps/bench/registry.h"
#include "apps/bench/zoom_choosers.h"
#include "apps/bench/zoom_heads.h"
#include "viz/frame/renderer.h"
#include "viz/quality/edge_band.h"
#include "viz/quality/flip.h"
#include "viz/quality/image_metrics.h"
#include "viz/quality/zoom/zoom_choice.h"
#include "viz/quality/zoom/zoom_copy.h"
#include "viz/quality/zoom/zoom_view.h"
#include "viz/surface/mesh_shapes.h"

namespace kino {
namespace {

using bench::Candidate;
using bench::Comparison;

constexpr VkFormat kPixels = VK_FORMAT_R8G8B8A8_UNORM;

Image<std::uint32_t> striped(int width, int height) {
    Image<std::uint32_t> image(width, height);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            image.at(x, y) = 0xFF000000u + static_cast<std::uint32_t>(x * 977 ^ y * 3571);
        }
    }
    return image;
}

/// The host's copy alone, memory to memory.
void host_copies(BenchContext& context, int width, int height) {
    Image<std::uint32_t> out(width, height);
    for (int z = 1; z <= kMaxZoom; ++z) {
        const Image<std::uint32_t> small = striped((width + z - 1) / z, (height + z - 1) / z);
        std::vector<Candidate> ways;
        for (const auto& [blur, name] :
             {std::pair{ZoomBlur::none, "replicated"}, std::pair{ZoomBlur::box, "box"},
              std::pair{ZoomBlur::spline, "spline"}}) {
            ways.push_back({fmt::format("host, {}", name),
                            [&, z, b = blur] { enlarge(small.view(), z, b, out.view()); }});
            if (blur == ZoomBlur::spline) continue;
            ways.push_back({fmt::format("host without SIMD, {}", name), [&, z, b = blur] {
                                enlarge_portable(small.view(), z, b, out.view());
                            }});
        }
        const Comparison times = context.compare(fmt::format("host copies, z = {}", z), ways);
        for (const Candidate& way : ways) {
            context.add({.case_name = fmt::format("{}, memory to memory", way.name),
                         .knob = "z",
                         .level = std::to_string(z)},
                        Comparison({{std::to_string(z), times[way.name].ms}}));
        }
    }
}

/// A device, a small and a large picture on it.
class Enlargers {
  public:
    Enlargers(BenchContext& context, gpu::Device& device, int width, int height)
        : context_(context),
          device_(device),
          pipelines_(device),
          executor_(device, pipelines_),
          zoom_(device),
          width_(width),
          height_(height) {}

    bool measure() {
        // Large enough for whole blocks of every zoom: a blit cannot end within one.
        auto large = picture(width_ + kMaxZoom, height_ + kMaxZoom);
        auto shown = picture(width_, height_);
        if (!large || !shown) return false;
        double host_at_2 = 0, blit_at_2 = 0, fragment_at_2 = 0;
        for (int z = 2; z <= kMaxZoom; ++z) {
            auto small = picture((width_ + z - 1) / z, (height_ + z - 1) / z);
            if (!small) return false;
            std::vector<Candidate> ways = {
                {"host, replicated",
                 [&] { pass(*small, *shown, z, ZoomBlur::none, ZoomPath::host); }},
                {"host, box", [&] { pass(*small, *shown, z, ZoomBlur::box, ZoomPath::host); }},
                {"fragment, replicated",
                 [&] { pass(*small, *shown, z, ZoomBlur::none, ZoomPath::fragment); }},
                {"fragment, box",
                 [&] { pass(*small, *shown, z, ZoomBlur::box, ZoomPath::fragment); }},
                {"blit, nearest", [&] { blit(*small, *large, z, VK_FILTER_NEAREST); }},
                {"blit, linear", [&] { blit(*small, *large, z, VK_FILTER_LINEAR); }}};
            const Comparison times =
                context_.compare(fmt::format("on the device, z = {}", z), ways);
            for (const Candidate& way : ways) {
                context_.add({.case_name = fmt::format("{}, picture to picture", way.name),
                              .knob = "z",
                              .level = std::to_string(z)},
                             Comparison({{std::to_string(z), times[way.name].ms}}));
            }
            if (z == 2) {
                host_at_2 = times["host, replicated"].median_ms();
                fragment_at_2 = times["fragment, replicated"].median_ms();
                blit_at_2 = times["blit, nearest"].median_ms();
            }
        }
        context_.claim(
            fmt::format("z = 2: the host's copy takes {:.2f} ms, {:.0f} % of the blit's "
                        "{:.2f}, from picture to picture; the fragment pass takes {:.2f}",
                        host_at_2, 100 * host_at_2 / blit_at_2, blit_at_2, fragment_at_2),
            host_at_2 < 0.5 * blit_at_2 && host_at_2 < fragment_at_2);
        return true;
    }

  private:
    std::unique_ptr<gpu::Texture> picture(int width, int height) {
        auto made = gpu::Texture::create(
            device_, "bench",
            {static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height)}, kPixels);
        if (!made) {
            context_.fail(made.error());
            return nullptr;
        }
        const auto moved = device_.submit_and_wait([&](VkCommandBuffer commands) {
            gpu::Commands(device_, commands).to_general(made->image());
        });
        if (!moved) context_.fail(moved.error());
        return std::make_unique<gpu::Texture>(std::move(*made));
    }

    void pass(const gpu::Texture& small, const gpu::Texture& large, int z, ZoomBlur blur,
              ZoomPath path) {
        const auto import = [](graph::FrameGraph& graph, const char* name, const gpu::Texture& t) {
            return graph.import_texture(name, t.image(), t.view(),
                                        {t.extent().width, t.extent().height, t.format()});
        };
        graph::FrameGraph graph(executor_.history());
        const auto from = import(graph, "small", small);
        const auto to = import(graph, "large", large);
        const auto done =
            zoom_.add(graph, {.picture = from}, to, View{}, {.z = z, .blur = blur, .path = path});
        if (!done) return context_.fail(done.error());
        graph.require(*done);
        const auto ran = executor_.run(graph, graph::Timing::frame);
        if (!ran) context_.fail(ran.error());
    }

    void blit(const gpu::Texture& small, const gpu::Texture& large, int z, VkFilter filter) {
        const auto w = static_cast<std::int32_t>(small.extent().width);
        const auto h = static_cast<std::int32_t>(small.extent().height);
        const VkImageSubresourceLayers layer{.aspectMask = VK_IMAGE_ASPECT_COLOR_BIT,
                                             .layerCount = 1};
        const VkImageBlit region{.srcSubresource = layer,
                                 .srcOffsets = {{0, 0, 0}, {w, h, 1}},
                                 .dstSubresource = layer,
                                 .dstOffsets = {{0, 0, 0}, {w * z, h * z, 1}}};
        const auto ran = device_.submit_and_wait([&](VkCommandBuffer commands) {
            vkCmdBlitImage(commands, small.image(), VK_IMAGE_LAYOUT_GENERAL, large.image(),
                           VK_IMAGE_LAYOUT_GENERAL, 1, &region, filter);
        });
        if (!ran) context_.fail(ran.error());
    }

    BenchContext& context_;
    gpu::Device& device_;
    gpu::Pipelines pipelines_;
    graph::Executor executor_;
    ZoomPass zoom_;
    int width_, height_;
};

struct Case {
    std::string name;
    Scene scene;
    View view;
};

View front(int width, int height) {
    return {.width = width,
            .height = height,
            .projection = perspective(0.9, width, height),
            .world_from_view = look_at({0, 1.4, 3}, {0, 1, 0})};
}

void put(Scene& scene, std::shared_ptr<const MeshAsset> mesh, const glm::dvec3& at,
         std::uint32_t material) {
    MeshNode node{.id = static_cast<std::uint32_t>(scene.meshes.size() + 1),
                  .mesh = std::move(mesh),
                  .material = material};
    node.world_from_object[3] = glm::dvec4(at, 1);
    node.previous_world_from_object = node.world_from_object;
    scene.meshes.push_back(std::move(node));
}

/// Every pixel is lit by all of 48 lights.
Case pixel_bound(int width, int height) {
    Case made{.name = "pixel-bound", .scene = {}, .view = front(width, height)};
    Scene& s = made.scene;
    s.color_mode = ColorMode::relit;
    s.materials = {{.name = "wall", .base_color = glm::vec3(0.6f, 0.58f, 0.52f)},
                   {.name = "red", .base_color = glm::vec3(0.8f, 0.2f, 0.15f)},
                   {.name = "blue", .base_color = glm::vec3(0.15f, 0.25f, 0.8f)}};
    put(s, make_box({8, 0.1f, 8}), {0, -0.05, 0}, 1);
    put(s, make_box({8, 5, 0.1f}), {0, 2.5, -2.5}, 1);
    for (int i = 0; i < 24; ++i) {
        const glm::dvec3 at{0.5 * (i % 8) - 1.75, 0.3 + 0.55 * (i / 8), -0.6 * (i % 3)};
        if (i % 2 == 0) {
            put(s, make_box({0.2f, 0.4f, 0.2f}), at, 2);
        } else {
            put(s, make_sphere(0.2f), at, 3);
        }
    }
    for (int i = 0; i < 48; ++i) {
        s.lights.push_back({.kind = LightKind::point,
                            .position = {3.0 * std::sin(i * 2.4), 0.6 + 0.05 * i, 2 * std::cos(i)},
                            .color = glm::vec3(0.05f + 0.03f * static_cast<float>(i % 3), 0.08f,
                                               0.05f + 0.03f * static_cast<float>(i % 5)),
                            .radius_m = 30});
    }
    return made;
}

/// 150,000 triangles on a twentieth of the picture.
Case polygon_bound(int width, int height) {
    Case made{.name = "polygon-bound", .scene = {}, .view = front(width, height)};
    made.scene.color_mode = ColorMode::relit;
    made.scene.ambient = glm::vec3(0.3f);
    made.scene.materials = {{.name = "ball"}};
    put(made.scene, make_sphere(0.4f, 390, 195), {0, 1, 0}, 1);
    made.scene.lights = {{.kind = LightKind::directional, .direction = {0.3, -0.7, -0.6}}};
    return made;
}

/// Nothing but a background.
Case copy_bound(int width, int height) {
    return {.name = "copy-bound", .scene = {}, .view = front(width, height)};
}

class SceneBench {
  public:
    SceneBench(BenchContext& context, Renderer& renderer)
        : context_(context), renderer_(renderer) {}

    /// Whole frames at every zoom; their errors against z = 1.
    bool whole(const Case& in, bool errors) {
        const auto options = [](int z, ZoomBlur blur) {
            FrameOptions o;
            o.zoom = {.z = z, .blur = blur};
            return o;
        };
        std::vector<Candidate> ways;
        for (int z = 1; z <= kMaxZoom; ++z) {
            for (const ZoomBlur blur : {ZoomBlur::none, ZoomBlur::box}) {
                if (z == 1 && blur != ZoomBlur::none) continue;
                ways.push_back({name(z, blur), [this, &in, o = options(z, blur)] { show(in, o); }});
            }
        }
        const Comparison times = context_.compare(in.name, ways, {.repeats = 15});
        ms_.clear();
        for (int z = 1; z <= kMaxZoom; ++z) {
            ms_.push_back(times[name(z, ZoomBlur::none)].median_ms());
        }
        FrameOptions reading;
        reading.read_view_z = errors;
        const FrameResult truth = draw(in, reading);
        for (int z = 1; z <= kMaxZoom; ++z) {
            for (const ZoomBlur blur : {ZoomBlur::none, ZoomBlur::box}) {
                if (z == 1 && blur != ZoomBlur::none) continue;
                BenchRow row{.case_name = in.name + (blur == ZoomBlur::none ? "" : ", blurred"),
                             .knob = "z",
                             .level = std::to_string(z)};
                const Comparison own({{row.level, times[name(z, blur)].ms}});
                if (!errors || z == 1) {
                    context_.add(row, own);
                    continue;
                }
                const FrameResult drawn = draw(in, options(z, blur));
                if (!add_errors(row, own, truth, drawn.picture)) return false;
            }
        }
        return true;
    }

    /// The shading pass alone: its time times z^2 over that at z = 1.
    void pixel_stage(const Case& in) {
        std::vector<std::vector<double>> ms(kMaxZoom + 1);
        for (int round = -2; round < (context_.quick() ? 7 : 21); ++round) {
            for (int z = 1; z <= kMaxZoom; ++z) {
                FrameOptions o;
                o.zoom.z = z;
                o.timing = graph::Timing::every_pass;
                show(in, o);
                double shading = 0;
                for (const graph::GroupTime& g : renderer_.group_times()) {
                    if (g.group == "light/shade lists") shading += g.ms;
                }
                if (round >= 0) ms[static_cast<std::size_t>(z)].push_back(shading);
            }
        }
        const double at_one = bench::quantile(ms[1], 0.5);
        double worst = 0;
        for (int z = 1; z <= kMaxZoom; ++z) {
            const double own = bench::quantile(ms[static_cast<std::size_t>(z)], 0.5);
            const double ratio = own * z * z / at_one;
            if (z <= 4) worst = std::max(worst, std::abs(ratio - 1));
            context_.add({.case_name = in.name + ", shading pass",
                          .knob = "z",
                          .level = std::to_string(z),
                          .error = ratio,
                          .metric = "time times z^2, of z = 1"},
                         Comparison({{std::to_string(z), ms[static_cast<std::size_t>(z)]}}));
        }
        context_.claim(fmt::format("pixel-bound: shading goes with 1/z^2 within 10 % up to z = 4 "
                                   "(largest deviation {:.0f} %)",
                                   100 * worst),
                       worst <= 0.10);
    }

    /// Median times of the last whole() without blur, z = 1 first.
    [[nodiscard]] const std::vector<double>& ms() const { return ms_; }

  private:
    static std::string name(int z, ZoomBlur blur) {
        return fmt::format("z {}{}", z, blur == ZoomBlur::none ? "" : " blurred");
    }

    FrameResult draw(const Case& in, const FrameOptions& options) {
        auto frame = renderer_.render_to_image(in.scene, in.view, options);
        if (frame) return std::move(*frame);
        context_.fail(frame.error());
        return {};
    }

    /// Into a picture that stays on the device, as a window's.
    void show(const Case& in, const FrameOptions& options) {
        const VkExtent2D extent{static_cast<std::uint32_t>(in.view.width),
                                static_cast<std::uint32_t>(in.view.height)};
        if (target_.extent().width != extent.width || target_.extent().height != extent.height) {
            auto made = gpu::Texture::create(renderer_.device(), "bench picture", extent, kPixels);
            if (!made) return context_.fail(made.error());
            target_ = std::move(*made);
            const auto moved = renderer_.device().submit_and_wait([&](VkCommandBuffer commands) {
                gpu::Commands(renderer_.device(), commands).to_general(target_.image());
            });
            if (!moved) return context_.fail(moved.error());
        }
        const auto frame = renderer_.render(
            in.scene, in.view,
            {.image = target_.image(), .view = target_.view(), .extent = extent, .format = kPixels},
            options);
        if (!frame) context_.fail(frame.error());
    }

    bool add_errors(BenchRow row, const Comparison& times, const FrameResult& truth,
                    const Image<Rgba8>& picture) {
        const auto difference = compare_images(picture, truth.picture);
        const auto band =
            band_error(picture, truth.picture, depth_edge_band(truth.surface.view_z_m));
        const auto flip = flip_error(picture, truth.picture);
        if (!difference || !band || !flip) return false;
        for (const auto& [metric, error] :
             {std::pair{"dB PSNR", difference->psnr_db},
              std::pair{"MSE of the edge band", band->mse}, std::pair{"mean FLIP", flip->mean}}) {
            row.metric = metric;
            row.error = error;
            context_.add(row, times);
        }
        return true;
    }

    BenchContext& context_;
    Renderer& renderer_;
    gpu::Texture target_;
    std::vector<double> ms_;
};

/// R^2 of the best A + B / z^2 through times of z = 1, 2, ...
double fit_of_zoom(const std::vector<double>& ms) {
    double n = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0;
    for (std::size_t i = 0; i < ms.size(); ++i) {
        const double z = static_cast<double>(i + 1);
        const double u = 1 / (z * z);
        n += 1, x += u, y += ms[i], xx += u * u, xy += u * ms[i], yy += ms[i] * ms[i];
    }
    const double covariance = xy - x * y / n;
    return covariance * covariance / ((xx - x * x / n) * (yy - y * y / n));
}

void sync_curve(BenchContext& context) {
    for (const double ms : {5.0, 10.0, 16.0, 17.0, 20.0, 30.0, 33.0, 34.0, 45.0, 50.5, 60.0}) {
        const double shown = frame_interval_ms(ms, 60, FrameSync::fifo);
        context.add({.case_name = "shown at 60 Hz, fifo",
                     .knob = "frame takes, ms",
                     .level = fmt::format("{}", ms),
                     .error = shown / ms - 1,
                     .metric = "of the frame's time waited"});
    }
    context.claim("frames of 50.5 ms are shown every 66.7 ms by fifo at 60 Hz",
                  std::abs(frame_interval_ms(50.5, 60, FrameSync::fifo) - 200.0 / 3) < 1e-6);
}

}  // namespace

void bench_zoom(BenchContext& context) {
    const int width = context.quick() ? 640 : 1280;
    const int height = context.quick() ? 360 : 720;
    host_copies(context, width, height);
    auto device = gpu::Device::create({});
    if (!device) return context.fail(device.error());
    context.set_device((*device)->info().name + ", " + (*device)->info().driver);
    if (!Enlargers(context, **device, width, height).measure()) return;
    Renderer renderer(**device);
    SceneBench scenes(context, renderer);
    const Case pixels = pixel_bound(width, height);
    if (!scenes.whole(pixels, true)) return;
    const double fit = fit_of_zoom(scenes.ms());
    context.claim(fmt::format("pixel-bound: frame times are A + B / z^2 with R^2 = {:.4f}", fit),
                  fit > 0.99);
    scenes.pixel_stage(pixels);
    if (!scenes.whole(polygon_bound(width / 16, height / 16), true)) return;
    context.claim(fmt::format("polygon-bound: z = 8 still takes {:.2f} of z = 1",
                              scenes.ms()[7] / scenes.ms()[0]),
                  scenes.ms()[7] >= 0.8 * scenes.ms()[0]);
    if (!scenes.whole(copy_bound(width, height), false)) return;
    context.claim(fmt::format("copy-bound: z = 2 takes {:.2f} times as long as z = 1",
                              scenes.ms()[1] / scenes.ms()[0]),
                  scenes.ms()[1] > scenes.ms()[0]);
    bench_zoom_choosers(context, renderer);
    sync_curve(context);
    bench_zoom_heads(context);
    context.note(fmt::format(
        "Output {}x{} (polygon-bound: a sixteenth of it along each side). Copies from picture to "
        "picture are whole passes, from submit to fence: on the host that is a copy into mapped "
        "memory, the enlargement, and a copy into the picture. Errors are against z = 1.",
        width, height));
}

}  // namespace kino
