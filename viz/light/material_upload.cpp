#include "viz/light/material_upload.h"

#include "viz/graph/executor.h"
#include "viz/light/material_table.h"

namespace kino {

MaterialBuffers add_material_upload(graph::FrameGraph& graph, const Scene& scene) {
    MaterialTable table = flatten_materials(scene.materials);
    if (table.lobes.empty()) table.lobes.emplace_back();
    MaterialBuffers buffers{
        .materials =
            graph.create_buffer("materials", {kMaxMaterials * sizeof(shared::MaterialRecord)}),
        .lobes = graph.create_buffer(
            "lobes", {kMaxMaterials * kMaxLayers * kMaxLobes * sizeof(shared::LobeRecord)}),
        .lobe_kinds = table.lobe_kinds};
    const auto execute = [=](graph::PassContext& c) {
        // At most 2 and 16 KB: one update each.
        const VkCommandBuffer commands = c.commands().handle();
        vkCmdUpdateBuffer(commands, c.buffer(buffers.materials), 0,
                          table.materials.size() * sizeof(shared::MaterialRecord),
                          table.materials.data());
        vkCmdUpdateBuffer(commands, c.buffer(buffers.lobes), 0,
                          table.lobes.size() * sizeof(shared::LobeRecord), table.lobes.data());
    };
    graph.add_pass(
        "light/materials", "light",
        [&](graph::PassBuilder& b) {
            buffers.materials = b.write(buffers.materials, graph::Use::transfer_write);
            buffers.lobes = b.write(buffers.lobes, graph::Use::transfer_write);
        },
        execute);
    return buffers;
}

}  // namespace kino
