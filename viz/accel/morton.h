#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "viz/accel/accel_shared.h"
#include "viz/accel/triangle_soup.h"

namespace kino {

/// Which axis each of the 30 bits of a Morton code halves.
enum class AxisRule : std::uint8_t {
    fixed_xyz,    ///< x, y, z in turn, as the source prints it
    longest_cell  ///< the axis along which cells are longest at that bit, once a build
};

constexpr int kMortonBits = 30;
/// Most bits of one axis: what a float tells apart with room to spare.
constexpr int kMostAxisBits = 20;

/// Box of the triangles' centroids; lo > hi where there is no triangle.
struct CentroidBox {
    glm::vec3 lo, hi;
};
[[nodiscard]] glm::vec3 centroid_of(const Triangle& triangle);
[[nodiscard]] CentroidBox centroid_box(std::span<const Triangle> triangles);

/// A flat axis gets scale 0: everything is in its cell 0.
[[nodiscard]] shared::MortonFrame morton_frame(const CentroidBox& box, AxisRule rule);
/// Axis (0 x, 1 y, 2 z) that bit `bit` of the codes halves.
[[nodiscard]] int axis_of_bit(const shared::MortonFrame& frame, int bit);

/// Codes of many places: the table holds what scatters a cell's number over the code's bits.
class MortonCoder {
  public:
    explicit MortonCoder(const shared::MortonFrame& frame);
    [[nodiscard]] std::uint32_t operator()(const glm::vec3& place) const;

  private:
    shared::MortonFrame frame_;
    std::array<std::array<std::array<std::uint32_t, 1024>, 2>, 3> scattered_;
};

/// A triangle's code, and which one it is.
struct CodedTriangle {
    std::uint32_t code = 0;
    std::uint32_t triangle = 0;
    friend bool operator==(const CodedTriangle&, const CodedTriangle&) = default;
};

/// By code, equal ones in the order in which they were: four passes of eight bits.
void radix_sort(std::vector<CodedTriangle>& items);

}  // namespace kino
