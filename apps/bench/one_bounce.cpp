#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "apps/bench/reference_cache.h"
#include "apps/bench/registry.h"
#include "apps/bench/source_version.h"
#include "apps/bench/stage_player.h"
#include "viz/surface/mesh_shapes.h"

namespace kino {
namespace {

using bench::StagePlayer;

/// So low that it changes little, where the number of lights is looked at.
constexpr float kFineCutoff = 0.003f;
/// Half sides of the room, metres; it is open towards the camera.
constexpr double kHalf = 1.25;
const glm::dvec3 kGrey(0.72);

/// A box along the axes, seen from outside or, the room, from inside.
struct Solid {
    glm::dvec3 center, half;
};

struct Hit {
    double t = 0;
    glm::dvec3 place{0}, normal{0}, albedo{0};
};

glm::dvec3 wall_color(const glm::dvec3& normal) {
    // Left red, right green, as Goral et al. painted them.
    if (normal.x > 0.5) return {0.7, 0.07, 0.05};
    if (normal.x < -0.5) return {0.1, 0.5, 0.09};
    return kGrey;
}

/// Nearest surface of the box and its solids, in double.
std::optional<Hit> first_hit(const std::vector<Solid>& solids, const glm::dvec3& from,
                             const glm::dvec3& way, double t_max = 1e9) {
    Hit best{.t = t_max};
    bool found = false;
    for (int axis = 0; axis < 3; ++axis) {
        for (const double side : {-1.0, 1.0}) {
            if (axis == 2 && side > 0) continue;
            const double t = (side * kHalf - from[axis]) / way[axis];
            if (!(t > 1e-9 && t < best.t)) continue;
            const glm::dvec3 at = from + t * way;
            bool inside = true;
            for (int k = 0; k < 3; ++k) {
                inside = inside && (k == axis || std::abs(at[k]) <= kHalf);
            }
            glm::dvec3 normal(0);
            normal[axis] = -side;
            if (!inside || glm::dot(normal, way) >= 0) continue;
            best = {t, at, normal, wall_color(normal)};
            found = true;
        }
    }
    for (const Solid& solid : solids) {
        double enter = 1e-9, leave = best.t;
        int entered = -1;
        for (int k = 0; k < 3; ++k) {
            double a = (solid.center[k] - solid.half[k] - from[k]) / way[k];
            double b = (solid.center[k] + solid.half[k] - from[k]) / way[k];
            if (a > b) std::swap(a, b);
            if (a > enter) {
                enter = a;
                entered = k;
            }
            leave = std::min(leave, b);
        }
        if (entered < 0 || enter >= leave) continue;
        glm::dvec3 normal(0);
        normal[entered] = way[entered] > 0 ? -1 : 1;
        best = {enter, from + enter * way, normal, kGrey};
        found = true;
    }
    if (!found) return std::nullopt;
    return best;
}

/// A share of the torch's light where it meets the room: what it returns, per unit of solid angle
/// and cosine.
struct Patch {
    glm::dvec3 place, normal, flux;
};

std::vector<Patch> lit_patches(const std::vector<Solid>& solids, const Light& torch, int side) {
    const glm::dvec3 along = glm::normalize(torch.direction);
    const glm::dvec3 right = glm::normalize(
        glm::cross(along, std::abs(along.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0)));
    const glm::dvec3 up = glm::cross(right, along);
    const double outer = std::cos(double{torch.outer_rad});
    const double inner = std::cos(double{torch.inner_rad});
    std::vector<Patch> patches;
    // Equal solid angles: steps of the cosine and of the turn.
    const double share = 2 * std::numbers::pi * (1 - outer) / (double(side) * side);
    for (int i = 0; i < side; ++i) {
        for (int j = 0; j < side; ++j) {
            const double cosine = 1 - (1 - outer) * (i + 0.5) / side;
            const double turn = 2 * std::numbers::pi * (j + 0.5) / side;
            const double sine = std::sqrt(1 - cosine * cosine);
            const glm::dvec3 way =
                cosine * along + sine * std::cos(turn) * right + sine * std::sin(turn) * up;
            const auto hit = first_hit(solids, torch.position, way);
            if (!hit) continue;
            const double bright = std::clamp((cosine - outer) / (inner - outer), 0.0, 1.0);
            const double ratio = hit->t * hit->t / (double{torch.radius_m} * torch.radius_m);
            const double inside = std::clamp(1 - ratio * ratio, 0.0, 1.0);
            // Irradiance x area: the distance and the angle to the light cancel out.
            const double light = bright * bright * inside * inside * share;
            patches.push_back({hit->place, hit->normal,
                               light * hit->albedo * glm::dvec3(torch.color) / std::numbers::pi});
        }
    }
    return patches;
}

glm::dvec3 bounced(const std::vector<Solid>& solids, const std::vector<Patch>& patches,
                   const Hit& at, bool hidden_counts) {
    glm::dvec3 sum(0);
    for (const Patch& patch : patches) {
        const glm::dvec3 way = at.place - patch.place;
        const double squared = glm::dot(way, way);
        const double angles =
            std::max(glm::dot(way, patch.normal), 0.0) * std::max(-glm::dot(way, at.normal), 0.0);
        if (!(angles > 0)) continue;
        if (hidden_counts && !solids.empty() &&
            first_hit(solids, patch.place + 1e-6 * patch.normal, way, 1 - 1e-5)) {
            continue;
        }
        sum += patch.flux * (angles / (squared * squared));
    }
    return at.albedo * sum;
}

MeshNode plate(const glm::dvec3& center, const glm::dvec3& half, std::uint32_t material,
               std::uint32_t id) {
    MeshNode node{.id = id, .mesh = make_box(glm::vec3(2.0 * half)), .material = material};
    node.world_from_object[3] = glm::dvec4(center, 1);
    return node;
}

Scene cornell(const std::vector<Solid>& solids) {
    Scene scene;
    scene.color_mode = ColorMode::relit;
    scene.ambient = glm::vec3(0);
    scene.background_top = scene.background_bottom = glm::vec3(0);
    scene.materials = {{.name = "grey", .base_color = kGrey},
                       {.name = "red", .base_color = wall_color({1, 0, 0})},
                       {.name = "green", .base_color = wall_color({-1, 0, 0})}};
    const double thin = 0.05, far = kHalf + thin;
    scene.meshes = {plate({-far, 0, 0}, {thin, kHalf, kHalf}, 2, 1),
                    plate({far, 0, 0}, {thin, kHalf, kHalf}, 3, 2),
                    plate({0, -far, 0}, {kHalf, thin, kHalf}, 1, 3),
                    plate({0, far, 0}, {kHalf, thin, kHalf}, 1, 4),
                    plate({0, 0, -far}, {kHalf, kHalf, thin}, 1, 5)};
    for (const Solid& solid : solids) {
        scene.meshes.push_back(plate(solid.center, solid.half, 1,
                                     static_cast<std::uint32_t>(scene.meshes.size() + 1)));
    }
    scene.lights = {{.kind = LightKind::spot,
                     .position = {0.25, 0.55, 0.3},
                     .direction = {-1, -0.35, -0.3},
                     .color = glm::vec3(12),
                     .radius_m = 8,
                     .inner_rad = 0.3f,
                     .outer_rad = 0.42f,
                     .indirect = true}};
    return scene;
}

struct Errors {
    double rmse = 0;    ///< of the bounced light, relative to its mean
    double biased = 0;  ///< of its mean, relative
};

Errors compare_pictures(const Image<glm::dvec3>& wanted, const Image<glm::dvec3>& got, int step) {
    double squared = 0, sum = 0, off = 0, count = 0;
    for (int y = 0; y < wanted.height(); y += step) {
        for (int x = 0; x < wanted.width(); x += step) {
            for (int k = 0; k < 3; ++k) {
                const double d = got.at(x, y)[k] - wanted.at(x, y)[k];
                squared += d * d;
                off += d;
                sum += wanted.at(x, y)[k];
                count += 1;
            }
        }
    }
    return {std::sqrt(squared / count) / (sum / count), off / sum};
}

void bounce_case(BenchContext& context, StagePlayer& player, const std::string& name,
                 const std::vector<Solid>& solids) {
    const bool quick = context.quick();
    const int width = quick ? 320 : 640, height = quick ? 240 : 480;
    const int step = quick ? 16 : 12;
    const View view{.width = width,
                    .height = height,
                    .projection = perspective(0.75, width, height),
                    .world_from_view = look_at({0, 0, 4.4}, {0, 0, 0})};
    const Scene scene = cornell(solids);
    Scene direct = scene;
    direct.lights[0].indirect = false;
    context.progress(name + ": reference");
    const auto patches = lit_patches(solids, scene.lights[0], quick ? 96 : 200);
    const glm::dmat3 turn = glm::mat3_cast(view.world_from_view.rotation);
    const Projection& k = view.projection;
    const auto reference = [&](bool hidden_counts) {
        bench::ReferenceKey key("one-bounce", bench::source_version({"apps/bench/one_bounce.cpp"}));
        key.add(width).add(height).add(step).add(hidden_counts);
        key.add(k.cx).add(k.cy).add(k.fx).add(k.fy);
        key.add(turn).add(view.world_from_view.translation);
        for (const Patch& patch : patches) key.add(patch.place).add(patch.normal).add(patch.flux);
        for (const Solid& solid : solids) key.add(solid.center).add(solid.half);
        return context.references.image<glm::dvec3>(key, [&] {
            Image<glm::dvec3> picture(width, height);
            for (int y = 0; y < height; y += step) {
                for (int x = 0; x < width; x += step) {
                    const glm::dvec3 way =
                        turn * glm::dvec3((x - k.cx) / k.fx, (y - k.cy) / k.fy, 1);
                    const auto hit = first_hit(solids, view.world_from_view.translation, way);
                    if (hit) picture.at(x, y) = bounced(solids, patches, *hit, hidden_counts);
                }
            }
            return picture;
        });
    };
    const auto hidden = reference(true), not_hidden = reference(false);
    if (!hidden || !not_hidden) return context.fail((hidden ? not_hidden : hidden).error());
    const Image<glm::dvec3>&wanted = *hidden, &unhidden = *not_hidden;
    const auto plain = player.draw(direct, view, {}, true);
    if (!plain) return context.fail(plain.error());
    std::vector<bench::Candidate> candidates = {
        {"no bounce", [&] { (void)player.draw(direct, view, {}, false); }}};
    struct Level {
        std::string knob, name;
        BounceOptions bounces;
    };
    std::vector<Level> levels;
    for (const std::uint32_t grid : {1u, 2u, 4u, 8u, 16u}) {
        levels.push_back({"virtual lights",
                          fmt::format("{0} x {0}", grid),
                          {.grid = grid, .cutoff = kFineCutoff}});
    }
    for (const float cutoff : {0.3f, 0.1f, 0.03f, 0.01f}) {
        levels.push_back({"cut-off of 8 x 8", fmt::format("{}", cutoff), {.cutoff = cutoff}});
    }
    std::vector<Errors> errors;
    for (const Level& level : levels) {
        StageOptions options;
        options.bounces = level.bounces;
        const auto drawn = player.draw(scene, view, options, true);
        if (!drawn) return context.fail(drawn.error());
        Image<glm::dvec3> got(width, height);
        for (std::size_t i = 0; i < got.size(); ++i) {
            got.pixels()[i] = glm::dvec3(drawn->linear.pixels()[i] - plain->linear.pixels()[i]);
        }
        errors.push_back(compare_pictures(wanted, got, step));
        candidates.push_back({level.knob + level.name, [&player, &scene, &view, options] {
                                  (void)player.draw(scene, view, options, false);
                              }});
    }
    const auto comparison = context.compare(name, candidates, {.repeats = 11});
    context.add({.case_name = name, .knob = "virtual lights", .level = "no bounce"}, comparison);
    std::string table;
    for (std::size_t i = 0; i < levels.size(); ++i) {
        const bench::Timing& timing = comparison[candidates[i + 1].name];
        context.add({.case_name = name,
                     .knob = levels[i].knob,
                     .level = levels[i].name,
                     .ms_median = timing.median_ms(),
                     .ms_p95 = timing.p95_ms(),
                     .error = errors[i].rmse,
                     .metric = "RMS of bounced light / its mean",
                     .baseline = "no bounce",
                     .speedup = comparison.speedup(candidates[i + 1].name, "no bounce")});
        table +=
            fmt::format("| {}: {} | {:.2f} | {:.3f} | {:+.1f} |\n", levels[i].knob, levels[i].name,
                        timing.median_ms() - comparison["no bounce"].median_ms(), errors[i].rmse,
                        100 * errors[i].biased);
    }
    context.section(
        fmt::format("## {}\n\n| | ms more than without | RMS / mean | mean off by, % "
                    "|\n|---|---:|---:|---:|\n{}",
                    name, table));
    const double floor = compare_pictures(wanted, unhidden, step).rmse;
    if (!solids.empty()) {
        context.note(
            fmt::format("{}: virtual lights cast no shadows: that alone is an error of "
                        "{:.3f}, whatever their number.",
                        name, floor));
    }
    context.claim(fmt::format("{}: 8 x 8 virtual lights are nearer than 1 x 1", name),
                  errors[3].rmse < errors[0].rmse);
    if (solids.empty()) {
        context.claim("in the empty box 8 x 8 are within 15 % RMS of the double reference",
                      errors[3].rmse < 0.15);
    }
}

}  // namespace

void bench_one_bounce(BenchContext& context) {
    auto device = gpu::Device::create({});
    if (!device) return context.fail(device.error());
    context.set_device(fmt::format("{}, {}", (*device)->info().name, (*device)->info().driver));
    StagePlayer player(**device);
    bounce_case(context, player, "Cornell box, empty", {});
    bounce_case(context, player, "Cornell box with two blocks",
                {{{-0.4, -0.5, -0.4}, {0.35, 0.75, 0.35}}, {{0.5, -0.9, 0.4}, {0.35, 0.35, 0.35}}});
    context.note(
        "A torch shines on the red wall; what is compared is the picture with its bounce less that "
        "without, linear. The reference sends rays from the torch in double, treats each place "
        "that "
        "they meet as a small lamp, and adds all of them up at every pixel that is looked at, with "
        "what stands between.");
}

}  // namespace kino
