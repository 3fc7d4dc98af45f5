#include "viz/surface/mesh_drawer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

#include "base/check.h"
#include "viz/surface/mesh_pool.h"

namespace kino {
namespace {

using graph::BufferId;
using graph::FrameGraph;
using graph::PassBuilder;
using graph::PassContext;
using graph::Use;

constexpr std::uint32_t kSkinCode[] = {
#include "mesh_skin_comp.inc"
};
constexpr std::uint32_t kCullCode[] = {
#include "mesh_cull_comp.inc"
};

/// What one list writes from the host; kept from frame to frame.
struct ListBuffers {
    gpu::Buffer rows;
    gpu::Buffer commands;
    gpu::Buffer row_of_draw;
    gpu::Buffer joints;
};

template <class T>
Result<void> write_all(gpu::Device& device, gpu::Buffer& buffer, const char* name,
                       const std::vector<T>& values) {
    const std::uint64_t bytes = values.size() * sizeof(T);
    if (buffer.bytes() < bytes) {
        // Half as much again, so that a slowly growing scene does not make a buffer every frame.
        const std::uint64_t room = bytes + bytes / 2;
        buffer = gpu::Buffer();
        KINO_ASSIGN(buffer, gpu::Buffer::create(device, name, room, gpu::MemoryUse::upload));
    }
    buffer.write(std::span<const T>(values));
    return {};
}

shared::MeshView mesh_view(const View& view) {
    return {.k = {view.projection.fx, view.projection.fy, view.projection.cx, view.projection.cy},
            .target = {view.width, view.height},
            .near_m = static_cast<float>(view.projection.near_m),
            .first_row = 0};
}

/// Skins every posed mesh of the list into one buffer.
BufferId add_skinning(FrameGraph& graph, const MeshTable& table, BufferId vertices,
                      BufferId weights, BufferId joints) {
    BufferId skinned =
        graph.create_buffer("skinned vertices", {std::uint64_t{table.skinned_vertices} * 32});
    graph.add_pass(
        "meshes/skin", "meshes",
        [&](PassBuilder& b) {
            for (const BufferId id : {vertices, weights, joints}) b.read(id, Use::compute_read);
            skinned = b.write(skinned, Use::compute_write);
        },
        [=, skins = table.skins, out = skinned](PassContext& c) {
            // A pipeline for each way of blending that the frame has.
            for (const std::uint32_t blend : {KINO_SKIN_LINEAR, KINO_SKIN_DUAL}) {
                if (std::none_of(skins.begin(), skins.end(),
                                 [&](const auto& skin) { return skin.blend == blend; })) {
                    continue;
                }
                gpu::PipelineDesc desc;
                desc.name = blend == KINO_SKIN_DUAL ? "meshes/skin dual" : "meshes/skin";
                desc.compute = kSkinCode;
                desc.bindings = {gpu::Binding::word_quads, gpu::Binding::word_quads,
                                 gpu::Binding::storage, gpu::Binding::storage};
                desc.constants = {blend};
                desc.push_bytes = sizeof(shared::MeshSkin);
                if (!c.bind(desc,
                            {c.bound(vertices), c.bound(weights), c.bound(joints), c.bound(out)})) {
                    return;
                }
                for (const shared::MeshSkin& skin : skins) {
                    if (skin.blend != blend) continue;
                    c.commands().constants(skin);
                    c.commands().dispatch((skin.vertices + 63) / 64);
                }
            }
        });
    return skinned;
}

/// Culls on the device; fills in the list's commands, rows and counters.
void add_culling(FrameGraph& graph, const View& view, MeshList& list) {
    const bool compact = list.options.culling == MeshCulling::compact;
    const std::uint32_t runs = (list.count + KINO_CULL_RUN - 1) / KINO_CULL_RUN;
    shared::MeshCull params{.near_m = list.view.near_m,
                            .draws = list.count,
                            .capacity = list.options.capacity > 0
                                            ? std::min(list.options.capacity, list.count)
                                            : list.count,
                            .mode = compact ? KINO_CULL_COMPACT : KINO_CULL_ZERO_INSTANCE};
    if (!compact) params.capacity = list.count;
    const auto sides = side_planes(view);
    for (std::size_t i = 0; i < sides.size(); ++i) params.side[i] = glm::vec4(sides[i], 0.0);
    list.commands = graph.create_buffer("mesh commands", {std::uint64_t{params.capacity} * 20});
    list.counters = graph.create_buffer("mesh counters", {sizeof(shared::MeshCounters)});
    BufferId rows_out = list.row_of_draw;
    if (compact) {
        rows_out = graph.create_buffer("mesh row of draw", {std::uint64_t{params.capacity} * 4});
    }
    BufferId scratch =
        compact ? graph.create_buffer("mesh runs", {std::uint64_t{runs} * 4}) : BufferId{};
    graph.add_pass(
        "meshes/clear counters", "meshes",
        [&](PassBuilder& b) { list.counters = b.write(list.counters, Use::transfer_write); },
        [id = list.counters](PassContext& c) { c.commands().fill(c.buffer(id), 0); });
    const auto step = [&](const char* name, std::uint32_t number, std::uint32_t lanes) {
        graph.add_pass(
            name, "meshes",
            [&](PassBuilder& b) {
                b.read(list.rows, Use::compute_read);
                list.commands = b.write(list.commands, Use::compute_write);
                list.counters = b.write(list.counters, Use::compute_write);
                if (compact) {
                    rows_out = b.write(rows_out, Use::compute_write);
                    scratch = b.write(scratch, Use::compute_write);
                }
            },
            [=, rows = list.rows, commands = list.commands, out = rows_out,
             counters = list.counters](PassContext& c) {
                gpu::PipelineDesc desc;
                desc.name = "meshes/cull";
                desc.compute = kCullCode;
                desc.bindings.assign(5, gpu::Binding::storage);
                desc.bindings[0] = gpu::Binding::word_quads;
                desc.push_bytes = sizeof(params);
                desc.constants = {number};
                const BufferId spare = counters;
                if (!c.bind(desc, {c.bound(rows), c.bound(commands), c.bound(compact ? out : spare),
                                   c.bound(counters), c.bound(compact ? scratch : spare)})) {
                    return;
                }
                c.commands().constants(params);
                c.commands().dispatch((lanes + 63) / 64);
            });
    };
    if (compact) {
        step("meshes/cull count", 1, runs);
        step("meshes/cull order", 2, 1);
        step("meshes/cull emit", 3, runs);
        list.row_of_draw = rows_out;
    } else {
        step("meshes/cull", 0, runs);
    }
}

}  // namespace

struct MeshDrawer::State {
    explicit State(gpu::Device& d) : device(d), pool(d) {}

    gpu::Device& device;
    MeshPool pool;
    std::vector<std::unique_ptr<ListBuffers>> lists;
    std::size_t lists_used = 0;
    std::optional<Error> error;
};

MeshDrawer::MeshDrawer(gpu::Device& device) : state_(std::make_unique<State>(device)) {}
MeshDrawer::~MeshDrawer() = default;

Result<void> MeshDrawer::upload(const Scene& scene) {
    state_->lists_used = 0;
    if (state_->error) return fail(*std::exchange(state_->error, std::nullopt));
    std::vector<std::shared_ptr<const MeshAsset>> wanted;
    for (const MeshNode& node : scene.meshes) {
        if (node.mesh != nullptr) wanted.push_back(node.mesh);
    }
    KINO_TRY(state_->pool.keep(wanted));
    // Textures of materials that no mesh shows cost nothing.
    KINO_TRY(
        state_->pool.keep_textures(wanted.empty() ? std::vector<Material>() : scene.materials));
    if (wanted.empty()) state_->lists.clear();
    return {};
}

std::uint64_t MeshDrawer::bytes() const {
    std::uint64_t bytes = state_->pool.bytes();
    for (const auto& list : state_->lists) {
        bytes += list->rows.bytes() + list->commands.bytes() + list->row_of_draw.bytes() +
                 list->joints.bytes();
    }
    return bytes;
}

const MeshPool& MeshDrawer::pool() const {
    return state_->pool;
}

MeshList MeshDrawer::prepare(FrameGraph& graph, const Scene& scene, const View& view,
                             const MeshListOptions& options) const {
    MeshList list{.options = options, .view = mesh_view(view)};
    if (!state_->device.info().has_multi_draw) list.options.submit = MeshSubmit::fixed_function;
    // Draws one by one have no number; only they can push one.
    const bool one_call_each = list.options.submit == MeshSubmit::one_call_each;
    const bool pushes = options.carrier == DrawIdCarrier::pushed;
    if (list.options.submit == MeshSubmit::multi_draw ? pushes : !(pushes && one_call_each)) {
        list.options.carrier = DrawIdCarrier::first_instance;
    }
    if (list.options.carrier == DrawIdCarrier::instance) {
        list.options.culling = MeshCulling::none;
    }
    if (scene.meshes.empty()) return list;
    MeshTable table = make_mesh_table(scene, view, state_->pool, options.filter, options.kinds);
    list.refused = table.refused;
    const auto rows = static_cast<std::uint32_t>(table.rows.size());
    const bool on_device = list.options.submit == MeshSubmit::multi_draw &&
                           list.options.culling != MeshCulling::none &&
                           rows >= options.cull_on_device_from;
    std::vector<VkDrawIndexedIndirectCommand> calls;
    std::vector<std::uint32_t> row_of_draw;
    if (!on_device) {
        const auto sides = side_planes(view);
        for (std::uint32_t row = 0; row < rows; ++row) {
            const shared::MeshDraw& draw = table.rows[row];
            if (list.options.culling != MeshCulling::none &&
                !may_be_seen(sides, view.projection.near_m, draw.sphere_center,
                             draw.sphere_radius_m)) {
                continue;
            }
            calls.push_back(call_of(draw, row));
            row_of_draw.push_back(row);
        }
        if (calls.empty()) return list;
    }
    if (rows == 0) return list;

    if (state_->lists_used == state_->lists.size()) {
        state_->lists.push_back(std::make_unique<ListBuffers>());
    }
    ListBuffers& memory = *state_->lists[state_->lists_used++];
    // The attribute is found by firstInstance, which is the row, so its list names every row.
    if (on_device || list.options.carrier == DrawIdCarrier::attribute) {
        row_of_draw.resize(rows);
        std::iota(row_of_draw.begin(), row_of_draw.end(), 0u);
    }
    const bool numbered = list.options.carrier == DrawIdCarrier::draw_id ||
                          list.options.carrier == DrawIdCarrier::attribute;
    const auto write = [&]() -> Result<void> {
        KINO_TRY(write_all(state_->device, memory.rows, "mesh rows", table.rows));
        if (numbered) {
            KINO_TRY(
                write_all(state_->device, memory.row_of_draw, "mesh row of draw", row_of_draw));
        }
        if (!calls.empty() && list.options.submit == MeshSubmit::multi_draw) {
            KINO_TRY(write_all(state_->device, memory.commands, "mesh commands", calls));
        }
        if (!table.joint_rows.empty()) {
            KINO_TRY(write_all(state_->device, memory.joints, "mesh joints", table.joint_rows));
        }
        return {};
    };
    if (const Result<void> written = write(); !written) {
        state_->error = written.error();
        return list;
    }
    list.count = rows;
    list.formats = table.formats;
    list.textured = table.textured;
    list.rows = graph.import_buffer("mesh rows", memory.rows);
    list.vertices = graph.import_buffer("mesh vertices", state_->pool.vertices());
    list.indices = graph.import_buffer("mesh indices", state_->pool.indices());
    list.texels = table.textured ? graph.import_buffer("mesh textures", state_->pool.texels())
                                 : list.vertices;
    list.row_of_draw =
        numbered ? graph.import_buffer("mesh row of draw", memory.row_of_draw) : list.rows;
    list.skinned = list.vertices;
    if (!table.skins.empty()) {
        list.skinned = add_skinning(graph, table, list.vertices,
                                    graph.import_buffer("mesh weights", state_->pool.weights()),
                                    graph.import_buffer("mesh joints", memory.joints));
    }
    if (on_device) {
        const BufferId identity = list.row_of_draw;
        add_culling(graph, view, list);
        if (list.options.carrier != DrawIdCarrier::draw_id) list.row_of_draw = identity;
    } else if (list.options.submit == MeshSubmit::multi_draw) {
        list.commands = graph.import_buffer("mesh commands", memory.commands);
        list.calls =
            std::make_shared<const std::vector<VkDrawIndexedIndirectCommand>>(std::move(calls));
    } else {
        list.calls =
            std::make_shared<const std::vector<VkDrawIndexedIndirectCommand>>(std::move(calls));
        list.host_rows =
            std::make_shared<const std::vector<shared::MeshDraw>>(std::move(table.rows));
    }
    return list;
}

MeshDrawer::Drawn MeshDrawer::add(FrameGraph& graph, const Scene& scene, const View& view,
                                  SurfaceTargets targets, graph::TextureId depth,
                                  MeshSubmit submit) const {
    return add(graph, prepare(graph, scene, view, {.submit = submit}), targets, depth);
}

}  // namespace kino
