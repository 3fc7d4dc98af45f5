#pragma once

#include "viz/graph/graph.h"
#include "viz/scene/scene.h"

namespace kino {

/// True where a material of the scene emits light.
[[nodiscard]] bool wants_emission(const Scene& scene);

/// Adds what the materials of `object` emit to the scene-linear picture of the same size: after a
/// reconstruction that knows light by what surfaces return of it (framebuffer LOD). Returns the
/// picture's new id.
[[nodiscard]] graph::TextureId add_emission_pass(graph::FrameGraph& graph, const Scene& scene,
                                                 graph::TextureId object, graph::TextureId linear);

}  // namespace kino
