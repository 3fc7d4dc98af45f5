#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "apps/bench/bench.h"
#include "apps/bench/reference_cache.h"
#include "apps/bench/registry.h"
#include "apps/bench/sample_pictures.h"
#include "tests/support/random.h"
#include "viz/surface/mesh_shapes.h"

namespace kino {
namespace {

using bench::coded_srgb;
using bench::StagePlayer;
using bench::standing_node;

/// Somebody of balls and rods before a wall, boxes, a fence of thin wires, and sky above.
Scene yard(int lights) {
    Scene scene;
    scene.color_mode = ColorMode::relit;
    scene.ambient = glm::vec3(0.06f);
    scene.background_top = {0.35f, 0.5f, 0.75f};
    scene.background_bottom = {0.7f, 0.75f, 0.8f};
    scene.materials = {{.name = "wall", .base_color = {0.55f, 0.5f, 0.45f}},
                       {.name = "skin", .base_color = {0.75f, 0.5f, 0.38f}},
                       {.name = "cloth", .base_color = {0.12f, 0.2f, 0.45f}},
                       {.name = "wire", .base_color = glm::vec3(0.7f)},
                       {.name = "box", .base_color = {0.6f, 0.15f, 0.1f}}};
    std::uint32_t id = 1;
    const auto add = [&](const std::shared_ptr<const MeshAsset>& mesh, const glm::dvec3& at,
                         double turn, std::uint32_t material) {
        scene.meshes.push_back(standing_node(mesh, at, turn, material, id++));
    };
    add(make_box({12, 2.6f, 0.1f}), {0, -0.6, -4.6}, 0, 1);
    add(make_box({12, 0.1f, 6}), {0, -1.3, -3.5}, 0, 1);
    const auto rod = make_cylinder(0.055f, 0.62f);
    const auto ball = make_sphere(0.07f);
    const glm::dvec3 feet(-0.35, -1.25, -3.2);
    add(make_sphere(0.12f), feet + glm::dvec3(0, 1.62, 0), 0, 2);
    add(make_box({0.36f, 0.55f, 0.2f}), feet + glm::dvec3(0, 1.15, 0), 0.3, 3);
    for (const double side : {-1.0, 1.0}) {
        add(rod, feet + glm::dvec3(0.1 * side, 0.35, 0), 0.1 * side, 3);
        add(rod, feet + glm::dvec3(0.27 * side, 1.1, 0.05), 0.35 * side, 2);
        add(ball, feet + glm::dvec3(0.33 * side, 0.8, 0.1), 0, 2);
    }
    add(make_torus(0.16f, 0.012f), feet + glm::dvec3(0.9, 1.3, 0.2), 1.1, 4);
    const auto wire = make_box({0.008f, 1.6f, 0.008f});
    for (int i = 0; i < 14; ++i) add(wire, {0.25 + 0.11 * i, -0.2, -2.6}, 0.12 * i, 4);
    test::Random random(8);
    const auto box = make_box({0.3f, 0.3f, 0.3f});
    for (int i = 0; i < 8; ++i) {
        add(box, {random.real(-2.2, 2), random.real(-1.2, -0.9), random.real(-4, -2.8)},
            random.real(0, 3), 5);
    }
    for (int i = 0; i < lights; ++i) {
        scene.lights.push_back(
            {.kind = LightKind::point,
             .position = {random.real(-3, 3), random.real(-1.2, 1.2), random.real(-4.4, -1.8)},
             .color = glm::vec3(random.real(0.02, 0.06), random.real(0.02, 0.06),
                                random.real(0.02, 0.06)) *
                      (300.0f / static_cast<float>(lights)),
             .radius_m = static_cast<float>(random.real(1.0, 1.8))});
    }
    return scene;
}

/// Mean squared difference of coded values, of 255 steps, over the pixels that count.
double mse(const Image<glm::dvec3>& a, const Image<glm::dvec3>& b,
           const Image<std::uint8_t>& counts) {
    double sum = 0, values = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        if (counts.pixels()[i] == 0) continue;
        for (int k = 0; k < 3; ++k) {
            sum += std::pow(255 * (coded_srgb(a.pixels()[i][k]) - coded_srgb(b.pixels()[i][k])), 2);
        }
        values += 3;
    }
    return sum / std::max(values, 1.0);
}

/// Pixels in which colours meet when nothing shines.
Result<Image<std::uint8_t>> edges_of(StagePlayer& player, Scene scene, const View& view) {
    for (Material& material : scene.materials) material.kind = MaterialKind::unlit;
    scene.lights.clear();
    Image<glm::dvec3> least(view.width, view.height, glm::dvec3(2));
    Image<glm::dvec3> most(view.width, view.height, glm::dvec3(-1));
    for (int i = 0; i < 64; ++i) {
        View at = view;
        at.projection.cx -= static_cast<float>((i % 8 + 0.5) / 8 - 0.5);
        at.projection.cy -= static_cast<float>((i / 8 + 0.5) / 8 - 0.5);
        KINO_ASSIGN(const auto drawn, player.draw(scene, at, {}, true));
        for (std::size_t k = 0; k < least.size(); ++k) {
            const glm::dvec3 c = glm::vec3(drawn.linear.pixels()[k]);
            least.pixels()[k] = glm::min(least.pixels()[k], c);
            most.pixels()[k] = glm::max(most.pixels()[k], c);
        }
    }
    Image<std::uint8_t> edges(view.width, view.height);
    for (std::size_t k = 0; k < least.size(); ++k) {
        const glm::dvec3 d = most.pixels()[k] - least.pixels()[k];
        edges.pixels()[k] = std::max({d.x, d.y, d.z}) > 0.02;
    }
    return edges;
}

struct Way {
    std::string name;
    StageOptions options;
};

StageOptions coarse(double r, std::uint32_t samples) {
    StageOptions options{.lod = FramebufferLodOptions{.r = r}, .samples = samples};
    if (r > 1) options.lod->fix_share = 0.05f;
    return options;
}

}  // namespace

void bench_supersampling(BenchContext& context) {
    auto made = gpu::Device::create({});
    if (!made) return context.fail(made.error());
    gpu::Device& device = **made;
    context.set_device(device.info().name + ", " + device.info().driver);
    const bool quick = context.quick();
    const int width = quick ? 640 : 1280, height = quick ? 360 : 720;
    const View view{.width = width,
                    .height = height,
                    .projection = perspective(0.8, width, height),
                    .world_from_view = look_at({0, 0, 0}, {0, -0.1, -1})};
    StagePlayer player(device);

    std::vector<Way> ways = {{"1 sample", {}}, {"4 samples, shaded", {.samples = 4}}};
    for (const double r : {1.0, 2.0, 4.0}) {
        if (r > 1) ways.push_back({fmt::format("1 sample, r {}", r), coarse(r, 1)});
        ways.push_back({fmt::format("edges, r {}", r), coarse(r, 4)});
    }
    for (const float share : {0.01f, 0.03f}) {
        ways.push_back({fmt::format("edges, r 1, at most {} %", 100 * share), coarse(1, 4)});
        ways.back().options.edge_share = share;
    }
    std::string table =
        "## Edges\n\nSquared error on edges, of 255^2, against the mean of 64 pictures; beside it "
        "that of four shaded samples over it, and the time over theirs.\n\n"
        "| lights | | on edges | of four | time of four | transient MiB |\n"
        "|---:|---|---:|---:|---:|---:|\n";
    for (const int lights : {60, 400}) {
        const Scene scene = yard(lights);
        context.progress(fmt::format("{} lights: reference", lights));
        // The scene and its view are this program's, as drawing is.
        const auto key = [&](const char* name) {
            bench::ReferenceKey made_by(name, bench::program_version(device.info().driver));
            return made_by.add(quick).add(lights);
        };
        const auto reference = context.references.image<glm::dvec3>(
            key("supersampling"), [&] { return mean_of_pictures(player, scene, view, 8); });
        const auto edges = context.references.image<std::uint8_t>(
            key("supersampling-edges"), [&] { return edges_of(player, scene, view); });
        if (!reference || !edges) {
            return context.fail(reference ? edges.error() : reference.error());
        }
        std::vector<double> errors;
        std::vector<std::uint64_t> bytes;
        std::vector<bench::Candidate> candidates;
        for (const Way& way : ways) {
            const auto drawn = player.draw(scene, view, way.options, true);
            if (!drawn) return context.fail(drawn.error());
            errors.push_back(mse(StagePlayer::shown(scene, drawn->linear), *reference, *edges));
            bytes.push_back(drawn->transient_bytes);
            candidates.push_back({way.name, [&player, &scene, &view, way] {
                                      (void)player.draw(scene, view, way.options, false);
                                  }});
        }
        const Scene dark = yard(0);
        candidates.push_back(
            {"no light", [&] { (void)player.draw(dark, view, ways[0].options, false); }});
        const auto comparison =
            context.compare(fmt::format("{} lights", lights), candidates, {.repeats = 15});
        const double pixels = static_cast<double>(width) * height;
        const double shading_ns =
            (comparison["1 sample"].median_ms() - comparison["no light"].median_ms()) * 1e6 /
            pixels;
        const auto edge_count = std::count(edges->pixels().begin(), edges->pixels().end(), 1);
        const std::string what = fmt::format("yard, {} lights, {}x{}", lights, width, height);
        context.note(fmt::format(
            "{}: light costs {:.0f} ns a pixel with one sample; {:.1f} % of the pixels are edges.",
            what, shading_ns, 100.0 * static_cast<double>(edge_count) / pixels));
        for (std::size_t i = 0; i < ways.size(); ++i) {
            const double time = 1 / comparison.speedup(ways[i].name, ways[1].name);
            table += fmt::format("| {} | {} | {:.1f} | {:.2f} | {:.2f} | {:.1f} |\n", lights,
                                 ways[i].name, errors[i], errors[i] / errors[1], time,
                                 static_cast<double>(bytes[i]) / (1 << 20));
            context.add({.case_name = what,
                         .knob = "samples",
                         .level = ways[i].name,
                         .error = errors[i],
                         .metric = "MSE on edges, of 255^2",
                         .baseline = ways[1].name},
                        comparison);
            // What the proof speaks of: light that costs something. Else numbers alone.
            if (lights < 300 || shading_ns < 100 || !ways[i].name.starts_with("edges") ||
                ways[i].name.ends_with("%")) {
                continue;
            }
            context.claim(fmt::format("{} lights, {}: at most 1.3 times the error of four shaded "
                                      "samples on edges",
                                      lights, ways[i].name),
                          errors[i] <= 1.3 * errors[1]);
            context.claim(
                fmt::format("{} lights, {}: at most 60 % of their time", lights, ways[i].name),
                time <= 0.6);
        }
    }
    context.note(
        "60 lights are few, near and hard: the sides of the wires, thinner than a pixel, are lit "
        "otherwise than their fronts, and no pixel's centre sees them. That is where the error "
        "beyond that of four shaded samples lies.");
    context.section(table);
}

}  // namespace kino
