#pragma once

#include <cstdint>
#include <vector>

#include "viz/light/light_lists.h"
#include "viz/light/light_records.h"

namespace kino {

/// Lists made by the processor that records the frame (GPU Pro 4, Tiled Forward Shading, 4.4): for
/// each light the tiles under its exact screen rectangle; counted, summed, filled, so that lists
/// ascend and no capacity is needed. It has no depths to look at: lists are longer than culled
/// ones.
struct HostLists {
    std::vector<std::uint32_t> headers;  ///< first index and count of each cell, tiles by rows
    std::vector<std::uint32_t> indices;  ///< into PackedLights::records
    std::uint32_t tiles_x = 0, tiles_y = 0;
};

/// With more than one slice, cells are tiles of a slice of depth, nearest slice first (clustered
/// shading, Olsson et al. 2012): slice floor(log(z / near_m) * slice_scale), clamped.
struct DepthSlices {
    std::uint32_t count = 1;
    double near_m = 0.05;
    double scale = 1;
};
[[nodiscard]] HostLists make_host_lists(const PackedLights& packed, const View& view,
                                        std::uint32_t tile_px, const DepthSlices& slices = {});

/// The same as add_light_lists() for a surface of any depths, opaque or blended.
[[nodiscard]] LightLists add_host_light_lists(graph::FrameGraph& graph, const Scene& scene,
                                              const View& view, std::uint32_t tile_px);

/// Brings lists that the host made onto the device.
[[nodiscard]] LightLists add_made_lists(graph::FrameGraph& graph, PackedLights packed,
                                        HostLists made, const View& view, std::uint32_t tile_px);

}  // namespace kino
