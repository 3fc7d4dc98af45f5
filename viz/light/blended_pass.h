#pragma once

#include "viz/graph/graph.h"
#include "viz/light/light_lists.h"
#include "viz/scene/scene.h"
#include "viz/scene/view.h"
#include "viz/surface/mesh_drawer.h"

namespace kino {

/// True where the scene has a mesh with an opacity below 1.
[[nodiscard]] bool wants_blended(const Scene& scene);

/// Draws the blended meshes over the shaded picture, farthest first by their centres, each fragment
/// under the lights of `lists`, which must be made with LightListOptions::for_blended: a light
/// between the camera and the nearest opaque surface counts for them (GPU Pro 4, Tiled Forward
/// Shading, 4.5). Does not write depth. A fragment covers its opacity, and more where it is seen
/// from the side: opacity + (1 - opacity) 0.96 (1 - n.v)^5 after Schlick, as a clear coat would.
/// `linear` is the scene-linear picture (kSceneLinearFormat), `depth` what is opaque; its new id is
/// returned.
[[nodiscard]] graph::TextureId add_blended_pass(graph::FrameGraph& graph, const Scene& scene,
                                                const View& view, const MeshDrawer& meshes,
                                                const LightLists& lists, graph::TextureId linear,
                                                graph::TextureId depth);

}  // namespace kino
