#include "viz/light/light_lists.h"

#include <algorithm>
#include <vector>

#include "base/check.h"
#include "viz/graph/executor.h"
#include "viz/light/buffer_upload.h"
#include "viz/light/light_records.h"
#include "viz/light/light_shared.h"

namespace kino {
namespace {

using graph::BufferId;
using graph::FrameGraph;
using graph::PassBuilder;
using graph::PassContext;
using graph::Use;

constexpr std::uint32_t kTileBounds[] = {
#include "tile_bounds_comp.inc"
};
constexpr std::uint32_t kMacroCull[] = {
#include "macro_cull_comp.inc"
};
constexpr std::uint32_t kTileCull[] = {
#include "tile_cull_comp.inc"
};
constexpr std::uint32_t kListSums[] = {
#include "list_sums_comp.inc"
};
constexpr std::uint32_t kListStatistics[] = {
#include "list_statistics_comp.inc"
};

constexpr std::uint32_t kChunkWords = 8;

struct CullBuffers {
    BufferId bounds;
    BufferId volumes;
    BufferId words;  ///< valid with two levels
};

/// Everything the passes of one set of lists share.
struct Culling {
    LightListOptions options;
    shared::CullParams params;
    std::uint32_t macro_tiles = 4;
    bool spots = false;
    std::uint32_t room_tiles = 0;  ///< what memory is made for, not less than there are
    std::uint32_t room_macros = 0;

    [[nodiscard]] std::uint32_t cells() const {
        return options.for_blended ? 0u : static_cast<std::uint32_t>(options.cells);
    }
    [[nodiscard]] std::uint32_t tiles() const { return params.tiles.x * params.tiles.y; }
};

BufferId add_bounds(FrameGraph& graph, const Culling& culling, graph::TextureId view_z) {
    BufferId bounds =
        graph.create_buffer("tile bounds", {culling.room_tiles * sizeof(shared::TileBounds)});
    const auto execute = [=](PassContext& c) {
        gpu::PipelineDesc desc;
        desc.name = "light/tile bounds";
        desc.compute = kTileBounds;
        desc.bindings = {gpu::Binding::texture, gpu::Binding::storage};
        desc.push_bytes = sizeof(culling.params);
        desc.constants = {culling.options.tile_px, culling.cells(), culling.options.cell_count,
                          culling.options.for_blended ? 1u : 0u};
        if (!c.bind(desc, {c.bound(view_z), c.bound(bounds)})) return;
        c.commands().constants(culling.params);
        c.commands().dispatch((culling.tiles() + 63) / 64);
    };
    graph.add_pass(
        "light/tile bounds", "cull",
        [&](PassBuilder& b) {
            b.read(view_z, Use::compute_read);
            bounds = b.write(bounds, Use::compute_write);
        },
        execute);
    return bounds;
}

BufferId add_macro_cull(FrameGraph& graph, const Culling& culling, const CullBuffers& in) {
    const shared::CullParams& p = culling.params;
    BufferId words = graph.create_buffer(
        "lights of macro tiles",
        {roomy_bytes<std::uint32_t>(std::size_t{culling.room_macros} * p.words)});
    const auto execute = [=](PassContext& c) {
        gpu::PipelineDesc desc;
        desc.name = "light/macro cull";
        desc.compute = kMacroCull;
        desc.bindings = {gpu::Binding::word_quads, gpu::Binding::word_quads, gpu::Binding::storage};
        desc.push_bytes = sizeof(culling.params);
        desc.constants = {culling.options.tile_px, 0, 32, 0, culling.macro_tiles, kChunkWords};
        if (!c.bind(desc, {c.bound(in.bounds), c.bound(in.volumes), c.bound(words)})) return;
        c.commands().constants(culling.params);
        c.commands().dispatch((culling.params.macros + 63) / 64,
                              (culling.params.words + kChunkWords - 1) / kChunkWords);
    };
    graph.add_pass(
        "light/macro cull", "cull",
        [&](PassBuilder& b) {
            b.read(in.bounds, Use::compute_read);
            b.read(in.volumes, Use::compute_read);
            words = b.write(words, Use::compute_write);
        },
        execute);
    return words;
}

enum class Stage : std::uint8_t { at_once, count, fill };

void add_tile_cull(FrameGraph& graph, const Culling& culling, const CullBuffers& in,
                   LightLists& lists, Stage stage) {
    const std::uint32_t lanes = culling.params.macros * culling.macro_tiles * culling.macro_tiles;
    const BufferId words = culling.options.two_level ? in.words : in.bounds;
    const auto execute = [=, headers = lists.headers, indices = lists.indices,
                          counters = lists.counters, lights = lists.lights](PassContext& c) {
        gpu::PipelineDesc desc;
        desc.name = "light/tile cull";
        desc.compute = kTileCull;
        using gpu::Binding;
        desc.bindings = {Binding::word_quads, Binding::word_quads, Binding::word_quads,
                         Binding::words,      Binding::storage,    Binding::storage,
                         Binding::storage};
        desc.push_bytes = sizeof(culling.params);
        desc.constants = {culling.options.tile_px,
                          culling.cells(),
                          culling.options.cell_count,
                          culling.spots ? 1u : 0u,
                          culling.macro_tiles,
                          culling.options.two_level ? 1u : 0u,
                          static_cast<std::uint32_t>(stage)};
        if (!c.bind(desc, {c.bound(in.bounds), c.bound(in.volumes), c.bound(lights), c.bound(words),
                           c.bound(headers), c.bound(indices), c.bound(counters)})) {
            return;
        }
        c.commands().constants(culling.params);
        c.commands().dispatch((lanes + 63) / 64);
    };
    graph.add_pass(
        stage == Stage::count ? "light/tile count" : "light/tile cull", "cull",
        [&](PassBuilder& b) {
            for (const BufferId id : {in.bounds, in.volumes, lists.lights, words}) {
                b.read(id, Use::compute_read);
            }
            lists.headers = b.write(lists.headers, Use::compute_write);
            lists.indices = b.write(lists.indices, Use::compute_write);
            lists.counters = b.write(lists.counters, Use::compute_write);
        },
        execute);
}

/// Replaces headers that count by headers that say where.
void add_sums(FrameGraph& graph, const Culling& culling, LightLists& lists) {
    const BufferId counted = lists.headers;
    BufferId headers =
        graph.create_buffer("light headers", {std::uint64_t{culling.room_tiles} * 8});
    const auto execute = [=, counters = lists.counters](PassContext& c) {
        gpu::PipelineDesc desc;
        desc.name = "light/list sums";
        desc.compute = kListSums;
        desc.bindings = {gpu::Binding::word_pairs, gpu::Binding::storage, gpu::Binding::storage};
        desc.push_bytes = sizeof(culling.params);
        if (!c.bind(desc, {c.bound(counted), c.bound(headers), c.bound(counters)})) return;
        c.commands().constants(culling.params);
        c.commands().dispatch(1);
    };
    graph.add_pass(
        "light/list sums", "cull",
        [&](PassBuilder& b) {
            b.read(counted, Use::compute_read);
            headers = b.write(headers, Use::compute_write);
            lists.counters = b.write(lists.counters, Use::compute_write);
        },
        execute);
    lists.headers = headers;
}

/// Lights and volumes onto the device, counters to zero.
BufferId add_upload(FrameGraph& graph, PackedLights packed, LightLists& lists,
                    std::uint32_t spawned = 0) {
    if (packed.records.empty()) packed.records.emplace_back();
    const bool culled = lists.tile_px != 0;
    lists.lights = graph.create_buffer(
        "lights", {roomy_bytes<shared::LightRecord>(packed.records.size() + spawned)});
    BufferId volumes;
    if (culled) {
        volumes = graph.create_buffer(
            "light volumes", {roomy_bytes<shared::LightVolume>(packed.volumes.size() + spawned)});
        lists.counters = graph.create_buffer("light counters", {sizeof(shared::LightListCounters)});
    }
    const auto execute = [=, lights = lists.lights, counters = lists.counters,
                          found = std::move(packed)](PassContext& c) {
        write_buffer(c, lights, found.records);
        if (!culled) return;
        write_buffer(c, volumes, found.volumes);
        c.commands().fill(c.buffer(counters), 0);
    };
    graph.add_pass(
        "light/upload", "cull",
        [&](PassBuilder& b) {
            lists.lights = b.write(lists.lights, Use::transfer_write);
            if (!culled) return;
            volumes = b.write(volumes, Use::transfer_write);
            lists.counters = b.write(lists.counters, Use::transfer_write);
        },
        execute);
    return volumes;
}

}  // namespace

bool wants_light_lists(const Scene& scene) {
    return std::count_if(scene.lights.begin(), scene.lights.end(), [](const Light& light) {
               return light.kind != LightKind::directional && is_usable(light);
           }) > static_cast<std::ptrdiff_t>(kLightsWithoutLists);
}

LightLists add_light_lists(FrameGraph& graph, const Scene& scene, const View& view,
                           graph::TextureId view_z, const LightListOptions& options,
                           const SpawnedLights& spawned) {
    KINO_CHECK(options.tile_px == 8 || options.tile_px == 16 || options.tile_px == 32);
    KINO_CHECK(options.capacity > 0 && options.cell_count >= 1 && options.cell_count <= 32);
    PackedLights packed = pack_lights(scene, view, options.capacity, options.parts);
    LightLists lists;
    lists.width = static_cast<std::uint32_t>(view.width);
    lists.height = static_cast<std::uint32_t>(view.height);
    lists.global_count = packed.global_count;
    lists.local_count = packed.local_count + spawned.count;
    lists.has_spots = packed.has_spots || spawned.count > 0;
    lists.has_masks = packed.has_masks;
    lists.check = packed.check;
    if (packed.local_count <= kLightsWithoutLists && spawned.count == 0) {
        (void)add_upload(graph, std::move(packed), lists);
        return lists;
    }
    lists.tile_px = options.tile_px;
    lists.tiles_x = (lists.width + options.tile_px - 1) / options.tile_px;
    lists.tiles_y = (lists.height + options.tile_px - 1) / options.tile_px;
    Culling culling{.options = options,
                    .macro_tiles = options.tile_px == 8 ? 8u : 4u,
                    .spots = packed.has_spots};
    const std::uint32_t macros_x = (lists.tiles_x + culling.macro_tiles - 1) / culling.macro_tiles;
    const std::uint32_t macros_y = (lists.tiles_y + culling.macro_tiles - 1) / culling.macro_tiles;
    const Projection& k = view.projection;
    culling.params = {.k = {k.fx, k.fy, k.cx, k.cy},
                      .size = {lists.width, lists.height},
                      .tiles = {lists.tiles_x, lists.tiles_y},
                      .macros_x = macros_x,
                      .macros = macros_x * macros_y,
                      .locals = lists.local_count,
                      .first_local = packed.global_count,
                      .words = (lists.local_count + 31) / 32,
                      .capacity = std::min(options.capacity, lists.local_count),
                      .pool = options.pool,
                      .near_m = static_cast<float>(k.near_m)};
    const VkExtent2D room_px = graph.room({lists.width, lists.height});
    const auto room_of = [&](std::uint32_t tile_px) {
        return ((room_px.width + tile_px - 1) / tile_px) *
               ((room_px.height + tile_px - 1) / tile_px);
    };
    culling.room_tiles = room_of(options.tile_px);
    culling.room_macros = room_of(options.tile_px * culling.macro_tiles);
    const std::uint64_t tiles = culling.room_tiles;
    CullBuffers buffers;
    SpawnTargets targets{.records = {},
                         .volumes = {},
                         .first_record = packed.global_count + packed.local_count,
                         .first_volume = packed.local_count};
    buffers.volumes = add_upload(graph, std::move(packed), lists, spawned.count);
    if (spawned.count > 0) {
        targets.records = lists.lights;
        targets.volumes = buffers.volumes;
        spawned.add(graph, targets);
        lists.lights = targets.records;
        buffers.volumes = targets.volumes;
    }
    buffers.bounds = add_bounds(graph, culling, view_z);
    if (options.two_level) buffers.words = add_macro_cull(graph, culling, buffers);
    lists.headers = graph.create_buffer("light headers", {tiles * 8});
    const std::uint64_t room =
        options.pool != 0 ? std::uint64_t{options.pool} : tiles * culling.params.capacity;
    lists.indices = graph.create_buffer("light indices", {room * 4});
    if (options.pool == 0) {
        add_tile_cull(graph, culling, buffers, lists, Stage::at_once);
    } else {
        add_tile_cull(graph, culling, buffers, lists, Stage::count);
        add_sums(graph, culling, lists);
        add_tile_cull(graph, culling, buffers, lists, Stage::fill);
    }
    return lists;
}

BufferId add_light_statistics(FrameGraph& graph, const LightLists& lists) {
    KINO_CHECK(lists.tile_px != 0);
    BufferId counters = lists.counters;
    const shared::CullParams params{.tiles = {lists.tiles_x, lists.tiles_y}};
    const auto execute = [=](PassContext& c) {
        gpu::PipelineDesc desc;
        desc.name = "light/list statistics";
        desc.compute = kListStatistics;
        desc.bindings = {gpu::Binding::word_pairs, gpu::Binding::storage};
        desc.push_bytes = sizeof(params);
        if (!c.bind(desc, {c.bound(lists.headers), c.bound(counters)})) return;
        c.commands().constants(params);
        c.commands().dispatch((lists.tiles_x * lists.tiles_y + 63) / 64);
    };
    graph.add_pass(
        "light/list statistics", "debug",
        [&](PassBuilder& b) {
            b.read(lists.headers, Use::compute_read);
            counters = b.write(counters, Use::compute_write);
        },
        execute);
    return counters;
}

}  // namespace kino
