#include "viz/surface/mesh_formats.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "base/check.h"

namespace kino {
namespace {

std::uint32_t snorm16(float v) {
    const auto steps = std::lround(std::clamp(v, -1.0f, 1.0f) * 32767.0f);
    return static_cast<std::uint16_t>(static_cast<std::int16_t>(steps));
}

std::uint32_t packed_octahedral(const glm::vec3& n) {
    const float sum = std::abs(n.x) + std::abs(n.y) + std::abs(n.z);
    float x = n.x / sum;
    float y = n.y / sum;
    if (n.z < 0) {
        const float folded_x = (1 - std::abs(y)) * (x >= 0 ? 1.0f : -1.0f);
        y = (1 - std::abs(x)) * (y >= 0 ? 1.0f : -1.0f);
        x = folded_x;
    }
    return snorm16(x) | snorm16(y) << 16;
}

void append(std::vector<std::uint32_t>& words, std::initializer_list<float> values) {
    for (const float v : values) words.push_back(std::bit_cast<std::uint32_t>(v));
}

/// Whole texels of four words, and one to spare for fetches that straddle two.
void pad(std::vector<std::uint32_t>& words) {
    words.resize((words.size() + 3) / 4 * 4 + 4);
}

}  // namespace

PackedVertices pack_static(const MeshAsset& mesh) {
    PackedVertices packed{.format = KINO_FORMAT_STATIC,
                          .words = {},
                          .corners = static_cast<std::uint32_t>(mesh.positions.size())};
    packed.words.reserve(8 * mesh.positions.size());
    for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
        const glm::vec3 p = mesh.positions[v];
        const glm::vec3 n = mesh.normals[v];
        const glm::vec2 uv = mesh.uvs.empty() ? glm::vec2(0) : mesh.uvs[v];
        append(packed.words, {p.x, p.y, p.z, n.x, n.y, n.z, uv.x, uv.y});
    }
    return packed;
}

PackedVertices pack_cloud(std::span<const glm::vec3> positions, std::span<const Rgba8> colors) {
    KINO_CHECK_EQ(positions.size(), colors.size());
    PackedVertices packed{.format = KINO_FORMAT_CLOUD,
                          .words = {},
                          .corners = static_cast<std::uint32_t>(positions.size())};
    for (std::size_t v = 0; v < positions.size(); ++v) {
        append(packed.words, {positions[v].x, positions[v].y, positions[v].z});
        packed.words.push_back(std::bit_cast<std::uint32_t>(colors[v]));
    }
    return packed;
}

PackedVertices pack_quantized(const MeshAsset& mesh) {
    PackedVertices packed{.format = KINO_FORMAT_QUANTIZED,
                          .words = {},
                          .corners = static_cast<std::uint32_t>(mesh.positions.size())};
    glm::vec3 low(INFINITY);
    glm::vec3 high(-INFINITY);
    for (const glm::vec3& p : mesh.positions) {
        low = glm::min(low, p);
        high = glm::max(high, p);
    }
    packed.center = 0.5f * low + 0.5f * high;
    // A flat box still has a size to divide by.
    packed.half = glm::max(high - packed.center, glm::vec3(1e-20f));
    for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
        const glm::vec3 unit = (mesh.positions[v] - packed.center) / packed.half;
        packed.words.push_back(snorm16(unit.x) | snorm16(unit.y) << 16);
        packed.words.push_back(snorm16(unit.z));
        packed.words.push_back(packed_octahedral(mesh.normals[v]));
    }
    pad(packed.words);
    return packed;
}

PackedVertices pack_grid(const DepthGrid& grid) {
    const int width = grid.depth.width();
    const int height = grid.depth.height();
    KINO_CHECK(width >= 2 && height >= 2 && width < 65536 && height < 65536);
    KINO_CHECK(grid.fx > 0 && grid.fy > 0);
    PackedVertices packed{.format = KINO_FORMAT_GRID,
                          .words = {},
                          .corners = static_cast<std::uint32_t>(6 * (width - 1) * (height - 1))};
    packed.words = {static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height)};
    append(packed.words,
           {grid.metres_per_unit, grid.edge_m, 1 / grid.fx, 1 / grid.fy, grid.cx, grid.cy});
    const std::size_t head = packed.words.size();
    packed.words.resize(head + (grid.depth.size() + 1) / 2);
    std::memcpy(packed.words.data() + head, grid.depth.pixels().data(), grid.depth.size() * 2);
    pad(packed.words);
    return packed;
}

}  // namespace kino
