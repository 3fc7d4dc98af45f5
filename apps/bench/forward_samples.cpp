#include "apps/bench/forward_samples.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "apps/bench/reference_cache.h"
#include "apps/bench/sample_pictures.h"
#include "apps/bench/stage_player.h"
#include "tests/support/random.h"
#include "viz/surface/mesh_shapes.h"

namespace kino {
namespace {

using bench::coded_srgb;
using bench::mean_of_pictures;
using bench::StagePlayer;
using bench::standing_node;

/// Thin bars, boxes and balls before a wall: edges wherever one looks.
Scene bars(int lights) {
    Scene scene;
    scene.color_mode = ColorMode::relit;
    scene.ambient = glm::vec3(0.05f);
    scene.materials = {{.name = "wall", .base_color = glm::vec3(0.6f, 0.6f, 0.65f)},
                       {.name = "bar", .base_color = {0.75f, 0.5f, 0.3f}},
                       {.name = "ball", .base_color = {0.3f, 0.5f, 0.75f}}};
    scene.materials[2].layers = {
        {.lobes = {{.kind = LobeKind::ggx, .color = glm::vec3(0.05f), .roughness = 0.35f}},
         .transmission = glm::vec3(1)},
        {.lobes = {{.kind = LobeKind::lambert}}}};
    const auto wall = make_box({14, 8, 0.1f});
    const auto bar = make_box({0.03f, 3.0f, 0.03f});
    const auto box = make_box({0.4f, 0.4f, 0.4f});
    const auto ball = make_sphere(0.25f);
    std::uint32_t id = 1;
    scene.meshes.push_back(standing_node(wall, {0, 0, -6}, 0, 1, id++));
    test::Random random(5);
    for (int i = 0; i < 40; ++i) {
        const glm::dvec3 at(random.real(-3, 3), random.real(-1.4, 1.4), random.real(-5.5, -2.5));
        scene.meshes.push_back(standing_node(bar, at, random.real(-0.4, 0.4), 2, id++));
        if (i % 3 == 0) {
            scene.meshes.push_back(standing_node(i % 2 == 0 ? box : ball,
                                                 at + glm::dvec3(0.3, 0, 0.2), random.real(0, 3),
                                                 i % 2 == 0 ? 2 : 3, id++));
        }
    }
    for (int i = 0; i < lights; ++i) {
        scene.lights.push_back(
            {.kind = LightKind::point,
             .position = {random.real(-4, 4), random.real(-2.2, 2.2), random.real(-5.9, -1.8)},
             .color = glm::vec3(random.real(0.01, 0.05), random.real(0.01, 0.05),
                                random.real(0.01, 0.05)),
             .radius_m = static_cast<float>(random.real(0.6, 1.1))});
    }
    return scene;
}

/// PSNR of sRGB-coded values, dB, over the pixels that `counts` says.
template <class Counts>
double psnr(const Image<glm::dvec3>& a, const Image<glm::dvec3>& b, const Counts& counts) {
    double sum = 0, values = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        if (!counts(i)) continue;
        for (int k = 0; k < 3; ++k) {
            const double off = coded_srgb(a.pixels()[i][k]) - coded_srgb(b.pixels()[i][k]);
            sum += off * off;
            values += 1;
        }
    }
    return -10 * std::log10(std::max(sum / values, 1e-12));
}

}  // namespace

void bench_forward_samples(BenchContext& context, gpu::Device& device) {
    const bool quick = context.quick();
    const int width = quick ? 640 : 1280, height = quick ? 360 : 720;
    const View view{.width = width,
                    .height = height,
                    .projection = perspective(0.8, width, height),
                    .world_from_view = look_at({0, 0, 0}, {0, 0, -1})};
    const Scene scene = bars(quick ? 200 : 500);
    StagePlayer player(device);
    const auto mean_of = [&](int side) {
        // The scene and its view are this program's, as drawing is.
        bench::ReferenceKey key("forward-samples", bench::program_version(device.info().driver));
        return context.references.image<glm::dvec3>(
            key.add(quick).add(side), [&] { return mean_of_pictures(player, scene, view, side); });
    };
    context.progress("samples: reference");
    const auto reference = mean_of(4);
    const auto four_pictures = mean_of(2);
    if (!reference || !four_pictures)
        return context.fail(reference ? four_pictures.error() : reference.error());
    struct Way {
        std::string name;
        StageOptions options;
        int pictures = 1;
    };
    const std::vector<Way> ways = {
        {"1 sample", {}},
        {"4 samples, mean of light", {.samples = 4, .resolve = SampleResolve::linear}},
        {"4 samples, mean as shown", {.samples = 4}},
        {"4 pictures", {}, 4}};
    std::vector<Image<glm::dvec3>> pictures;
    std::vector<std::uint64_t> bytes;
    std::vector<bench::Candidate> candidates;
    for (const Way& way : ways) {
        const auto drawn = player.draw(scene, view, way.options, true);
        if (!drawn) return context.fail(drawn.error());
        bytes.push_back(drawn->transient_bytes);
        pictures.push_back(way.pictures == 1 ? StagePlayer::shown(scene, drawn->linear)
                                             : *four_pictures);
        candidates.push_back({way.name, [&player, &scene, &view, way] {
                                  for (int i = 0; i < way.pictures; ++i) {
                                      (void)player.draw(scene, view, way.options, false);
                                  }
                              }});
    }
    const auto comparison = context.compare("samples", candidates, {.repeats = 15});
    // An edge: one sample and sixteen do not agree.
    const auto is_edge = [&](std::size_t i) {
        for (int k = 0; k < 3; ++k) {
            if (std::abs(coded_srgb(pictures[0].pixels()[i][k]) -
                         coded_srgb(reference->pixels()[i][k])) > 6.0 / 255) {
                return true;
            }
        }
        return false;
    };
    std::size_t edges = 0;
    for (std::size_t i = 0; i < pictures[0].size(); ++i) edges += is_edge(i);
    std::string table =
        "## Samples\n\nBars, boxes and balls under lights in lists against the mean of 16 "
        "pictures, each a quarter of a pixel from the next.\n\n"
        "| | PSNR, dB | on edges, dB | transient MiB |\n|---|---:|---:|---:|\n";
    const std::string what =
        fmt::format("bars, {} lights, {}x{}, {:.1f} % edges", scene.lights.size(), width, height,
                    100.0 * double(edges) / double(pictures[0].size()));
    std::vector<double> on_edges;
    for (std::size_t i = 0; i < ways.size(); ++i) {
        const double all = psnr(pictures[i], *reference, [](std::size_t) { return true; });
        on_edges.push_back(psnr(pictures[i], *reference, is_edge));
        table += fmt::format("| {} | {:.1f} | {:.1f} | {:.1f} |\n", ways[i].name, all,
                             on_edges.back(), double(bytes[i]) / (1 << 20));
        context.add({.case_name = what,
                     .knob = "samples",
                     .level = ways[i].name,
                     .error = all,
                     .metric = "PSNR, dB",
                     .baseline = "1 sample"},
                    comparison);
    }
    context.section(table);
    context.claim("four samples a pixel are 6 dB nearer to sixteen pictures on edges than one",
                  on_edges[2] > on_edges[0] + 6);
    context.claim("four samples take less than four pictures",
                  comparison.speedup("4 samples, mean as shown", "4 pictures") > 1);
}

}  // namespace kino
