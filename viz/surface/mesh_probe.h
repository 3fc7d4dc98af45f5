#pragma once

#include <cstdint>

#include "viz/graph/graph.h"
#include "viz/surface/mesh_drawer.h"

namespace kino {

/// Adds a pass that fetches corners 0 .. `corners` - 1 of one row as the vertex shader does, into
/// `out`: three vec4 each (position and 1 if known; normal and u; linear colour and v). `errors`,
/// one word that must hold a number, grows by every corner of a format that is not compiled in.
/// For tests, and for timing the fetch without a rasteriser.
struct MeshProbe {
    graph::BufferId out;
    graph::BufferId errors;
};
[[nodiscard]] MeshProbe add_fetch_probe(graph::FrameGraph& graph, const MeshList& list,
                                        std::uint32_t row, std::uint32_t corners, MeshProbe into);

}  // namespace kino
