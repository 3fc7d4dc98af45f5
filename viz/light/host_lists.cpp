#include "viz/light/host_lists.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "viz/graph/executor.h"
#include "viz/light/buffer_upload.h"

namespace kino {
namespace {

struct TileRange {
    std::int64_t from = 0;
    std::int64_t to = -1;  ///< included
};

/// Tiles along one axis whose pixels a sphere may cover: pixels between the two tangents from the
/// eye to its circle in the plane of that axis and z. All where the eye is inside or the circle
/// reaches behind it.
TileRange covered(double c, double z, double r, double f, double center, int pixels,
                  std::uint32_t tile_px) {
    const std::int64_t last = (pixels - 1) / static_cast<int>(tile_px);
    const double squared = c * c + z * z - r * r;
    if (!(z > r) || !(squared > 0)) return {0, last};
    const double root = r * std::sqrt(squared);
    const double scale = 1 / (z * z - r * r);
    // A thousandth of a pixel for rounding.
    const double low = (c * z - root) * scale * f + center + 0.5 - 1e-3;
    const double high = (c * z + root) * scale * f + center + 0.5 + 1e-3;
    const auto tile = [&](double px) {
        return static_cast<std::int64_t>(
            std::clamp(std::floor(px / tile_px), -1.0, static_cast<double>(last) + 1));
    };
    return {std::max<std::int64_t>(tile(low), 0), std::min(tile(high), last)};
}

struct Covered {
    TileRange x, y, slice;
};

Covered covered_cells(const shared::LightVolume& volume, const View& view, std::uint32_t tile_px,
                      const DepthSlices& slices) {
    const glm::dvec3 c(volume.center);
    const double r = volume.radius;
    if (!(c.z + r > 0)) return {};
    const Projection& k = view.projection;
    Covered cells{.x = covered(c.x, c.z, r, k.fx, k.cx, view.width, tile_px),
                  .y = covered(c.y, c.z, r, k.fy, k.cy, view.height, tile_px),
                  .slice = {0, 0}};
    if (slices.count > 1) {
        const auto slice = [&](double z) {
            const double at = std::log(std::max(z, slices.near_m) / slices.near_m) * slices.scale;
            return static_cast<std::int64_t>(std::clamp(at, 0.0, slices.count - 1.0));
        };
        cells.slice = {slice((c.z - r) * (1 - 1e-5)), slice((c.z + r) * (1 + 1e-5))};
    }
    return cells;
}

template <class Visit>
void for_each_cell(const Covered& cells, std::uint32_t tiles_x, std::uint32_t tiles_y,
                   const Visit& visit) {
    for (std::int64_t s = cells.slice.from; s <= cells.slice.to; ++s) {
        for (std::int64_t y = cells.y.from; y <= cells.y.to; ++y) {
            const std::int64_t row = (s * tiles_y + y) * tiles_x;
            for (std::int64_t x = cells.x.from; x <= cells.x.to; ++x) {
                visit(static_cast<std::size_t>(row + x));
            }
        }
    }
}

}  // namespace

HostLists make_host_lists(const PackedLights& packed, const View& view, std::uint32_t tile_px,
                          const DepthSlices& slices) {
    HostLists lists;
    lists.tiles_x = (static_cast<std::uint32_t>(view.width) + tile_px - 1) / tile_px;
    lists.tiles_y = (static_cast<std::uint32_t>(view.height) + tile_px - 1) / tile_px;
    const std::size_t cells = std::size_t{lists.tiles_x} * lists.tiles_y * slices.count;
    std::vector<Covered> covers;
    covers.reserve(packed.volumes.size());
    for (const shared::LightVolume& volume : packed.volumes) {
        covers.push_back(covered_cells(volume, view, tile_px, slices));
    }
    lists.headers.assign(2 * cells, 0);
    for (const Covered& cover : covers) {
        for_each_cell(cover, lists.tiles_x, lists.tiles_y,
                      [&](std::size_t cell) { ++lists.headers[2 * cell + 1]; });
    }
    std::uint32_t sum = 0;
    for (std::size_t cell = 0; cell < cells; ++cell) {
        lists.headers[2 * cell] = sum;
        sum += std::exchange(lists.headers[2 * cell + 1], 0u);
    }
    lists.indices.resize(sum);
    for (std::uint32_t i = 0; i < covers.size(); ++i) {
        for_each_cell(covers[i], lists.tiles_x, lists.tiles_y, [&](std::size_t cell) {
            lists.indices[lists.headers[2 * cell] + lists.headers[2 * cell + 1]++] =
                packed.global_count + i;
        });
    }
    return lists;
}

LightLists add_host_light_lists(graph::FrameGraph& graph, const Scene& scene, const View& view,
                                std::uint32_t tile_px) {
    PackedLights packed = pack_lights(scene, view, UINT32_MAX);
    HostLists made = make_host_lists(packed, view, tile_px);
    return add_made_lists(graph, std::move(packed), std::move(made), view, tile_px);
}

LightLists add_made_lists(graph::FrameGraph& graph, PackedLights packed, HostLists made,
                          const View& view, std::uint32_t tile_px) {
    LightLists lists;
    lists.tile_px = tile_px;
    lists.tiles_x = made.tiles_x;
    lists.tiles_y = made.tiles_y;
    lists.width = static_cast<std::uint32_t>(view.width);
    lists.height = static_cast<std::uint32_t>(view.height);
    lists.global_count = packed.global_count;
    lists.local_count = packed.local_count;
    lists.has_spots = packed.has_spots;
    lists.has_masks = packed.has_masks;
    lists.check = packed.check;
    if (packed.records.empty()) packed.records.emplace_back();
    if (made.indices.empty()) made.indices.push_back(0);
    lists.lights =
        graph.create_buffer("lights", {roomy_bytes<shared::LightRecord>(packed.records.size())});
    lists.headers = graph.create_buffer("light headers", {made.headers.size() * 4});
    lists.indices =
        graph.create_buffer("light indices", {roomy_bytes<std::uint32_t>(made.indices.size())});
    lists.counters = graph.create_buffer("light counters", {sizeof(shared::LightListCounters)});
    const auto execute = [ids = std::array{lists.lights, lists.headers, lists.indices},
                          counters = lists.counters, packed = std::move(packed),
                          made = std::move(made)](graph::PassContext& c) {
        write_buffer(c, ids[0], packed.records);
        write_buffer(c, ids[1], made.headers);
        write_buffer(c, ids[2], made.indices);
        c.commands().fill(c.buffer(counters), 0);
    };
    graph.add_pass(
        "light/upload lists", "cull",
        [&](graph::PassBuilder& b) {
            for (graph::BufferId* id :
                 {&lists.lights, &lists.headers, &lists.indices, &lists.counters}) {
                *id = b.write(*id, graph::Use::transfer_write);
            }
        },
        execute);
    return lists;
}

}  // namespace kino
