#pragma once

#include <cstdint>
#include <vector>

#include "viz/graph/executor.h"
#include "viz/light/light_lists.h"
#include "viz/light/light_shared.h"
#include "viz/light/material_upload.h"

namespace kino {

/// What every shader that walks light lists over a thin surface is set up with, whether it draws
/// the whole picture or walks a list of pixels.
struct ShadeSetup {
    ShadeInputs inputs;
    MaterialBuffers materials;  ///< valid where the surface has objects
    shared::ListShadeParams params{};
    std::vector<std::uint32_t> constants;

    [[nodiscard]] bool has_materials() const { return inputs.surface.object.valid(); }
    /// Declares everything below as read.
    void read(graph::PassBuilder& b, graph::Use use) const;
    /// Bindings 0 to 6: albedo, view_z, normal, lights, headers, indices, shadow masks.
    [[nodiscard]] static std::vector<gpu::Binding> bindings();
    [[nodiscard]] std::vector<gpu::Bound> bound(const graph::PassContext& c) const;
    /// Appends objects, materials and lobes, if the surface has objects.
    void append_materials(const graph::PassContext& c, std::vector<gpu::Binding>& kinds,
                          std::vector<gpu::Bound>& bound) const;
};

/// Uploads materials where they are called for. `view` may be smaller than the lists' view.
[[nodiscard]] ShadeSetup make_shade_setup(graph::FrameGraph& graph, const Scene& scene,
                                          const View& view, const ShadeInputs& inputs);

}  // namespace kino
