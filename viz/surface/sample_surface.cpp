#include "viz/surface/sample_surface.h"

#include <array>

#include "viz/surface/sample_backdrop.h"

namespace kino {
namespace {

using graph::FrameGraph;
using graph::PassBuilder;
using graph::PassContext;
using graph::Use;

constexpr std::uint32_t kSampleSeedVertex[] = {
#include "fullscreen_vert.inc"
};
constexpr std::uint32_t kSampleSeed[] = {
#include "sample_seed_frag.inc"
};
constexpr std::uint32_t kMeshSamples[] = {
#include "mesh_samples_frag.inc"
};

constexpr VkFormat kTexelFormat = VK_FORMAT_R32G32B32A32_SFLOAT;
static_assert(kMaxMaterials <= 256);  // material and object id are 24 bits

/// `clear`: to the background (sample_surface.glsl), nothing before it.
void begin(PassContext& c, const SampleTargets& targets, bool clear) {
    const std::array<gpu::Target, 1> colors = {
        {{.view = c.view(targets.texel),
          .clear = clear,
          .clear_value = {.color = {.float32 = {0, 0, 0, -KINO_BACKDROP_COLOR}}}}}};
    const gpu::Target depth{.view = c.view(targets.depth), .clear = clear};
    const graph::TextureDesc size = c.desc(targets.depth);
    c.commands().begin_rendering({size.width, size.height}, colors, &depth);
}

void write(PassBuilder& b, SampleTargets& targets) {
    targets.texel = b.write(targets.texel, Use::color_attachment);
    targets.depth = b.write(targets.depth, Use::depth_attachment);
}

void add_seed(FrameGraph& graph, const SurfaceTargets& ground, const MeshList& list,
              SampleTargets& targets) {
    graph.add_pass(
        "samples/seed", "meshes",
        [&](PassBuilder& b) {
            for (const graph::TextureId id : {ground.albedo, ground.view_z, ground.normal}) {
                b.read(id, Use::fragment_read);
            }
            write(b, targets);
        },
        [ground, targets = targets, near_m = list.view.near_m](PassContext& c) {
            gpu::PipelineDesc desc;
            desc.name = "samples/seed";
            desc.vertex = kSampleSeedVertex;
            desc.fragment = kSampleSeed;
            desc.bindings.assign(3, gpu::Binding::texture);
            desc.push_bytes = kMeshPushBytes;
            desc.color_formats = {kTexelFormat};
            desc.depth_format = kDepthFormat;
            desc.depth_test = gpu::DepthTest::any_writes;
            desc.samples = kSurfaceSamples;
            begin(c, targets, false);
            if (c.bind(desc,
                       {c.bound(ground.albedo), c.bound(ground.view_z), c.bound(ground.normal)})) {
                c.commands().constants(shared::MeshView{.near_m = near_m});
                c.commands().draw(3);
            }
            c.commands().end_rendering();
        });
}

}  // namespace

SampleTargets add_sample_surface(FrameGraph& graph, const View& view, const SurfaceTargets& ground,
                                 const MeshList& list, bool background_only) {
    if (list.count == 0) return {};
    const auto width = static_cast<std::uint32_t>(view.width);
    const auto height = static_cast<std::uint32_t>(view.height);
    const auto make = [&](const char* name, VkFormat format) {
        return graph.create_texture(name, {width, height, format, kSurfaceSamples});
    };
    SampleTargets targets{.texel = make("sample texels", kTexelFormat),
                          .depth = make("sample depth", kDepthFormat)};
    if (!background_only) add_seed(graph, ground, list, targets);
    graph.add_pass(
        "samples/meshes", "meshes",
        [&](PassBuilder& b) {
            MeshDrawer::declare(b, list);
            write(b, targets);
        },
        [list, targets, background_only](PassContext& c) {
            MeshShader shader;
            shader.name = "samples/meshes";
            shader.fragment = kMeshSamples;
            shader.color_formats = {kTexelFormat};
            shader.samples = kSurfaceSamples;
            begin(c, targets, background_only);
            (void)MeshDrawer::record(c, list, shader);  // a failure fails the frame
            c.commands().end_rendering();
        });
    return targets;
}

}  // namespace kino
