#include "apps/bench/lod_stage.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <glm/geometric.hpp>
#include <glm/gtc/packing.hpp>
#include <glm/packing.hpp>

#include "apps/bench/lod_stage_shared.h"
#include "tests/scenes/depth_scene.h"
#include "tests/scenes/raster_scenes.h"
#include "tests/viz/host_copies.h"
#include "viz/frame/renderer.h"
#include "viz/light/light_passes.h"

namespace kino::bench {
namespace {

using graph::FrameGraph;
using graph::PassBuilder;
using graph::PassContext;
using graph::TextureId;
using graph::Use;

constexpr std::uint32_t kStageVertex[] = {
#include "lod_stage_vert.inc"
};
constexpr std::uint32_t kStageShade[] = {
#include "lod_shade_frag.inc"
};

constexpr VkFormat kLinear = VK_FORMAT_R16G16B16A16_SFLOAT;

std::uint32_t octahedral(const glm::dvec3& n) {
    const double sum = std::abs(n.x) + std::abs(n.y) + std::abs(n.z);
    glm::dvec2 o(n.x / sum, n.y / sum);
    if (n.z < 0) {
        o = glm::dvec2((1 - std::abs(o.y)) * (o.x >= 0 ? 1 : -1),
                       (1 - std::abs(o.x)) * (o.y >= 0 ? 1 : -1));
    }
    return glm::packSnorm2x16(glm::vec2(o));
}

double lattice(int x, int y, int salt) {
    auto h = static_cast<std::uint32_t>(x) * 374761393u +
             static_cast<std::uint32_t>(y) * 668265263u +
             static_cast<std::uint32_t>(salt) * 2246822519u;
    h = (h ^ (h >> 13)) * 1274126177u;
    return static_cast<double>((h ^ (h >> 16)) & 0xFFFFFF) / 0xFFFFFF;
}

/// Value noise of period one.
double noise_at(double u, double v, int salt) {
    const int x = static_cast<int>(std::floor(u));
    const int y = static_cast<int>(std::floor(v));
    const auto smooth = [](double t) { return t * t * (3 - 2 * t); };
    const double s = smooth(u - x);
    const double t = smooth(v - y);
    const double top = lattice(x, y, salt) * (1 - s) + lattice(x + 1, y, salt) * s;
    const double low = lattice(x, y + 1, salt) * (1 - s) + lattice(x + 1, y + 1, salt) * s;
    return top * (1 - t) + low * t;
}

Rgba8 shade_of(const glm::dvec3& srgb) {
    const auto byte = [](double v) {
        return static_cast<std::uint8_t>(std::lround(std::clamp(v, 0.0, 1.0) * 255));
    };
    return {byte(srgb.x), byte(srgb.y), byte(srgb.z), 255};
}

/// The detailed texture of ground and balls; `u`, `v` in metres.
Rgba8 texture_at(LodKind kind, bool ground, double u, double v) {
    const double fine = 0.5 * noise_at(60 * u, 60 * v, 1) + 0.5 * noise_at(140 * u, 140 * v, 2);
    if (ground && kind == LodKind::chess) {
        const bool dark =
            (static_cast<int>(std::floor(2 * u)) + static_cast<int>(std::floor(2 * v))) & 1;
        return shade_of((dark ? glm::dvec3(0.25, 0.2, 0.18) : glm::dvec3(0.85, 0.8, 0.7)) +
                        0.15 * (fine - 0.5));
    }
    if (ground) return shade_of(glm::dvec3(0.45, 0.43, 0.4) + 0.5 * (fine - 0.5));
    const double stripe = std::abs(std::fmod(std::abs(12 * v), 2.0) - 1) > 0.8 ? 0.35 : 0.0;
    if (kind == LodKind::car) return shade_of(glm::dvec3(0.7, 0.25, 0.2) + stripe + 0.1 * fine);
    if (kind == LodKind::dragon) {
        return shade_of(glm::dvec3(0.5, 0.65, 0.45) + 0.3 * (fine - 0.5));
    }
    return shade_of(glm::dvec3(0.8, 0.78, 0.72) + 0.25 * (fine - 0.5) - 0.5 * stripe);
}

std::vector<glm::vec4> balls_of(LodKind kind) {
    // The ground lies at y = 1.2 at the camera and rises slowly with distance.
    switch (kind) {
        case LodKind::car:
            return {{-0.9, 0.55, 4.2, 0.42}, {-0.2, 0.35, 4.2, 0.62}, {0.6, 0.5, 4.2, 0.48},
                    {1.2, 0.6, 4.1, 0.3},    {-1.2, 0.75, 3.6, 0.2},  {0.9, 0.75, 3.5, 0.2},
                    {-2.4, 0.3, 6.5, 0.6},   {2.6, 0.2, 6.8, 0.7}};
        case LodKind::dragon:
            return {{-1.1, 0.6, 4.0, 0.4},  {-0.6, 0.3, 3.8, 0.45}, {0.0, 0.1, 3.9, 0.5},
                    {0.55, -0.2, 4.0, 0.4}, {0.8, -0.6, 3.9, 0.3},  {0.5, -0.85, 3.7, 0.25},
                    {-1.6, 0.8, 4.4, 0.25}, {0.2, 0.7, 3.6, 0.25}};
        default:
            return {{-1.5, 0.5, 4.6, 0.28}, {-0.8, 0.55, 4.0, 0.28}, {-0.1, 0.5, 4.8, 0.3},
                    {0.5, 0.6, 3.6, 0.25},  {1.1, 0.5, 4.5, 0.28},   {1.7, 0.4, 5.3, 0.3},
                    {-0.5, 0.7, 3.1, 0.2},  {0.3, 0.3, 6.2, 0.32}};
    }
}

/// The nearest thing along a ray through the camera.
struct Seen {
    double z = 0;
    glm::dvec3 normal{0, 0, -1};
    Rgba8 albedo;
};

Seen seen_along(const LodStage& stage, const glm::dvec3& ray) {
    Seen seen;
    seen.albedo = shade_of(glm::dvec3(0.35, 0.45, 0.6) + 0.25 * ray.y);
    seen.albedo.a = 0;
    double nearest = 30;
    const glm::dvec3 up = glm::normalize(glm::dvec3(0, -1, -0.12));
    const double sinking = glm::dot(up, ray);
    if (sinking < 0) {
        const double z = -1.2 / sinking;
        if (z < nearest) {
            nearest = z;
            const glm::dvec3 at = ray * z;
            seen.z = z;
            seen.normal = up;
            seen.albedo = texture_at(stage.kind, true, at.x, at.z);
        }
    }
    for (const glm::vec4& ball : stage.things) {
        const glm::dvec3 center(ball);
        const double a = glm::dot(ray, ray);
        const double b = glm::dot(ray, center);
        const double c = glm::dot(center, center) - double{ball.w} * ball.w;
        const double root = b * b - a * c;
        if (root <= 0) continue;
        const double z = (b - std::sqrt(root)) / a;
        if (z <= 0 || z >= nearest) continue;
        nearest = z;
        seen.z = z;
        seen.normal = glm::normalize(ray * z - center);
        const double turn = std::atan2(seen.normal.x, -seen.normal.z);
        seen.albedo = texture_at(stage.kind, false, turn * ball.w, seen.normal.y * ball.w);
    }
    return seen;
}

Result<void> fill(gpu::Device& device, gpu::Texture& texture, int width, int height,
                  VkFormat format, const void* pixels, std::size_t bytes) {
    KINO_ASSIGN(texture, test::filled_texture(device, "stage",
                                              {static_cast<std::uint32_t>(width),
                                               static_cast<std::uint32_t>(height)},
                                              format, pixels, bytes));
    return {};
}

TextureId imported(FrameGraph& graph, const char* name, const gpu::Texture& texture) {
    return graph.import_texture(
        name, texture.image(), texture.view(),
        {texture.extent().width, texture.extent().height, texture.format()});
}

}  // namespace

LodStage made_stage(LodKind kind, int width, int height) {
    LodStage stage;
    stage.kind = kind;
    stage.name = kind == LodKind::car ? "car" : kind == LodKind::dragon ? "dragon" : "chess";
    stage.trips = kind == LodKind::car ? 9 : kind == LodKind::dragon ? 10 : 32;
    stage.view = {.width = width, .height = height, .projection = perspective(0.8, width, height)};
    stage.things = balls_of(kind);
    stage.albedo.resize(width, height);
    stage.z.resize(width, height);
    stage.normal.resize(width, height);
    const Projection& k = stage.view.projection;
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const Seen seen = seen_along(stage, {(x - k.cx) / k.fx, (y - k.cy) / k.fy, 1});
            stage.z.at(x, y) = static_cast<float>(seen.z);
            stage.normal.at(x, y) = octahedral(seen.normal);
            stage.albedo.at(x, y) = seen.albedo;
        }
    }
    return stage;
}

Result<LodStage> room_stage(gpu::Device& device, int width, int height) {
    KINO_ASSIGN(test::RecordedScene recorded, test::load_recording("recordings/office"));
    Renderer renderer(device);
    LodStage stage;
    stage.name = "room";
    stage.kind = LodKind::room;
    stage.trips = 16;
    stage.view =
        test::standard_views(*recorded.scene.live, recorded.rig.depth, width, height)[1].view;
    KINO_ASSIGN(FrameResult frame,
                renderer.render_to_image(recorded.scene, stage.view, {.read_surface = true}));
    stage.albedo = std::move(frame.picture);
    stage.z = std::move(frame.surface.view_z_m);
    stage.normal = std::move(frame.surface.normal);
    for (std::size_t i = 0; i < stage.z.size(); ++i) {
        if (!(stage.z.pixels()[i] > 0)) stage.albedo.pixels()[i].a = 0;
    }
    for (int i = 0; i < 16; ++i) {
        const glm::vec3 color(0.4 + 0.3 * std::sin(i), 0.4 + 0.3 * std::sin(2.1 * i),
                              0.4 + 0.3 * std::cos(1.3 * i));
        stage.things.emplace_back(-2 + i % 4 * 1.3, -1 + i / 8 * 1.2, 1 + i / 4 * 0.8, 3.0f);
        stage.things.emplace_back(0.5f * color, 0);
    }
    return stage;
}

Result<std::unique_ptr<LodPlayer>> LodPlayer::create(gpu::Device& device, const LodStage& stage) {
    std::unique_ptr<LodPlayer> player(new LodPlayer(device, stage));
    const int w = stage.view.width;
    const int h = stage.view.height;
    KINO_TRY(fill(device, player->albedo_, w, h, VK_FORMAT_R8G8B8A8_UNORM, stage.albedo.data(),
                  stage.albedo.size() * 4));
    KINO_TRY(fill(device, player->z_, w, h, kViewZFormat, stage.z.data(), stage.z.size() * 4));
    KINO_TRY(fill(device, player->normal_, w, h, kNormalFormat, stage.normal.data(),
                  stage.normal.size() * 4));
    KINO_ASSIGN(player->readback_,
                gpu::Buffer::create(device, "stage", stage.z.size() * 8, gpu::MemoryUse::readback));
    return player;
}

TextureId LodPlayer::shade(FrameGraph& graph, const SurfaceTargets& surface, const View& view) {
    const auto width = static_cast<std::uint32_t>(view.width);
    const auto height = static_cast<std::uint32_t>(view.height);
    TextureId out = graph.create_texture("shaded", {width, height, kLinear});
    const Projection& k = view.projection;
    const shared::LodStageParams params{.k = {1 / k.fx, 1 / k.fy, k.cx, k.cy},
                                        .trips = stage_.trips};
    const auto execute = [=, kind = stage_.kind, things = stage_.things](PassContext& c) {
        gpu::PipelineDesc desc;
        desc.name = "bench/lod shade";
        desc.vertex = kStageVertex;
        desc.fragment = kStageShade;
        desc.bindings = {gpu::Binding::texture, gpu::Binding::texture, gpu::Binding::texture,
                         gpu::Binding::storage};
        desc.push_bytes = sizeof(params);
        desc.constants = {static_cast<std::uint32_t>(kind)};
        desc.color_formats = {kLinear};
        const std::array<gpu::Target, 1> targets = {{{.view = c.view(out)}}};
        c.commands().begin_rendering({width, height}, targets, nullptr);
        if (c.bind(desc, {c.bound(surface.albedo), c.bound(surface.view_z), c.bound(surface.normal),
                          c.upload(things)})) {
            c.commands().constants(params);
            c.commands().draw(3);
        }
        c.commands().end_rendering();
    };
    graph.add_pass(
        "bench/shade", "shade",
        [&](PassBuilder& b) {
            for (const TextureId id : {surface.albedo, surface.view_z, surface.normal}) {
                b.read(id, Use::fragment_read);
            }
            out = b.write(out, Use::color_attachment);
        },
        execute);
    return out;
}

Result<void> LodPlayer::draw(What what, const FramebufferLodOptions& options,
                             graph::Timing timing) {
    FrameGraph graph(executor_.history());
    const View& view = stage_.view;
    const SurfaceTargets fine{.albedo = imported(graph, "albedo", albedo_),
                              .view_z = imported(graph, "depth", z_),
                              .normal = imported(graph, "normal", normal_),
                              .id = {},
                              .object = {}};
    TextureId out;
    if (what == What::direct) {
        out = shade(graph, fine, view);
    } else {
        const CoarseSurface coarse = add_coarse_surface(graph, fine, view, options);
        if (what != What::resized) {
            KINO_TRY(fill_grey(coarse_, coarse.view.width, coarse.view.height));
        }
        const LodFinish finish{.target = target(graph)};
        const TextureId linear = what == What::resized ? shade(graph, coarse.surface, coarse.view)
                                                       : imported(graph, "shaded", coarse_);
        // Picking is part of it, also where the picture is shaded already.
        if (coarse.view.width != view.width) graph.require(coarse.surface.albedo);
        out = add_reconstruction(graph, linear, coarse, fine, view, options, nullptr,
                                 what == What::finished ? &finish : nullptr);
    }
    graph.require(out);
    if (reading_) test::read_back(graph, out, readback_);
    const auto report = executor_.run(graph, timing);
    if (!report) return fail(report.error());
    return {};
}

Result<void> LodPlayer::fill_grey(gpu::Texture& texture, int width, int height) {
    if (static_cast<int>(texture.extent().width) == width &&
        static_cast<int>(texture.extent().height) == height) {
        return {};
    }
    const Image<std::uint64_t> grey(width, height, 0x3C00380038003800u);
    return fill(device_, texture, width, height, kLinear, grey.data(), grey.size() * 8);
}

TextureId LodPlayer::target(FrameGraph& graph) const {
    return graph.create_texture(
        "target", {static_cast<std::uint32_t>(stage_.view.width),
                   static_cast<std::uint32_t>(stage_.view.height), VK_FORMAT_R8G8B8A8_UNORM});
}

Result<void> LodPlayer::last_pass() {
    FrameGraph graph(executor_.history());
    KINO_TRY(fill_grey(whole_, stage_.view.width, stage_.view.height));
    Scene scene;
    scene.color_mode = ColorMode::relit;
    graph.require(add_final_pass(graph, scene, imported(graph, "whole", whole_), target(graph)));
    const auto report = executor_.run(graph, graph::Timing::frame);
    if (!report) return fail(report.error());
    return {};
}

Result<void> LodPlayer::finished(const FramebufferLodOptions& options) {
    return draw(What::finished, options, graph::Timing::frame);
}

Result<void> LodPlayer::direct() {
    return draw(What::direct, {}, graph::Timing::frame);
}

Result<void> LodPlayer::resized(const FramebufferLodOptions& options) {
    return draw(What::resized, options, graph::Timing::frame);
}

Result<void> LodPlayer::reconstruction(const FramebufferLodOptions& options) {
    return draw(What::reconstruction, options, graph::Timing::frame);
}

Result<std::vector<graph::GroupTime>> LodPlayer::pass_times(const FramebufferLodOptions& options) {
    KINO_TRY(draw(What::resized, options, graph::Timing::every_pass));
    return executor_.group_times();
}

Result<Image<Rgba8>> LodPlayer::picture(const FramebufferLodOptions* options) {
    reading_ = true;
    const auto drawn = options == nullptr ? direct() : resized(*options);
    reading_ = false;
    if (!drawn) return fail(drawn.error());
    Image<Rgba8> picture(stage_.view.width, stage_.view.height);
    const std::span<const std::uint64_t> halves = readback_.read<std::uint64_t>();
    const auto byte = [](float c) {
        c = std::clamp(c, 0.0f, 1.0f);
        const float s = c <= 0.0031308f ? 12.92f * c : 1.055f * std::pow(c, 1 / 2.4f) - 0.055f;
        return static_cast<std::uint8_t>(std::lround(255 * s));
    };
    for (std::size_t i = 0; i < picture.size(); ++i) {
        const glm::vec4 c = glm::unpackHalf4x16(halves[i]);
        picture.pixels()[i] = {byte(c.x), byte(c.y), byte(c.z), 255};
    }
    return picture;
}

}  // namespace kino::bench
