#pragma once

#include <vector>

#include "mesh_world.h"
#include "viz/surface/mesh_formats.h"

namespace kino::test {

/// Draws of several vertex formats in one static pool, put together by hand: what the product's
/// own lists look like from below.
class MeshMix {
  public:
    explicit MeshMix(gpu::Device& device) : device_(device) {}

    /// Adds vertices once; returns their number for draw(). `indices`: corner numbers.
    std::size_t add(const PackedVertices& packed, const std::vector<std::uint32_t>& indices);
    /// One draw of them; quantized boxes are scaled back here.
    void draw(std::size_t vertices, const glm::dmat4& view_from_object, std::uint32_t object,
              const glm::vec3& color = glm::vec3(1));

    /// Copies everything to the device. Its buffers live as long as the mix.
    [[nodiscard]] MeshList list(graph::FrameGraph& graph, const View& view,
                                MeshListOptions options = {});

    std::vector<shared::MeshDraw> rows;
    std::uint32_t formats = 0;

  private:
    struct Placed {
        PackedVertices packed;
        std::uint32_t first = 0;  ///< in units of the format
        std::uint32_t first_index = 0;
        std::uint32_t index_count = 0;
    };
    gpu::Device& device_;
    std::vector<Placed> placed_;
    std::vector<std::uint32_t> words_;
    std::vector<std::uint32_t> indices_;
    gpu::Buffer vertex_buffer_, index_buffer_, row_buffer_, command_buffer_, number_buffer_;
};

}  // namespace kino::test
