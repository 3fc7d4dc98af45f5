#include <array>

#include "viz/surface/depth_passes.h"

namespace kino {

void write_targets(graph::PassBuilder& builder, SurfaceTargets& targets) {
    for (graph::TextureId* id : {&targets.albedo, &targets.view_z, &targets.normal, &targets.id}) {
        if (id->valid()) *id = builder.write(*id, graph::Use::color_attachment);
    }
}

std::vector<VkFormat> target_formats(const graph::PassContext& context,
                                     const SurfaceTargets& targets) {
    std::vector<VkFormat> formats;
    for (const graph::TextureId id : {targets.albedo, targets.view_z, targets.normal, targets.id}) {
        formats.push_back(id.valid() ? context.desc(id).format : VK_FORMAT_UNDEFINED);
    }
    while (!formats.empty() && formats.back() == VK_FORMAT_UNDEFINED) formats.pop_back();
    return formats;
}

void begin_targets(graph::PassContext& context, const SurfaceTargets& targets, bool clear,
                   const gpu::Target* depth) {
    std::vector<gpu::Target> colors;
    const std::size_t count = target_formats(context, targets).size();
    const std::array<graph::TextureId, 4> ids = {targets.albedo, targets.view_z, targets.normal,
                                                 targets.id};
    for (std::size_t i = 0; i < count; ++i) {
        gpu::Target target;
        if (ids[i].valid()) target.view = context.view(ids[i]);
        target.clear = clear && ids[i].valid();
        if (i == 3) target.clear_value.color.uint32[0] = UINT32_MAX;
        colors.push_back(target);
    }
    const graph::TextureDesc desc = context.desc(targets.albedo);
    context.commands().begin_rendering({desc.width, desc.height}, colors, depth);
}

}  // namespace kino
