#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "apps/bench/reference_cache.h"
#include "apps/bench/registry.h"
#include "tests/scenes/depth_scene.h"
#include "tests/scenes/raster_scenes.h"
#include "viz/frame/renderer.h"

namespace kino {
namespace {

using bench::Comparison;
using bench::Timing;
using test::NamedView;

constexpr int kWidth = 1280;
constexpr int kHeight = 720;

/// The office with its holes filled along the rows, so that all 307,200 points exist; every
/// `stride`-th pixel of it.
LiveDepth filled_office(const test::RecordedScene& recorded, int stride) {
    const DepthSurface& full = *recorded.scene.live->surface;
    auto surface = std::make_shared<DepthSurface>();
    const int width = full.depth_m.width() / stride;
    const int height = full.depth_m.height() / stride;
    surface->depth_m.resize(width, height);
    surface->color.resize(width, height);
    auto rays = std::make_shared<Image<RayXy>>(width, height);
    for (int y = 0; y < height; ++y) {
        float last = 3.0f;
        Rgba8 last_color{128, 128, 128, 255};
        for (int x = 0; x < width; ++x) {
            const float z = full.depth_m.at(x * stride, y * stride);
            if (z > 0) last = z;
            surface->depth_m.at(x, y) = last;
            // Everything has a colour, too, so that colours can be compared everywhere.
            const Rgba8 color = full.color.at(x * stride, y * stride);
            if (color.a != 0) last_color = color;
            surface->color.at(x, y) = last_color;
            rays->at(x, y) = full.rays->at(x * stride, y * stride);
        }
    }
    surface->rays = rays;
    surface->focal_px = full.focal_px / stride;
    surface->version = test::next_version();
    LiveDepth live = *recorded.scene.live;
    live.surface = surface;
    live.fill_holes = false;
    return live;
}

struct Drawn {
    double raster_ms = 0;
    double total_ms = 0;
};

class RasterBench {
  public:
    RasterBench(BenchContext& context, Renderer& renderer)
        : context_(context), renderer_(renderer) {}

    Drawn draw(const LiveDepth& live, const View& view, RasterPath path) {
        Scene scene;
        scene.live = live;
        FrameOptions options;
        options.raster = path;
        options.timing = graph::Timing::every_group;
        const auto frame = renderer_.render_to_image(scene, view, options);
        if (!frame) {
            context_.fail(frame.error());
            return {};
        }
        Drawn drawn;
        for (const graph::GroupTime& group : renderer_.group_times()) {
            if (group.group == "raster") drawn.raster_ms = group.ms;
            if (group.group == "raster" || group.group == "resolve") drawn.total_ms += group.ms;
        }
        return drawn;
    }

    FrameResult draw_to_compare(const LiveDepth& live, const View& view, RasterPath path) {
        Scene scene;
        scene.live = live;
        FrameOptions options;
        options.raster = path;
        options.read_view_z = true;  // drawn as for the screen
        auto frame = renderer_.render_to_image(scene, view, options);
        if (!frame) {
            context_.fail(frame.error());
            return {};
        }
        return std::move(*frame);
    }

    /// The double rasteriser's picture.
    Image<reference::RasterSample> reference_picture(const LiveDepth& live, const View& view) {
        bench::ReferenceKey key("raster", bench::program_version());
        const DepthSurface& surface = *live.surface;
        key.add(surface.depth_m).add(surface.color).add(surface.focal_px);
        key.add(surface.rays->pixels());
        for (const Pose& pose : {live.world_from_depth, view.world_from_view}) {
            key.add(pose.rotation).add(pose.translation);
        }
        key.add(live.style).add(live.edge_rule).add(live.splat_cap_px).add(live.fill_holes);
        key.add(view.width).add(view.height).add(view.projection);
        auto picture = context_.references.image<reference::RasterSample>(
            key, [&] { return test::reference_picture(live, view); });
        if (!picture) context_.fail(picture.error());
        return picture ? std::move(*picture) : Image<reference::RasterSample>();
    }

    /// All paths of one style in one view, interleaved; rows with their agreement.
    void paths(const LiveDepth& live, const NamedView& named) {
        const bool mesh = live.style == DepthStyle::mesh;
        const std::string what = fmt::format("{} {}", named.name, mesh ? "mesh" : "cloud");
        context_.progress(what);
        const std::string hardware = mesh ? "geometry shader" : "POINT_LIST";
        const std::string compute = mesh ? "compute mesh" : "compute splat";
        std::vector<Timing> timings = {{compute + " without resolve", {}},
                                       {compute, {}},
                                       {compute + ", 32-bit keys", {}},
                                       {hardware, {}}};
        const int rounds = context_.quick() ? 5 : 21;
        for (int round = -2; round < rounds; ++round) {
            const Drawn a = draw(live, named.view, RasterPath::compute);
            const Drawn b = draw(live, named.view, RasterPath::compute_32bit);
            const Drawn c = draw(live, named.view, RasterPath::hardware);
            if (round < 0) continue;  // pipelines compile at first use
            timings[0].ms.push_back(a.raster_ms);
            timings[1].ms.push_back(a.total_ms);
            timings[2].ms.push_back(b.total_ms);
            timings[3].ms.push_back(c.total_ms);
        }
        const Comparison comparison(timings);
        const auto reference = reference_picture(live, named.view);
        const auto row = [&](const std::string& level, RasterPath path, bool agreement) {
            BenchRow out{.case_name = what, .knob = "path", .level = level, .baseline = hardware};
            if (agreement) {
                const test::Agreement found = test::compare_with_reference(
                    draw_to_compare(live, named.view, path), reference);
                out.error = 1 - found.share();
                out.metric = "share of pixels off";
                if (path == RasterPath::compute) {
                    context_.claim(fmt::format("{}: {} agrees with the double rasteriser on "
                                               "99.5 % of the union, coverage at least 98 %",
                                               what, level),
                                   found.share() >= 0.995 && found.coverage() >= 0.98);
                }
            }
            context_.add(out, comparison);
        };
        row(timings[0].name, RasterPath::compute, false);
        row(timings[1].name, RasterPath::compute, true);
        row(timings[2].name, RasterPath::compute_32bit, true);
        row(timings[3].name, RasterPath::hardware, true);
        const double bare = comparison.speedup(timings[0].name, hardware);
        const double whole = comparison.speedup(compute, hardware);
        if (mesh) {
            context_.claim(fmt::format("{}: {:.1f}x the geometry-shader path", what, whole),
                           whole >= 6);
        } else {
            context_.claim(fmt::format("{}: {:.1f}x POINT_LIST with its clear, {:.1f}x with the "
                                       "resolve",
                                       what, bare, whole),
                           bare >= 10 && whole >= 6);
        }
    }

    /// Coarser depth grids against the full one: what the error buys in time.
    void resolutions(const test::RecordedScene& recorded, const View& view) {
        LiveDepth full = filled_office(recorded, 1);
        full.style = DepthStyle::mesh;
        const auto reference = reference_picture(full, view);
        std::vector<LiveDepth> levels;
        std::vector<Timing> timings;
        for (const int stride : {1, 2, 4, 8}) {
            levels.push_back(filled_office(recorded, stride));
            levels.back().style = DepthStyle::mesh;
            timings.push_back({fmt::format("{}x{}", 640 / stride, 480 / stride), {}});
        }
        for (int round = -2; round < (context_.quick() ? 5 : 21); ++round) {
            for (std::size_t i = 0; i < levels.size(); ++i) {
                const double ms = draw(levels[i], view, RasterPath::compute).total_ms;
                if (round >= 0) timings[i].ms.push_back(ms);
            }
        }
        const Comparison comparison(timings);
        for (std::size_t i = 0; i < levels.size(); ++i) {
            const FrameResult frame = draw_to_compare(levels[i], view, RasterPath::compute);
            double sum = 0;
            std::int64_t count = 0;
            for (int y = 0; y < reference.height(); ++y) {
                for (int x = 0; x < reference.width(); ++x) {
                    if (!reference.at(x, y).covered()) continue;
                    const double z = frame.surface.view_z_m.at(x, y);
                    // A pixel left empty counts as far off, else holes would look accurate.
                    sum += z > 0 ? std::min(1000 * std::abs(z - reference.at(x, y).depth_m), 100.0)
                                 : 100.0;
                    ++count;
                }
            }
            context_.add({.case_name = "orbit mesh",
                          .knob = "depth resolution",
                          .level = timings[i].name,
                          .error = sum / static_cast<double>(count),
                          .metric = "mm mean, empty = 100",
                          .baseline = timings[0].name},
                         comparison);
        }
    }

    struct CloudLevel {
        std::string name;
        int splat_cap_px = 1;
        bool fill_holes = true;
    };
    /// How much of the surface that the mesh would show a cloud leaves empty.
    void cloud_levels(const LiveDepth& cloud, const NamedView& named, const std::string& knob,
                      const std::vector<CloudLevel>& levels) {
        LiveDepth mesh = cloud;
        mesh.style = DepthStyle::mesh;
        const auto reference = reference_picture(mesh, named.view);
        std::vector<Timing> timings;
        for (const CloudLevel& level : levels) timings.push_back({level.name, {}});
        LiveDepth live = cloud;
        const auto turn = [&](const CloudLevel& level) {
            live.splat_cap_px = level.splat_cap_px;
            live.fill_holes = level.fill_holes;
        };
        for (int round = -2; round < (context_.quick() ? 5 : 21); ++round) {
            for (std::size_t i = 0; i < levels.size(); ++i) {
                turn(levels[i]);
                const double ms = draw(live, named.view, RasterPath::compute).total_ms;
                if (round >= 0) timings[i].ms.push_back(ms);
            }
        }
        const Comparison comparison(timings);
        for (const CloudLevel& level : levels) {
            turn(level);
            const FrameResult frame = draw_to_compare(live, named.view, RasterPath::compute);
            std::int64_t missing = 0;
            std::int64_t count = 0;
            for (std::size_t p = 0; p < reference.size(); ++p) {
                if (!reference.pixels()[p].covered()) continue;
                ++count;
                missing += !(frame.surface.view_z_m.pixels()[p] > 0);
            }
            context_.add({.case_name = named.name + " cloud",
                          .knob = knob,
                          .level = level.name,
                          .error = static_cast<double>(missing) / static_cast<double>(count),
                          .metric = "share of the mesh left empty",
                          .baseline = levels[0].name},
                         comparison);
        }
    }

    /// Light once a depth pixel against once a picture pixel.
    void light_rates(LiveDepth live, const View& view) {
        live.style = DepthStyle::mesh;
        Scene scene;
        scene.live = live;
        scene.color_mode = ColorMode::relit;
        scene.lights = {{.kind = LightKind::directional, .direction = {0.3, -0.7, -0.6}},
                        {.kind = LightKind::point, .position = {0.5, 0.5, -1.5}}};
        std::vector<bench::Candidate> candidates;
        std::vector<Image<Rgba8>> pictures;
        for (const auto& [name, rate] : {std::pair{"picture pixel", LightRate::picture_pixel},
                                         std::pair{"depth pixel", LightRate::depth_pixel}}) {
            candidates.push_back({name, [this, &scene, &view, r = rate] {
                                      if (!render_in_place(scene, view, {.light_rate = r})) return;
                                  }});
            auto frame = renderer_.render_to_image(scene, view, {.light_rate = rate});
            if (!frame) return context_.fail(frame.error());
            pictures.push_back(std::move(frame->picture));
        }
        const Comparison comparison = context_.compare("light rates", candidates);
        for (std::size_t i = 0; i < pictures.size(); ++i) {
            double sum = 0;
            for (std::size_t p = 0; p < pictures[i].size(); ++p) {
                const Rgba8 a = pictures[i].pixels()[p];
                const Rgba8 b = pictures[0].pixels()[p];
                sum += std::abs(a.r - b.r) + std::abs(a.g - b.g) + std::abs(a.b - b.b);
            }
            context_.add({.case_name = "orbit mesh, two lights",
                          .knob = "light rate",
                          .level = candidates[i].name,
                          .error = sum / 3 / static_cast<double>(pictures[i].size()),
                          .metric = "mean difference of 255",
                          .baseline = candidates[0].name},
                         comparison);
        }
    }

    /// Whether the parts that the overlay shows sum to the whole: each group with a submit of its
    /// own against the frame in one submit.
    void parts_and_whole(LiveDepth live, const View& view) {
        live.style = DepthStyle::mesh;
        Scene scene;
        scene.live = live;
        scene.color_mode = ColorMode::relit;
        scene.lights = {{.kind = LightKind::directional, .direction = {0.3, -0.7, -0.6}}};
        std::vector<Timing> timings = {{"one submit", {}}, {"sum of the groups", {}}};
        for (int round = -2; round < (context_.quick() ? 5 : 31); ++round) {
            for (const bool parts : {false, true}) {
                const auto frame = render_in_place(
                    scene, view,
                    {.timing = parts ? graph::Timing::every_group : graph::Timing::frame});
                if (!frame) return context_.fail(frame.error());
                if (round >= 0) timings[parts ? 1 : 0].ms.push_back(frame->ms);
            }
        }
        const Comparison comparison(timings);
        for (const Timing& timing : timings) {
            context_.add({.case_name = "orbit mesh, relit",
                          .knob = "timing",
                          .level = timing.name,
                          .baseline = "one submit"},
                         comparison);
        }
        const double ratio = comparison.speedup("sum of the groups", "one submit");
        context_.claim(
            fmt::format("the groups' times sum to the frame's within 10 % (ratio {:.3f})",
                        1 / ratio),
            ratio > 1 / 1.1 && ratio < 1.1);
    }

    /// New points uploaded, drawn, lit where asked, composed: what a viewer spends a frame on.
    void whole_frames(const LiveDepth& live, const View& view) {
        struct Kind {
            const char* name;
            DepthStyle style;
            ColorMode mode;
        };
        const std::vector<Kind> kinds = {
            {"cloud, captured", DepthStyle::cloud, ColorMode::captured},
            {"mesh, captured", DepthStyle::mesh, ColorMode::captured},
            {"cloud, relit", DepthStyle::cloud, ColorMode::relit},
            {"mesh, relit", DepthStyle::mesh, ColorMode::relit}};
        std::vector<bench::Candidate> candidates;
        candidates.reserve(kinds.size());
        auto surface = std::make_shared<DepthSurface>(*live.surface);
        for (const Kind& kind : kinds) {
            candidates.push_back({kind.name, [this, kind, surface, &live, &view] {
                                      surface->version = test::next_version();
                                      Scene scene;
                                      scene.live = live;
                                      scene.live->surface = surface;
                                      scene.live->style = kind.style;
                                      scene.color_mode = kind.mode;
                                      scene.lights = {{.kind = LightKind::directional,
                                                       .direction = {0.3, -0.7, -0.6}}};
                                      // Into a picture that stays on the device, as a window's.
                                      if (const auto frame = render_in_place(scene, view); !frame) {
                                          context_.fail(frame.error());
                                      }
                                  }});
        }
        const Comparison comparison = context_.compare("whole frames", candidates);
        for (const Kind& kind : kinds) {
            context_.add({.case_name = "whole frame, new points",
                          .knob = "what is drawn",
                          .level = kind.name},
                         comparison);
        }
    }

  private:
    Result<FrameResult> render_in_place(const Scene& scene, const View& view,
                                        const FrameOptions& options = {}) {
        const VkExtent2D extent{static_cast<std::uint32_t>(view.width),
                                static_cast<std::uint32_t>(view.height)};
        if (target_.empty()) {
            KINO_ASSIGN(target_, gpu::Texture::create(renderer_.device(), "bench picture", extent,
                                                      VK_FORMAT_B8G8R8A8_UNORM));
            const auto moved = renderer_.device().submit_and_wait([&](VkCommandBuffer commands) {
                gpu::Commands(renderer_.device(), commands).to_general(target_.image());
            });
            if (!moved) return bench_error(moved.error());
        }
        return renderer_.render(scene, view,
                                {.image = target_.image(),
                                 .view = target_.view(),
                                 .extent = extent,
                                 .format = target_.format()},
                                options);
    }
    static tl::unexpected<Error> bench_error(const Error& error) {
        return tl::unexpected<Error>(error);
    }

    BenchContext& context_;
    Renderer& renderer_;
    gpu::Texture target_;
};

}  // namespace

void bench_raster(BenchContext& context) {
    auto recorded = test::load_recording("recordings/office");
    if (!recorded) return context.fail(recorded.error());
    auto device = gpu::Device::create({});
    if (!device) return context.fail(device.error());
    context.set_device((*device)->info().name + ", " + (*device)->info().driver);
    Renderer renderer(**device);
    RasterBench bench(context, renderer);
    LiveDepth live = filled_office(*recorded, 1);
    const std::vector<NamedView> views =
        test::standard_views(live, recorded->rig.depth, kWidth, kHeight);
    for (const DepthStyle style : {DepthStyle::cloud, DepthStyle::mesh}) {
        live.style = style;
        for (const NamedView& named : views) {
            if (context.quick() && named.name != "orbit") continue;
            bench.paths(live, named);
        }
    }
    bench.resolutions(*recorded, views[1].view);
    live.style = DepthStyle::cloud;
    bench.cloud_levels(live, views[2], "splat cap",
                       {{"1 px", 1}, {"2 px", 2}, {"3 px", 3}, {"4 px", 4}, {"8 px", 8}});
    bench.cloud_levels(live, views[0], "hole filling", {{"off", 1, false}, {"on", 1, true}});
    bench.light_rates(live, views[1].view);
    bench.parts_and_whole(live, views[1].view);
    bench.whole_frames(live, views[1].view);
    context.note(
        "307,200 points (the office with its holes filled), 1280x720, time from submit to fence. "
        "Sensor, orbit, close-up (25 cm before the nearest thing ahead) and inside (25 cm behind "
        "it). Hardware paths draw colour and depth; compute paths end with the same targets.");
}

}  // namespace kino
