#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "base/error.h"
#include "viz/graph/executor.h"
#include "viz/graph/graph.h"
#include "viz/scene/scene.h"
#include "viz/scene/view.h"
#include "viz/surface/depth_rasterizer.h"
#include "viz/surface/mesh_table.h"

namespace kino {

constexpr VkFormat kObjectFormat = VK_FORMAT_R32_UINT;  ///< material << 16 | object id; 0: live
constexpr VkFormat kDepthFormat = VK_FORMAT_D32_SFLOAT;

/// How draws are submitted; every way makes the same picture.
enum class MeshSubmit : std::uint8_t {
    multi_draw,     ///< culled on the device, one indirect call
    one_call_each,  ///< the rival
    fixed_function  ///< vertex buffers and attributes, one call each: the reference
};

/// What becomes of draws that the device culls.
enum class MeshCulling : std::uint8_t {
    none,
    zero_instance,  ///< their commands stay, with no instance
    compact         ///< the others move up, in order; their count is read from a buffer
};

/// How a draw of the one call finds its row of the table.
enum class DrawIdCarrier : std::uint8_t {
    first_instance,  ///< gl_BaseInstance
    draw_id,         ///< gl_DrawID
    attribute,       ///< an instance-rate attribute, as the source has it
    /// No draws at all but instances of one: for lists whose rows all show one mesh (checked by
    /// nobody). Not culled. The rival where nothing differs from draw to draw.
    instance,
    pushed  ///< one call each only: a push constant before every call, as engines do
};

struct MeshListOptions {
    MeshFilter filter = MeshFilter::opaque;
    std::uint32_t kinds = kAllKinds;  ///< bits 1 << MaterialKind
    MeshSubmit submit = MeshSubmit::multi_draw;
    MeshCulling culling = MeshCulling::zero_instance;
    DrawIdCarrier carrier = DrawIdCarrier::first_instance;
    /// With fewer draws than this the host culls them, and there is no dispatch.
    std::uint32_t cull_on_device_from = 65;
    /// compact: visible draws beyond this many are dropped and counted; 0: as many as there are.
    std::uint32_t capacity = 0;
};

/// The draws of one view on their way through a frame: made by MeshDrawer::prepare(), recorded as
/// often as wanted.
struct MeshList {
    MeshListOptions options;
    std::uint32_t count = 0;    ///< rows of the table; 0: nothing to draw, the ids are invalid
    std::uint32_t refused = 0;  ///< nodes left out: matrices that are not finite
    std::uint32_t formats = 0;
    bool textured = false;
    shared::MeshView view{};
    graph::BufferId rows;      ///< shared::MeshDraw
    graph::BufferId vertices;  ///< the static pool
    graph::BufferId skinned;   ///< this frame's positions and normals; or `vertices`
    graph::BufferId indices;
    graph::BufferId texels;       ///< or `vertices`
    graph::BufferId commands;     ///< VkDrawIndexedIndirectCommand
    graph::BufferId row_of_draw;  ///< what gl_DrawID or the attribute points at; or `rows`
    graph::BufferId counters;     ///< shared::MeshCounters; invalid where the host culled
    std::shared_ptr<const std::vector<VkDrawIndexedIndirectCommand>> calls;  ///< one call each
    std::shared_ptr<const std::vector<shared::MeshDraw>> host_rows;          ///< fixed function
};

/// Bindings, specialisation constants and bytes of push constants that belong to the mesh drawer;
/// a fragment shader's own come after them.
constexpr std::uint32_t kMeshBindings = 5;
constexpr std::uint32_t kMeshConstants = 3;
constexpr std::uint32_t kMeshPushBytes = sizeof(shared::MeshView);

/// A fragment shader for meshes, and what it is drawn into. The shader includes
/// viz/surface/mesh_fragment.glsl, which gives it position, normal, base colour and object of the
/// fragment. The vertex shader is the drawer's, so depths are the same bits in every pass that
/// draws the same list: DepthTest::equal works after a depth prepass.
struct MeshShader {
    std::string name;                         ///< of the pipeline: "light/forward"
    std::span<const std::uint32_t> fragment;  ///< empty: depth alone
    std::vector<gpu::Binding> bindings;       ///< its own, from binding kMeshBindings on
    std::vector<std::uint32_t> constants;     ///< its own, from constant_id kMeshConstants on
    std::vector<VkFormat> color_formats;
    VkFormat depth_format = kDepthFormat;
    gpu::DepthTest depth_test = gpu::DepthTest::nearer_writes;
    gpu::Blend blend = gpu::Blend::none;
    std::uint32_t samples = 1;
};

/// Draws the scene's meshes into the thin surface by programmable vertex pulling (GPU Pro 4,
/// Riccio and Lilley). Keeps the meshes' device memory while scenes show them. Both sides of a
/// triangle are drawn; normals are of the side that is seen.
class MeshDrawer {
  public:
    explicit MeshDrawer(gpu::Device& device);
    ~MeshDrawer();
    MeshDrawer(const MeshDrawer&) = delete;
    MeshDrawer& operator=(const MeshDrawer&) = delete;

    /// Brings the device's copies up to date: new meshes in, those that no node shows out. No
    /// device work for a scene without meshes, and bytes() is 0 after it. The GPU must not be
    /// reading (Executor::run waits). Once a frame, before prepare() and add().
    [[nodiscard]] Result<void> upload(const Scene& scene);

    /// Adds the passes that draw the opaque meshes over what `targets` hold, nearer wins: all
    /// targets must have been written already. `depth` (kDepthFormat, reversed) must hold the
    /// depths of what is there (add_depth_seed). targets.albedo gets the base colour as sRGB,
    /// alpha 1. No pass where the scene has no opaque mesh.
    struct Drawn {
        SurfaceTargets targets;
        graph::TextureId depth;
    };
    [[nodiscard]] Drawn add(graph::FrameGraph& graph, const Scene& scene, const View& view,
                            SurfaceTargets targets, graph::TextureId depth,
                            MeshSubmit submit = MeshSubmit::multi_draw) const;
    /// The same for draws that are prepared already.
    [[nodiscard]] Drawn add(graph::FrameGraph& graph, const MeshList& list, SurfaceTargets targets,
                            graph::TextureId depth) const;

    /// For forward and blended passes: adds the skinning and culling passes of one view's draws,
    /// if any are needed. The list lives as long as the frame.
    [[nodiscard]] MeshList prepare(graph::FrameGraph& graph, const Scene& scene, const View& view,
                                   const MeshListOptions& options) const;
    /// Declares what recording the list reads; in the set-up of the pass that records it.
    static void declare(graph::PassBuilder& builder, const MeshList& list);
    /// Records the draws of a list that is not empty, between begin_rendering and end_rendering of
    /// a pass that declared it. `own` are the shader's resources, one for each of its bindings;
    /// `own_constants` follow MeshView in the push constants. False where the pipeline cannot be
    /// made; the frame then fails.
    [[nodiscard]] static bool record(graph::PassContext& context, const MeshList& list,
                                     const MeshShader& shader, std::span<const gpu::Bound> own = {},
                                     std::span<const std::byte> own_constants = {});

    [[nodiscard]] std::uint64_t bytes() const;
    [[nodiscard]] const MeshPool& pool() const;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

/// Fills `depth` (kDepthFormat) with the depths of `view_z`, 0 where nothing is: what mesh passes
/// test against. Writes every pixel. `within`, where it has an area: `view_z` is nothing outside.
[[nodiscard]] graph::TextureId add_depth_seed(graph::FrameGraph& graph, const View& view,
                                              graph::TextureId view_z, graph::TextureId depth,
                                              VkRect2D within = {});

}  // namespace kino
