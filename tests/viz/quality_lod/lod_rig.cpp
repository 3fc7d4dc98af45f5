#include "tests/viz/quality_lod/lod_rig.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <glm/geometric.hpp>
#include <glm/gtc/packing.hpp>

#include "tests/viz/host_copies.h"
#include "viz/light/light_passes.h"

namespace kino::test {
namespace {

using graph::BufferId;
using graph::FrameGraph;
using graph::PassBuilder;
using graph::PassContext;
using graph::TextureId;
using graph::Use;

std::uint8_t picked_byte(std::uint8_t value, bool fine_grained) {
    return fine_grained ? std::max<std::uint8_t>(value, 32) : value;
}

}  // namespace

/// Buffers that live as long as the graph that reads them.
struct LodRig::Frame {
    gpu::Device& device;
    FrameGraph graph;
    std::vector<std::unique_ptr<gpu::Buffer>> buffers;

    gpu::Buffer& buffer(std::size_t bytes, gpu::MemoryUse use) {
        auto made = gpu::Buffer::create(device, "lod rig", bytes, use);
        if (!made) throw std::runtime_error(made.error().to_string());
        buffers.push_back(std::make_unique<gpu::Buffer>(std::move(*made)));
        return *buffers.back();
    }

    template <class T>
    TextureId texture(const Image<T>& image, VkFormat format) {
        gpu::Buffer& source = buffer(image.size() * sizeof(T), gpu::MemoryUse::upload);
        source.write(image.pixels());
        const BufferId from = graph.import_buffer("source", source);
        TextureId to =
            graph.create_texture("source", {static_cast<std::uint32_t>(image.width()),
                                            static_cast<std::uint32_t>(image.height()), format});
        graph.add_pass(
            "rig/copy", "rig",
            [&](PassBuilder& b) {
                b.read(from, Use::transfer_read);
                to = b.write(to, Use::transfer_write);
            },
            [from, to](PassContext& c) {
                const VkBufferImageCopy region =
                    whole_picture({c.desc(to).width, c.desc(to).height});
                vkCmdCopyBufferToImage(c.commands().handle(), c.buffer(from), c.image(to),
                                       VK_IMAGE_LAYOUT_GENERAL, 1, &region);
            });
        return to;
    }

    const gpu::Buffer* read_back(TextureId texture, std::size_t bytes_a_pixel) {
        const graph::TextureDesc desc = graph.resources()[texture.index].texture;
        const gpu::Buffer& host =
            buffer(bytes_a_pixel * desc.width * desc.height, gpu::MemoryUse::readback);
        test::read_back(graph, texture, host);
        return &host;
    }

    const gpu::Buffer* read_back(BufferId from) {
        const std::uint64_t bytes = graph.resources()[from.index].buffer.bytes;
        const gpu::Buffer& host = buffer(bytes, gpu::MemoryUse::readback);
        test::read_back(graph, from, host, bytes);
        return &host;
    }
};

LodScene plain_scene(int width, int height) {
    LodScene scene;
    scene.view = {.width = width, .height = height, .projection = perspective(0.9, width, height)};
    scene.albedo = Image<Rgba8>(width, height, {188, 188, 188, 255});
    scene.z = Image<float>(width, height, 2.0f);
    scene.normal = Image<std::uint32_t>(width, height, packed_normal({0, 0, -1}));
    return scene;
}

std::uint32_t packed_normal(const glm::dvec3& normal) {
    const double sum = std::abs(normal.x) + std::abs(normal.y) + std::abs(normal.z);
    double u = normal.x / sum;
    double v = normal.y / sum;
    if (normal.z < 0) {
        const double folded_u = (1 - std::abs(v)) * (u >= 0 ? 1 : -1);
        v = (1 - std::abs(u)) * (v >= 0 ? 1 : -1);
        u = folded_u;
    }
    const auto snorm = [](double t) {
        return static_cast<std::uint16_t>(static_cast<std::int16_t>(std::lround(t * 32767)));
    };
    return static_cast<std::uint32_t>(snorm(v)) << 16 | snorm(u);
}

glm::dvec3 unpacked_normal(std::uint32_t bits) {
    const auto part = [](std::uint32_t b) {
        return std::max(static_cast<std::int16_t>(b & 0xFFFF) / 32767.0, -1.0);
    };
    glm::dvec3 n(part(bits), part(bits >> 16), 0);
    n.z = 1 - std::abs(n.x) - std::abs(n.y);
    if (n.z < 0) {
        const double x = (1 - std::abs(n.y)) * (n.x >= 0 ? 1 : -1);
        n.y = (1 - std::abs(n.x)) * (n.y >= 0 ? 1 : -1);
        n.x = x;
    }
    return glm::normalize(n);
}

double from_srgb(double c) {
    return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}

SurfaceTargets LodRig::fine_surface(Frame& frame, const LodScene& scene) {
    SurfaceTargets fine{.albedo = frame.texture(scene.albedo, VK_FORMAT_R8G8B8A8_UNORM),
                        .view_z = frame.texture(scene.z, kViewZFormat),
                        .normal = frame.texture(scene.normal, kNormalFormat),
                        .id = {},
                        .object = {}};
    if (!scene.object.empty()) fine.object = frame.texture(scene.object, VK_FORMAT_R32_UINT);
    return fine;
}

Image<std::uint64_t> LodRig::shade(const LodScene& scene, const View& coarse,
                                   const FramebufferLodOptions& options,
                                   const LodShading& shading) {
    Image<std::uint64_t> linear(coarse.width, coarse.height);
    for (int y = 0; y < coarse.height; ++y) {
        for (int x = 0; x < coarse.width; ++x) {
            const Rgba8 c =
                scene.albedo.at(reference::lod_texel(x, scene.view.width, coarse.width),
                                reference::lod_texel(y, scene.view.height, coarse.height));
            const auto part = [&](std::uint8_t v) {
                return from_srgb(picked_byte(v, options.fine_grained) / 255.0);
            };
            linear.at(x, y) = glm::packHalf4x16(shading(x, y, {part(c.r), part(c.g), part(c.b)}));
        }
    }
    return linear;
}

LodRig::Finished LodRig::finish(const LodScene& scene, const FramebufferLodOptions& options,
                                const LodShading& shading, const Scene& rules) {
    Frame frame{device_, FrameGraph(executor_.history()), {}};
    FrameGraph& graph = frame.graph;
    const SurfaceTargets fine = fine_surface(frame, scene);
    const CoarseSurface coarse = add_coarse_surface(graph, fine, scene.view, options);
    const TextureId shaded =
        frame.texture(shade(scene, coarse.view, options, shading), VK_FORMAT_R16G16B16A16_SFLOAT);
    const auto target = [&] {
        return graph.create_texture(
            "target", {static_cast<std::uint32_t>(scene.view.width),
                       static_cast<std::uint32_t>(scene.view.height), VK_FORMAT_R8G8B8A8_UNORM});
    };
    const TextureId linear = add_reconstruction(graph, shaded, coarse, fine, scene.view, options);
    const gpu::Buffer* apart = frame.read_back(add_final_pass(graph, rules, linear, target()), 4);
    const LodFinish finish{
        .target = target(), .exposure = rules.exposure, .tone_map = wants_tone_map(rules)};
    const gpu::Buffer* fused = frame.read_back(
        add_reconstruction(graph, shaded, coarse, fine, scene.view, options, nullptr, &finish), 4);
    Finished finished;
    const auto report = executor_.run(graph, graph::Timing::frame);
    if (!report) {
        ADD_FAILURE() << report.error().to_string();
        return finished;
    }
    for (auto [from, to] : {std::pair(apart, &finished.apart), {fused, &finished.on_the_way}}) {
        to->resize(scene.view.width, scene.view.height);
        std::memcpy(to->data(), from->mapped(), to->size() * 4);
    }
    return finished;
}

Image<float> LodRig::guided_depth(const Image<float>& depth, const Image<Rgba8>& color,
                                  const GuidedDepthOptions& options) {
    Frame frame{device_, FrameGraph(executor_.history()), {}};
    const TextureId from = frame.texture(depth, VK_FORMAT_R32_SFLOAT);
    const TextureId by = frame.texture(color, VK_FORMAT_R8G8B8A8_UNORM);
    const gpu::Buffer* host = frame.read_back(add_guided_depth(frame.graph, from, by, options), 4);
    Image<float> out(color.width(), color.height());
    const auto report = executor_.run(frame.graph, graph::Timing::frame);
    if (!report) {
        ADD_FAILURE() << report.error().to_string();
        return out;
    }
    std::memcpy(out.data(), host->mapped(), out.size() * 4);
    return out;
}

LodResult LodRig::run(const LodScene& scene, const FramebufferLodOptions& options,
                      const LodShading& shading) {
    Frame frame{device_, FrameGraph(executor_.history()), {}};
    FrameGraph& graph = frame.graph;
    const SurfaceTargets fine = fine_surface(frame, scene);
    const CoarseSurface coarse = add_coarse_surface(graph, fine, scene.view, options);
    LodResult result;
    result.coarse_view = coarse.view;
    const int width = coarse.view.width;
    const int height = coarse.view.height;
    result.direct = coarse.surface.albedo.index == fine.albedo.index;

    const Image<std::uint64_t> linear = shade(scene, coarse.view, options, shading);
    result.coarse.resize(width, height);
    for (std::size_t i = 0; i < linear.size(); ++i) {
        result.coarse.pixels()[i] = glm::unpackHalf4x16(linear.pixels()[i]);
    }
    const TextureId shaded = frame.texture(linear, VK_FORMAT_R16G16B16A16_SFLOAT);
    LodFixList fix;
    const TextureId out =
        add_reconstruction(graph, shaded, coarse, fine, scene.view, options, &fix);
    result.direct = result.direct && out.index == shaded.index;

    const gpu::Buffer* picture = frame.read_back(out, 8);
    const gpu::Buffer* fixed = fix.valid() ? frame.read_back(fix.pixels) : nullptr;
    const gpu::Buffer* fix_state = fix.valid() ? frame.read_back(fix.state) : nullptr;
    const gpu::Buffer* albedo = frame.read_back(coarse.surface.albedo, 4);
    const gpu::Buffer* z = frame.read_back(coarse.surface.view_z, 4);
    const gpu::Buffer* normal = frame.read_back(coarse.surface.normal, 4);
    const gpu::Buffer* object =
        coarse.surface.object.valid() ? frame.read_back(coarse.surface.object, 4) : nullptr;
    const gpu::Buffer* guide = coarse.guide.valid() ? frame.read_back(coarse.guide, 4) : nullptr;
    const auto report = executor_.run(graph, graph::Timing::frame);
    if (!report) {
        ADD_FAILURE() << report.error().to_string();
        return result;
    }
    for (const std::string& pass : report->passes) {
        if (!pass.starts_with("rig/")) result.passes.push_back(pass);
    }
    const auto copy = [](const gpu::Buffer* from, int w, int h, auto& to) {
        if (from == nullptr) return;
        to.resize(w, h);
        std::memcpy(to.data(), from->mapped(), from->bytes());
    };
    copy(albedo, width, height, result.albedo);
    copy(z, width, height, result.z);
    copy(normal, width, height, result.normal);
    copy(object, width, height, result.object);
    copy(guide, width, height, result.guide);
    if (fix.valid()) {
        std::memcpy(&result.fix, fix_state->mapped(), sizeof(result.fix));
        EXPECT_LE(result.fix.count, fix.cap);
        const auto* first = static_cast<const std::uint32_t*>(fixed->mapped());
        result.fixed.assign(first, first + result.fix.count);
    }
    Image<std::uint64_t> halves;
    copy(picture, scene.view.width, scene.view.height, halves);
    result.picture.resize(scene.view.width, scene.view.height);
    for (std::size_t i = 0; i < halves.size(); ++i) {
        result.picture.pixels()[i] = glm::unpackHalf4x16(halves.pixels()[i]);
    }
    return result;
}

namespace {

glm::dvec2 slope_of(const glm::dvec3& n, double least) {
    return glm::dvec2(n) / std::max(-n.z, least);
}

double finite_part(float v) {
    return std::isnan(v) ? 0.0 : std::clamp(static_cast<double>(v), 0.0, 65000.0);
}

}  // namespace

Image<reference::LodSample> lod_samples(const LodResult& result,
                                        const FramebufferLodOptions& options) {
    const bool packed = options.format == LodFormat::packed;
    Image<reference::LodSample> samples(result.coarse.width(), result.coarse.height());
    for (std::size_t i = 0; i < samples.size(); ++i) {
        reference::LodSample& sample = samples.pixels()[i];
        const glm::vec4 c = result.coarse.pixels()[i];
        sample.light = {finite_part(c.x), finite_part(c.y), finite_part(c.z)};
        if (options.fine_grained) {
            const Rgba8 a = result.albedo.pixels()[i];
            sample.light /=
                glm::dvec3(from_srgb(a.r / 255.0), from_srgb(a.g / 255.0), from_srgb(a.b / 255.0));
        }
        sample.z = result.z.pixels()[i];
        sample.slope = slope_of(unpacked_normal(result.normal.pixels()[i]), 0.05);
        if (!result.object.empty()) sample.object = result.object.pixels()[i];
        if (!packed || result.guide.empty()) continue;
        const std::uint32_t word = result.guide.pixels()[i];
        const double q = word >> 16;
        sample.z = q == 0 ? 0 : 0.05 * std::exp2((q - 1) / 4586.0);
        sample.slope = (glm::dvec2(word & 255u, word >> 8 & 255u) - 128.0) / 44.0;
    }
    return samples;
}

Image<glm::dvec3> lod_reference_picture(const LodScene& scene, const LodResult& result,
                                        const FramebufferLodOptions& options,
                                        Image<double>* doubt_bits) {
    const double least = options.format == LodFormat::packed ? 0.35 : 0.05;
    const Image<reference::LodSample> samples = lod_samples(result, options);
    Image<reference::LodPixel> fine(scene.view.width, scene.view.height);
    for (std::size_t i = 0; i < fine.size(); ++i) {
        reference::LodPixel& pixel = fine.pixels()[i];
        const Rgba8 a = scene.albedo.pixels()[i];
        pixel.own = {from_srgb(a.r / 255.0), from_srgb(a.g / 255.0), from_srgb(a.b / 255.0)};
        pixel.covered = a.a != 0;
        const double z = scene.z.pixels()[i];
        pixel.z = z > 0 && z < 1e9 ? z : 0;
        pixel.normal = unpacked_normal(scene.normal.pixels()[i]);
        pixel.slope = slope_of(pixel.normal, least);
        if (!scene.object.empty()) pixel.object = scene.object.pixels()[i];
    }
    const Projection& k = scene.view.projection;
    const reference::LodRules rules{.gauss = options.kernel == LodKernel::gauss,
                                    .metric = static_cast<reference::LodMetric>(options.metric),
                                    .sigma_z = options.sigma_z,
                                    .sigma_n = options.sigma_n,
                                    .fine_grained = options.fine_grained,
                                    .objects = !scene.object.empty(),
                                    .fx = k.fx,
                                    .fy = k.fy,
                                    .cx = k.cx,
                                    .cy = k.cy};
    Image<glm::dvec3> picture(scene.view.width, scene.view.height);
    if (doubt_bits != nullptr) doubt_bits->resize(scene.view.width, scene.view.height);
    for (int y = 0; y < picture.height(); ++y) {
        for (int x = 0; x < picture.width(); ++x) {
            picture.at(x, y) =
                reference::lod_reconstruct(samples, fine, x, y, rules,
                                           doubt_bits != nullptr ? &doubt_bits->at(x, y) : nullptr);
        }
    }
    return picture;
}

}  // namespace kino::test
