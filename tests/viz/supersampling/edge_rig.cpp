#include "tests/viz/supersampling/edge_rig.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/packing.hpp>
#include <glm/packing.hpp>
#include <stdexcept>

#include "tests/viz/forward/solid_scene.h"
#include "tests/viz/host_copies.h"
#include "viz/quality/lod_fix_shared.h"
#include "viz/quality/lod_samples.h"

namespace kino::test {
namespace {

using graph::FrameGraph;
using graph::PassBuilder;
using graph::PassContext;
using graph::TextureId;
using graph::Use;

constexpr std::uint32_t kFillVertex[] = {
#include "lod_fullscreen_vert.inc"
};
constexpr std::uint32_t kFillSamples[] = {
#include "fill_samples_frag.inc"
};

gpu::Buffer must(Result<gpu::Buffer> made) {
    if (!made) throw std::runtime_error(made.error().to_string());
    return std::move(*made);
}

glm::dvec3 from_octahedral(double u, double v) {
    glm::dvec3 n(u, v, 1 - std::abs(u) - std::abs(v));
    if (n.z < 0) {
        n.x = (1 - std::abs(v)) * (u >= 0 ? 1 : -1);
        n.y = (1 - std::abs(u)) * (v >= 0 ? 1 : -1);
    }
    return glm::normalize(n);
}
double snorm(std::uint32_t bits) {
    return std::max(static_cast<std::int16_t>(bits & 0xFFFF) / 32767.0, -1.0);
}
/// Of 12 bits.
int octahedral_step(std::uint32_t bits) {
    return static_cast<int>(std::lround((snorm(bits) * 0.5 + 0.5) * 4095));
}

/// The texel of viz/surface/sample_surface.glsl.
glm::vec4 packed(const StoredSurface& s) {
    const float color = static_cast<float>(s.albedo.r << 16 | s.albedo.g << 8 | s.albedo.b);
    return {s.z,
            static_cast<float>(octahedral_step(s.normal >> 16) * 4096 + octahedral_step(s.normal)),
            static_cast<float>(s.object), s.albedo.a != 0 ? color : -1 - color};
}

}  // namespace

std::uint32_t stored_normal(const glm::dvec3& normal) {
    const double sum = std::abs(normal.x) + std::abs(normal.y) + std::abs(normal.z);
    glm::dvec2 o(normal.x / sum, normal.y / sum);
    if (normal.z < 0) {
        o = {(1 - std::abs(o.y)) * (o.x >= 0 ? 1 : -1), (1 - std::abs(o.x)) * (o.y >= 0 ? 1 : -1)};
    }
    return glm::packSnorm2x16(glm::vec2(o));
}

EdgeResult EdgeRig::run(const EdgeScene& scene, const StageOptions& options) {
    const auto width = static_cast<std::uint32_t>(scene.view.width);
    const auto height = static_cast<std::uint32_t>(scene.view.height);
    const std::size_t pixels = scene.linear.size();
    std::vector<gpu::Texture> textures;
    textures.reserve(5);
    FrameGraph graph(executor_.history());
    const auto texture = [&](const char* name, VkFormat format, const auto& value_of) {
        std::vector<decltype(value_of(std::size_t{0}))> values;
        for (std::size_t i = 0; i < pixels; ++i) values.push_back(value_of(i));
        auto made = filled_texture(device_, name, {width, height}, format, values.data(),
                                   values.size() * sizeof(values[0]));
        if (!made) throw std::runtime_error(made.error().to_string());
        textures.push_back(std::move(*made));
        return graph.import_texture(name, textures.back().image(), textures.back().view(),
                                    {width, height, format});
    };
    const auto centre = scene.centre.pixels();
    SurfaceTargets surface;
    surface.albedo = texture("albedo", VK_FORMAT_R8G8B8A8_UNORM,
                             [&](std::size_t i) { return centre[i].albedo; });
    surface.view_z = texture("z", kViewZFormat, [&](std::size_t i) { return centre[i].z; });
    surface.normal =
        texture("normal", kNormalFormat, [&](std::size_t i) { return centre[i].normal; });
    surface.object =
        texture("object", kObjectFormat, [&](std::size_t i) { return centre[i].object; });
    const TextureId picture = texture("picture", VK_FORMAT_R16G16B16A16_SFLOAT,
                                      [&](std::size_t i) { return scene.linear.pixels()[i]; });
    TextureId linear =
        graph.create_texture("linear", {width, height, VK_FORMAT_R16G16B16A16_SFLOAT});
    graph.add_pass(
        "rig/copy", "rig",
        [&](PassBuilder& b) {
            b.read(picture, Use::transfer_read);
            linear = b.write(linear, Use::transfer_write);
        },
        [=](PassContext& c) {
            const VkImageCopy all{
                .srcSubresource = {.aspectMask = VK_IMAGE_ASPECT_COLOR_BIT, .layerCount = 1},
                .dstSubresource = {.aspectMask = VK_IMAGE_ASPECT_COLOR_BIT, .layerCount = 1},
                .extent = {width, height, 1}};
            vkCmdCopyImage(c.commands().handle(), c.image(picture), VK_IMAGE_LAYOUT_GENERAL,
                           c.image(linear), VK_IMAGE_LAYOUT_GENERAL, 1, &all);
        });

    std::vector<glm::vec4> texels;
    for (const Image<StoredSurface>& sample : scene.samples) {
        for (const StoredSurface& s : sample.pixels()) texels.push_back(packed(s));
    }
    const gpu::Buffer source = must(gpu::Buffer::create(
        device_, "texels", texels.size() * sizeof(texels[0]), gpu::MemoryUse::upload));
    std::memcpy(source.mapped(), texels.data(), texels.size() * sizeof(texels[0]));
    const graph::BufferId from = graph.import_buffer("texels", source);
    constexpr VkFormat kTexelFormat = VK_FORMAT_R32G32B32A32_SFLOAT;
    SampleTargets samples{.texel = graph.create_texture("texels", {width, height, kTexelFormat, 4}),
                          .depth = {}};
    graph.add_pass(
        "rig/fill", "rig",
        [&](PassBuilder& b) {
            b.read(from, Use::fragment_read);
            samples.texel = b.write(samples.texel, Use::color_attachment);
        },
        [=](PassContext& c) {
            gpu::PipelineDesc desc;
            desc.name = "rig/fill";
            desc.vertex = kFillVertex;
            desc.fragment = kFillSamples;
            desc.bindings = {gpu::Binding::word_quads};
            desc.push_bytes = 12;
            desc.color_formats = {kTexelFormat};
            desc.samples = 4;
            const std::array<gpu::Target, 1> targets = {{{.view = c.view(samples.texel)}}};
            c.commands().begin_rendering({width, height}, targets, nullptr);
            for (std::uint32_t s = 0; s < 4 && c.bind(desc, {c.bound(from)}); ++s) {
                c.commands().constants(std::array{s, width, width * height});
                c.commands().draw(3);
            }
            c.commands().end_rendering();
        });

    const LodFixList list =
        add_edge_list(graph, samples, surface, scene.view, *options.lod, options.edge_share);
    const TextureId mixed =
        add_edge_samples(graph, scene.scene, scene.view, samples, surface, linear, options);
    const auto host = [&](std::size_t bytes) {
        return must(gpu::Buffer::create(device_, "host", bytes, gpu::MemoryUse::readback));
    };
    const gpu::Buffer picture_host = host(pixels * 8);
    const gpu::Buffer list_host = host(std::size_t{list.cap} * 4);
    const gpu::Buffer state_host = host(sizeof(shared::LodFixState));
    read_back(graph, mixed, picture_host);
    read_back(graph, list.pixels, list_host, std::uint64_t{list.cap} * 4);
    read_back(graph, list.state, state_host, sizeof(shared::LodFixState));
    EdgeResult result;
    if (const auto report = executor_.run(graph, graph::Timing::frame); !report) {
        ADD_FAILURE() << report.error().to_string();
        return result;
    }
    shared::LodFixState state{};
    std::memcpy(&state, state_host.mapped(), sizeof(state));
    result.cap = list.cap;
    result.found = state.failed;
    EXPECT_LE(state.count, list.cap);
    const auto listed = list_host.read<std::uint32_t>().first(state.count);
    result.listed.assign(listed.begin(), listed.end());
    result.linear.resize(scene.view.width, scene.view.height);
    std::memcpy(result.linear.data(), picture_host.mapped(), pixels * 8);
    return result;
}

reference::EdgeSurface as_reference(const StoredSurface& s, const Scene& scene, bool sample) {
    const std::size_t material = s.object >> 16;
    const glm::dvec3 normal =
        sample ? from_octahedral(octahedral_step(s.normal) * 2 / 4095.0 - 1,
                                 octahedral_step(s.normal >> 16) * 2 / 4095.0 - 1)
               : from_octahedral(snorm(s.normal), snorm(s.normal >> 16));
    reference::EdgeSurface out{
        .own = {linear_of(s.albedo.r), linear_of(s.albedo.g), linear_of(s.albedo.b)},
        .covered = s.albedo.a != 0,
        .z = s.z,
        .normal = normal,
        .object = s.object};
    if (material > 0 && material <= scene.materials.size()) {
        out.emission = scene.materials[material - 1].emission;
    }
    return out;
}

reference::EdgeRules rules_of(const EdgeScene& scene, const StageOptions& options) {
    const FramebufferLodOptions& lod = *options.lod;
    const Projection& k = scene.view.projection;
    return {.lod = {.metric = static_cast<reference::LodMetric>(lod.metric),
                    .sigma_z = lod.sigma_z,
                    .sigma_n = lod.sigma_n,
                    .fine_grained = lod.fine_grained,
                    .objects = true,
                    .fx = k.fx,
                    .fy = k.fy,
                    .cx = k.cx,
                    .cy = k.cy},
            .exposure = scene.scene.exposure,
            .tone_map = scene.scene.color_mode != ColorMode::captured,
            .as_shown = options.resolve == SampleResolve::as_shown};
}

}  // namespace kino::test
