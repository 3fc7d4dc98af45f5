#pragma once

#include <span>
#include <vector>

#include "tests/reference/skinning_reference.h"
#include "viz/graph/executor.h"
#include "viz/surface/mesh_drawer.h"

namespace kino::test {

/// What the device makes of the scene's posed meshes, one after the other, object space. The view
/// must see them.
inline Result<std::vector<SkinnedVertex>> read_skinned(gpu::Device& device, MeshDrawer& drawer,
                                                       graph::Executor& executor,
                                                       const Scene& scene, const View& view,
                                                       graph::FrameReport* report = nullptr) {
    KINO_TRY(drawer.upload(scene));
    graph::FrameGraph graph(executor.history());
    const MeshList list = drawer.prepare(graph, scene, view, {});
    if (list.count == 0 || list.skinned.index == list.vertices.index)
        return fail("nothing is skinned");
    const std::uint64_t bytes = graph.resources()[list.skinned.index].buffer.bytes;
    KINO_ASSIGN(gpu::Buffer host,
                gpu::Buffer::create(device, "read skinned", bytes, gpu::MemoryUse::readback));
    graph::BufferId copy = graph.import_buffer("read skinned", host);
    graph.add_pass(
        "read skinned", "test",
        [&](graph::PassBuilder& b) {
            b.read(list.skinned, graph::Use::transfer_read);
            copy = b.write(copy, graph::Use::transfer_write);
        },
        [&, from = list.skinned](graph::PassContext& c) {
            const VkBufferCopy region{.size = bytes};
            vkCmdCopyBuffer(c.commands().handle(), c.buffer(from), c.buffer(copy), 1, &region);
        });
    graph.require(copy);
    KINO_ASSIGN(const graph::FrameReport ran, executor.run(graph, graph::Timing::frame));
    if (report != nullptr) *report = ran;
    const std::span<const float> words = host.read<float>().first(bytes / 4);
    std::vector<SkinnedVertex> vertices;
    for (std::size_t i = 0; i + 8 <= words.size(); i += 8) {
        const float* w = words.data() + i;
        vertices.push_back({{w[0], w[1], w[2]}, {w[3], w[4], w[5]}});
    }
    return vertices;
}

}  // namespace kino::test
