#pragma once

#include <cstdint>
#include <glm/vec2.hpp>

#include "viz/graph/graph.h"
#include "viz/quality/framebuffer_lod.h"

namespace kino {

/// What of the light between coarse texels calls for a finer tile.
enum class RegionMeasure : std::uint8_t {
    gradient,  ///< its step from one texel to the next
    bend       ///< what a straight line between a texel's two neighbours misses at it
};

/// Resizing by regions: the whole picture is shaded at the coarsest level of a chain of factors
/// r0 2^m; tiles where that may not do are shaded again at the next finer level, down to r0.
struct RegionLodOptions {
    int levels = 2;  ///< beyond r0; the coarsest factor is r0 2^levels, 1 to 3
    RegionMeasure measure = RegionMeasure::gradient;
    /// From this on a tile is shaded finer: of the square root of light as shown, 0 to 1, between
    /// coarse neighbours of one surface. 0: every tile, which is r0 everywhere; infinite: none.
    float limit = 0.06f;
    /// And where more than this share of a tile's texels resembles no coarse one; infinite: never.
    float doubt_share = 0.02f;
};

/// True where regions can be told apart: geometry-aware and packed, with guides.
[[nodiscard]] bool allows_regions(const FramebufferLodOptions& lod);

/// Tiles of one level that are shaded anew, in the order of rows, the same list every run.
struct LodRegionList {
    graph::BufferId pixels;    ///< y << 16 | x, texels of the level, tile by tile
    graph::BufferId dispatch;  ///< shared::LodRegionState (lod_regions_shared.h)
    std::uint32_t most = 0;    ///< all texels of the level
    graph::BufferId texels;    ///< a word a tile, by rows: how many are listed, all or none
    glm::uvec2 tiles{0};
    std::uint32_t side = 0;  ///< of a tile, texels
};

/// Side of a tile at level `level` of the chain from r0, texels: about 64 pixels of the output.
[[nodiscard]] std::uint32_t region_side(double r0, const RegionLodOptions& options, int level);

/// Chooses the tiles of `fine` by the light of `coarse_linear` (RGBA16F, of `coarse`, which was
/// picked from `fine`). `parents`: the level before's choice; what stayed coarse there stays so;
/// null at the coarsest. Four passes. allows_regions(lod) must hold.
[[nodiscard]] LodRegionList add_region_list(
    graph::FrameGraph& graph, graph::TextureId coarse_linear, const CoarseSurface& coarse,
    const CoarseSurface& fine, std::uint32_t side, float exposure, const LodRegionList* parents,
    const RegionLodOptions& options, const FramebufferLodOptions& lod);

}  // namespace kino
