#pragma once

#include "viz/frame/renderer.h"

namespace kino::test {

constexpr int kWiresWidth = 320;
constexpr int kWiresHeight = 180;

[[nodiscard]] View wires_view();

/// Wires of half a pixel, upright and slanted, half a metre before a wall, under more lights than
/// a shader walks. Lights near the wires do not reach the wall.
[[nodiscard]] Scene wires_scene(int lights);

[[nodiscard]] FrameResult draw_wires(Renderer& renderer, const Scene& scene,
                                     const FrameOptions& options);

}  // namespace kino::test
