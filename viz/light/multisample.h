#pragma once

#include <cstdint>

#include "viz/graph/graph.h"
#include "viz/light/light_lists.h"
#include "viz/scene/scene.h"
#include "viz/scene/view.h"
#include "viz/surface/mesh_drawer.h"

namespace kino {

/// How the samples of a pixel become its colour.
enum class SampleResolve : std::uint8_t {
    linear,   ///< the mean of their light
    as_shown  ///< the mean after exposure and tone curve: edges of what is very bright stay smooth
};

constexpr std::uint32_t kMostSamples = 4;

/// A depth prepass: opaque meshes into `depth` (any number of samples), which is returned. No pass
/// for an empty list.
[[nodiscard]] graph::TextureId add_mesh_depths(graph::FrameGraph& graph, const MeshList& list,
                                               graph::TextureId depth);

/// The view with twice the pixels each way. Light lists made for it and the depths below count all
/// four samples of every pixel.
[[nodiscard]] View sample_view(const View& view);
/// The four samples of each pixel of `depth` as view depths, 2 x 2 pixels for one.
[[nodiscard]] graph::TextureId add_sample_depths(graph::FrameGraph& graph, const View& view,
                                                 graph::TextureId depth);
/// The same tiles for sample_view(), as far as there are such large ones.
[[nodiscard]] LightListOptions sample_lists(LightListOptions options);

/// A picture (kSceneLinearFormat) in each of four samples.
[[nodiscard]] graph::TextureId add_spread(graph::FrameGraph& graph, graph::TextureId picture);
/// One sample a pixel again. What all samples agree on keeps its bits.
[[nodiscard]] graph::TextureId add_resolve(graph::FrameGraph& graph, const Scene& scene,
                                           graph::TextureId samples, SampleResolve resolve);

}  // namespace kino
