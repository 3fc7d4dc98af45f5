#include "mesh_mix.h"

#include <glm/gtc/matrix_transform.hpp>
#include <glm/packing.hpp>
#include <numeric>

namespace kino::test {
namespace {

std::uint32_t unit_words(std::uint32_t format) {
    switch (format) {
        case KINO_FORMAT_QUANTIZED:
            return 3;
        case KINO_FORMAT_GRID:
        case KINO_FORMAT_CLOUD:
            return 4;
        default:
            return 8;
    }
}

template <class T>
void fill(gpu::Device& device, gpu::Buffer& buffer, const char* name,
          const std::vector<T>& values) {
    auto made =
        gpu::Buffer::create(device, name, values.size() * sizeof(T), gpu::MemoryUse::upload);
    ASSERT_TRUE(made);
    buffer = std::move(*made);
    buffer.write(std::span<const T>(values));
}

}  // namespace

std::size_t MeshMix::add(const PackedVertices& packed, const std::vector<std::uint32_t>& indices) {
    Placed placed{.packed = packed};
    // 96 bytes are whole units of every format, and whole texels.
    while (words_.size() % 24 != 0) words_.push_back(0);
    placed.first = static_cast<std::uint32_t>(words_.size()) / unit_words(packed.format);
    placed.first_index = static_cast<std::uint32_t>(indices_.size());
    placed.index_count = static_cast<std::uint32_t>(indices.size());
    words_.insert(words_.end(), packed.words.begin(), packed.words.end());
    indices_.insert(indices_.end(), indices.begin(), indices.end());
    formats |= 1u << packed.format;
    placed_.push_back(std::move(placed));
    return placed_.size() - 1;
}

void MeshMix::draw(std::size_t vertices, const glm::dmat4& view_from_object, std::uint32_t object,
                   const glm::vec3& color) {
    const Placed& placed = placed_[vertices];
    const glm::dmat4 m =
        view_from_object *
        glm::scale(glm::translate(glm::dmat4(1.0), glm::dvec3(placed.packed.center)),
                   glm::dvec3(placed.packed.half));
    const auto row_of = [&](int r) { return glm::vec4(m[0][r], m[1][r], m[2][r], m[3][r]); };
    const glm::dmat3 normals = glm::transpose(glm::inverse(glm::dmat3(view_from_object)));
    shared::MeshDraw row{};
    row.view_from_object_x = row_of(0);
    row.view_from_object_y = row_of(1);
    row.view_from_object_z = row_of(2);
    row.normal_x = {normals[0][0], normals[1][0], normals[2][0]};
    row.normal_y = {normals[0][1], normals[1][1], normals[2][1]};
    row.normal_z = {normals[0][2], normals[1][2], normals[2][2]};
    row.object = object;
    row.color_rg = glm::packHalf2x16({color.r, color.g});
    row.color_b_texture = glm::packHalf2x16({color.b, 0});
    if (glm::determinant(glm::dmat3(view_from_object)) < 0) row.color_b_texture |= 1u << 31;
    row.sphere_radius_m = 1e6f;
    row.id = placed.packed.format << KINO_FIRST_VERTEX_BITS | placed.first;
    row.first_index = placed.first_index;
    row.index_count = placed.index_count;
    rows.push_back(row);
}

MeshList MeshMix::list(graph::FrameGraph& graph, const View& view, MeshListOptions options) {
    std::vector<VkDrawIndexedIndirectCommand> calls;
    for (std::uint32_t row = 0; row < rows.size(); ++row) calls.push_back(call_of(rows[row], row));
    std::vector<std::uint32_t> numbers(rows.size());
    std::iota(numbers.begin(), numbers.end(), 0u);
    fill(device_, vertex_buffer_, "mix vertices", words_);
    fill(device_, index_buffer_, "mix indices", indices_);
    fill(device_, row_buffer_, "mix rows", rows);
    fill(device_, command_buffer_, "mix commands", calls);
    fill(device_, number_buffer_, "mix numbers", numbers);
    MeshList list{.options = options, .count = static_cast<std::uint32_t>(rows.size())};
    list.formats = formats;
    list.view = {
        .k = {view.projection.fx, view.projection.fy, view.projection.cx, view.projection.cy},
        .target = {view.width, view.height},
        .near_m = static_cast<float>(view.projection.near_m)};
    list.rows = graph.import_buffer("mix rows", row_buffer_);
    list.vertices = list.skinned = list.texels =
        graph.import_buffer("mix vertices", vertex_buffer_);
    list.indices = graph.import_buffer("mix indices", index_buffer_);
    list.commands = graph.import_buffer("mix commands", command_buffer_);
    list.row_of_draw = options.carrier == DrawIdCarrier::first_instance
                           ? list.rows
                           : graph.import_buffer("mix numbers", number_buffer_);
    list.calls =
        std::make_shared<const std::vector<VkDrawIndexedIndirectCommand>>(std::move(calls));
    return list;
}

}  // namespace kino::test
