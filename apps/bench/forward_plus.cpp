#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>

#include "apps/bench/forward_samples.h"
#include "apps/bench/registry.h"
#include "tests/viz/lights/light_baselines.h"
#include "tests/viz/lights/light_rig.h"
#include "tests/viz/lights/light_scenes.h"

namespace kino {
namespace {

using bench::Comparison;
using bench::Timing;
using test::LightRig;
using test::LitScene;

constexpr std::uint32_t kRoom = 1024;  // no list is cut off in what is compared

struct PartTimes {
    Timing cull, shade, total;
};

/// Lights that pixels walk, by tile and on average over the picture.
double listed_per_pixel(const LightRig::Drawn& drawn, const View& view) {
    double sum = 0;
    for (std::uint32_t y = 0; y < drawn.lists.tiles_y; ++y) {
        for (std::uint32_t x = 0; x < drawn.lists.tiles_x; ++x) {
            const auto px = static_cast<int>(drawn.lists.tile_px);
            const int wide = std::min(px, view.width - static_cast<int>(x) * px);
            const int high = std::min(px, view.height - static_cast<int>(y) * px);
            sum += 1.0 * drawn.headers[2 * (y * drawn.lists.tiles_x + x) + 1] * wide * high;
        }
    }
    return sum / view.width / view.height;
}

/// Root of the mean squared difference of linear values, of 255ths.
double rmse_255(const Image<glm::vec4>& a, const Image<glm::vec4>& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        for (int k = 0; k < 3; ++k) {
            const double off =
                std::clamp(a.pixels()[i][k], 0.0f, 1.0f) - std::clamp(b.pixels()[i][k], 0.0f, 1.0f);
            sum += off * off;
        }
    }
    return 255 * std::sqrt(sum / (3.0 * static_cast<double>(a.size())));
}

/// Lights that a pixel needs, in the mean over the picture, by the double reference.
double needed_per_pixel(BenchContext& context, const LitScene& lit, int step) {
    bench::ReferenceKey key("needed-lights", bench::program_version());
    key.add(lit.view.width).add(lit.view.height).add(step).add(lit.surface.view_z_m);
    for (const Light& light : lit.scene.lights) key.add(light.position).add(light.radius_m);
    const auto mean = context.references.values<double>(key, [&] {
        return std::vector<double>{
            reference::exact_lists(lit.scene, lit.view, lit.surface.view_z_m, 8, step)
                .mean_per_pixel};
    });
    return mean ? mean->front() : bench::kNotMeasured;
}

class LightBench {
  public:
    LightBench(BenchContext& context, gpu::Device& device) : context_(context), rig_(device) {}

    struct Way {
        std::string name;
        LightRig::Options options;
    };

    /// Times of all ways from the same rounds.
    std::vector<PartTimes> measure(const LitScene& lit, const std::vector<Way>& ways, int rounds) {
        std::vector<PartTimes> times(ways.size());
        for (std::size_t i = 0; i < ways.size(); ++i) {
            times[i].cull.name = times[i].shade.name = times[i].total.name = ways[i].name;
        }
        for (int round = context_.quick() ? -1 : -2; round < rounds; ++round) {
            for (std::size_t i = 0; i < ways.size(); ++i) {
                LightRig::Options options = ways[i].options;
                options.read = false;
                options.statistics = false;
                options.timing = graph::Timing::every_group;
                const auto begun = std::chrono::steady_clock::now();
                const auto drawn = rig_.draw(lit.scene, lit.view, options);
                if (!drawn) {
                    context_.fail(drawn.error());
                    return times;
                }
                const double all =
                    1e3 *
                    std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
                if (round < 0) continue;  // pipelines compile at first use
                // What is no device time is the host's share: packing, and lists that it makes.
                const double light = drawn->ms("light");
                times[i].cull.ms.push_back(all - light);
                times[i].shade.ms.push_back(light);
                times[i].total.ms.push_back(all);
            }
        }
        return times;
    }

    LightRig::Drawn look(const LitScene& lit, const LightRig::Options& options) {
        auto drawn = rig_.draw(lit.scene, lit.view, options);
        if (!drawn) context_.fail(drawn.error());
        return drawn ? std::move(*drawn) : LightRig::Drawn{};
    }

    void show(const LitScene& lit) {
        if (const auto shown = rig_.set_surface(lit.surface); !shown) context_.fail(shown.error());
    }

    void add_row(const std::string& scene, const std::string& knob, const PartTimes& times,
                 double error, const std::string& metric) {
        for (const auto& [part, timing] :
             {std::pair{"cull", &times.cull}, {"shade", &times.shade}, {"total", &times.total}}) {
            const bool total = timing == &times.total;
            context_.add({.case_name = fmt::format("{}, {}", scene, part),
                          .knob = knob,
                          .level = timing->name,
                          .ms_median = timing->median_ms(),
                          .ms_p95 = timing->p95_ms(),
                          .error = total ? error : bench::kNotMeasured,
                          .metric = total ? metric : ""});
        }
    }

    BenchContext& context() { return context_; }

  private:
    BenchContext& context_;
    LightRig rig_;
};

LightRig::Options with_lists(LightListOptions lists) {
    lists.capacity = kRoom;
    return {.lists = lists};
}

/// The source's scene: Forward+ against its rivals.
void rivals(LightBench& bench, int width, int height, int lights) {
    BenchContext& context = bench.context();
    const LitScene lit = test::source_scene(width, height, lights, 25);
    bench.show(lit);
    const double needed = needed_per_pixel(context, lit, context.quick() ? 4 : 2);
    context.note(
        fmt::format("The source's scene: {} lights of radius {:.2f} m in a hall of 16 x 6 "
                    "x 28 m, {}x{}; a pixel needs {:.1f} of them (double reference).",
                    lights, lit.scene.lights[0].radius_m, width, height, needed));
    context.claim("a pixel of the source's scene needs 25 +- 3 lights", std::abs(needed - 25) <= 3);
    std::vector<LightBench::Way> ways = {
        {"Forward+ 16 px", with_lists({.tile_px = 16, .cells = DepthCells::none})},
        {"Forward+ 16 px 2.5D", with_lists({.tile_px = 16})},
        {"Forward+ 8 px", with_lists({.tile_px = 8, .cells = DepthCells::none})},
        {"Forward+ 8 px 2.5D", with_lists({.tile_px = 8})},
        {"Forward+ 8 px 2.5D, one level", with_lists({.tile_px = 8, .two_level = false})},
        {"compute deferred", {}},
        {"clustered", {}},
        {"lists by the host", {}},
        {"lists by the host, tree", {}},
    };
    using graph::FrameGraph;
    const auto shaded = [&lit](FrameGraph& g, const SurfaceTargets& s, const LightLists& lists) {
        return add_shade_pass(g, lit.scene, lit.view,
                              {.surface = s, .lists = lists, .shadow_masks = {}});
    };
    ways[5].options.instead = [&](FrameGraph& g, const LightLists&, const SurfaceTargets& s) {
        return test::add_deferred(g, lit.scene, lit.view, s);
    };
    ways[6].options.instead = [&](FrameGraph& g, const LightLists&, const SurfaceTargets& s) {
        return test::add_clustered(g, lit.scene, lit.view, s);
    };
    ways[7].options.instead = [&](FrameGraph& g, const LightLists&, const SurfaceTargets& s) {
        return shaded(g, s, add_host_light_lists(g, lit.scene, lit.view, 16));
    };
    ways[8].options.instead = [&](FrameGraph& g, const LightLists&, const SurfaceTargets& s) {
        PackedLights packed = pack_lights(lit.scene, lit.view, UINT32_MAX);
        HostLists made = test::make_tree_lists(packed, lit.view, 16);
        return shaded(g, s, add_made_lists(g, std::move(packed), std::move(made), lit.view, 16));
    };
    for (std::size_t i = 5; i < ways.size(); ++i) ways[i].options.own_lists = true;
    context.progress("source scene, rivals");
    const auto wanted = bench.look(lit, ways[3].options);
    const auto times = bench.measure(lit, ways, context.quick() ? 3 : 11);
    for (std::size_t i = 0; i < ways.size(); ++i) {
        LightRig::Options options = ways[i].options;
        const auto drawn = bench.look(lit, options);
        bench.add_row("source scene", "way", times[i], rmse_255(drawn.linear, wanted.linear),
                      "1/255 RMS against 8 px 2.5D");
        if (i < 4) {
            const double listed = listed_per_pixel(drawn, lit.view);
            context.add({.case_name = "source scene, lists",
                         .knob = "way",
                         .level = ways[i].name,
                         .error = listed / needed,
                         .metric = "listed / needed lights a pixel"});
            if (i == 3) {
                context.claim(fmt::format("8 px 2.5D lists hold {:.2f}x of what a pixel needs, at "
                                          "most 1.6x",
                                          listed / needed),
                              listed <= 1.6 * needed);
                const double share = times[i].cull.median_ms() / times[i].total.median_ms();
                context.claim(fmt::format("light processing is {:.0f} % of the time without "
                                          "prepass, at most 25 %",
                                          100 * share),
                              share <= 0.25);
                const double per_light =
                    times[i].shade.median_ms() * 1e6 / listed / lit.view.width / lit.view.height;
                context.note(
                    fmt::format("Shading takes {:.2f} ns a pixel and listed light.", per_light));
            }
        }
    }
    std::vector<double> ratios;
    for (std::size_t i = 0; i < times[3].cull.ms.size(); ++i) {
        ratios.push_back(times[3].cull.ms[i] / times[2].cull.ms[i]);
    }
    const double over = bench::quantile(ratios, 0.5) - 1;
    context.claim(fmt::format("the 2.5D mask adds {:.0f} % to culling, less than 10 %", 100 * over),
                  over < 0.1);
    const double ahead = times[5].total.median_ms() / times[3].total.median_ms();
    context.claim(fmt::format("Forward+ takes 1/{:.2f} of compute deferred's time", ahead),
                  ahead > 1);
}

/// All lights for every pixel, at a size where that can be waited for.
void brute_force(LightBench& bench, int lights) {
    BenchContext& context = bench.context();
    const LitScene lit = test::source_scene(320, 180, lights, 25);
    bench.show(lit);
    context.progress("brute force at 320x180");
    std::vector<LightBench::Way> ways = {{"Forward+ 8 px 2.5D", with_lists({.tile_px = 8})},
                                         {"brute force", with_lists({.tile_px = 8})},
                                         {"no lights", with_lists({.tile_px = 8})}};
    ways[1].options.brute_force = true;
    ways[2].options.own_lists = true;
    ways[2].options.instead = [&lit](graph::FrameGraph& g, const LightLists&,
                                     const SurfaceTargets& s) {
        Scene dark = lit.scene;
        dark.lights.clear();
        const LightLists none = add_light_lists(g, dark, lit.view, s.view_z, {});
        return add_shade_pass(g, dark, lit.view, {.surface = s, .lists = none, .shadow_masks = {}});
    };
    const auto times = bench.measure(lit, ways, context.quick() ? 3 : 9);
    const auto a = bench.look(lit, ways[0].options);
    const auto b = bench.look(lit, ways[1].options);
    for (std::size_t i = 0; i < 2; ++i) {
        bench.add_row("320x180", "way", times[i], i == 0 ? rmse_255(a.linear, b.linear) : 0,
                      "1/255 RMS against brute force");
    }
    context.claim("the picture is that of all lights for every pixel, bit for bit",
                  a.bits == b.bits);
    const double listed = listed_per_pixel(a, lit.view);
    const double faster = times[1].shade.median_ms() / times[0].shade.median_ms();
    context.claim(fmt::format("shading is {:.0f}x as fast as all lights, half of lights / list or "
                              "more",
                              faster),
                  faster >= 0.5 * lights / listed);
    // What the pass takes without any light belongs to neither.
    const double bare = times[2].shade.median_ms();
    const double plain = (times[1].shade.median_ms() - bare) / lights;
    const double ours = (times[0].shade.median_ms() - bare) / listed;
    context.claim(fmt::format("a listed light takes {:.2f}x the plain loop's time for one, at most "
                              "1.2x",
                              ours / plain),
                  ours <= 1.2 * plain);
}

void curves(LightBench& bench) {
    BenchContext& context = bench.context();
    const int width = context.quick() ? 320 : 640;
    const int height = width * 9 / 16;
    const int rounds = context.quick() ? 3 : 9;
    const LitScene base = test::source_scene(width, height, 8192, 25.0 * 8192 / 3072);
    bench.show(base);
    context.progress("curves");
    for (int lights = 64; lights <= 8192; lights *= context.quick() ? 8 : 2) {
        LitScene lit = base;
        lit.scene.lights.resize(static_cast<std::size_t>(lights));
        const auto times =
            bench.measure(lit, {{fmt::format("{}", lights), with_lists({.tile_px = 8})}}, rounds);
        bench.add_row(fmt::format("{}x{}", width, height), "lights", times[0], 0, "1/255 RMS");
    }
    LitScene lit = base;
    lit.scene.lights.resize(3072);
    const double needed = needed_per_pixel(context, lit, 4);
    const auto listed = [&](const std::string& knob, const std::string& level,
                            LightListOptions options) {
        const LightRig::Options way = with_lists(options);
        const auto times = bench.measure(lit, {{level, way}}, rounds);
        const auto drawn = bench.look(lit, way);
        bench.add_row("3,072 lights", knob, times[0], listed_per_pixel(drawn, lit.view) / needed,
                      "listed / needed lights a pixel");
    };
    for (const std::uint32_t px : {8u, 16u, 32u}) {
        listed("tile px", fmt::format("{}", px), {.tile_px = px});
    }
    for (const std::uint32_t cells : {1u, 8u, 16u, 32u}) {
        listed("cells", fmt::format("{}", cells), {.tile_px = 16, .cell_count = cells});
    }
    listed("cell spacing", "linear", {.tile_px = 16});
    listed("cell spacing", "logarithmic", {.tile_px = 16, .cells = DepthCells::logarithmic});
    const auto wanted = bench.look(lit, with_lists({}));
    for (const std::uint32_t capacity : {32u, 64u, 128u, 256u}) {
        const LightRig::Options way{.lists = {.capacity = capacity}};
        const auto times = bench.measure(lit, {{fmt::format("{}", capacity), way}}, rounds);
        const auto drawn = bench.look(lit, way);
        bench.add_row("3,072 lights", "capacity", times[0], rmse_255(drawn.linear, wanted.linear),
                      "1/255 RMS against no limit");
    }
    // The cut-off: light of intensity I ends where I / r^2 = eps. Against one eight times lower.
    const float intensity = lit.scene.lights[0].radius_m * lit.scene.lights[0].radius_m / 256;
    const auto at = [&](double inverse_eps) {
        LitScene cut = lit;
        for (Light& light : cut.scene.lights) {
            light.radius_m = static_cast<float>(test::radius_of(intensity, 1 / inverse_eps));
        }
        return cut;
    };
    // The lists of the lowest cut-off are as long as the scene has lights.
    const auto whole = bench.look(at(2048), {.lists = {.capacity = 3072}});
    for (const double inverse : {16.0, 64.0, 256.0, 1024.0}) {
        const LitScene cut = at(inverse);
        const LightRig::Options way{.lists = {.tile_px = 16, .capacity = 3072}};
        const auto times = bench.measure(cut, {{fmt::format("{:.0f}", inverse), way}}, rounds);
        const auto drawn = bench.look(cut, way);
        bench.add_row("3,072 lights", "1 / cut-off", times[0], rmse_255(drawn.linear, whole.linear),
                      "1/255 RMS against 1/2048");
    }
}

void columns(LightBench& bench) {
    BenchContext& context = bench.context();
    const LitScene lit =
        context.quick() ? test::colonnade(640, 360, 2048) : test::colonnade(1280, 720, 2048);
    bench.show(lit);
    context.progress("colonnade");
    std::uint32_t longest[3] = {};
    const std::vector<LightBench::Way> ways = {
        {"frustum", with_lists({.cells = DepthCells::none})},
        {"2.5D linear", with_lists({})},
        {"2.5D logarithmic", with_lists({.cells = DepthCells::logarithmic})}};
    const auto times = bench.measure(lit, ways, context.quick() ? 3 : 9);
    for (std::size_t i = 0; i < ways.size(); ++i) {
        const auto drawn = bench.look(lit, ways[i].options);
        longest[i] = drawn.counters.longest;
        bench.add_row("colonnade", "cells", times[i], drawn.counters.longest, "longest list");
    }
    context.claim(fmt::format("colonnade: the longest list falls from {} to {}, at most 60 %",
                              longest[0], longest[1]),
                  longest[1] <= 0.6 * longest[0]);
}

}  // namespace

void bench_forward_plus(BenchContext& context) {
    auto device = gpu::Device::create({});
    if (!device) {
        context.fail(device.error());
        return;
    }
    context.set_device(fmt::format("{}, {}", (*device)->info().name, (*device)->info().driver));
    LightBench bench(context, **device);
    context.quick() ? rivals(bench, 960, 540, 3072) : rivals(bench, 1280, 720, 3072);
    brute_force(bench, 3072);
    curves(bench);
    columns(bench);
    bench_forward_samples(context, **device);
    context.note(
        "cull: packing and uploading lights, tile bounds, culling, and for lists by the "
        "host the host's work; shade: the pass that walks the lists. Each in a submit of "
        "its own, from submit to fence. Compute deferred culls and lights in one pass, "
        "which counts as cull. The prepass is the drawing of the surface and the same for "
        "all: bench raster.");
}

}  // namespace kino
