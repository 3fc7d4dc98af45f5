#include "viz/accel/morton.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace kino {

glm::vec3 centroid_of(const Triangle& t) {
    return (t.a + t.b + t.c) * (1.0f / 3.0f);
}

CentroidBox centroid_box(std::span<const Triangle> triangles) {
    constexpr float kInf = std::numeric_limits<float>::infinity();
    CentroidBox box{glm::vec3(kInf), glm::vec3(-kInf)};
    for (const Triangle& triangle : triangles) {
        const glm::vec3 p = centroid_of(triangle);
        for (int k = 0; k < 3; ++k) {
            box.lo[k] = std::min(box.lo[k], p[k]);
            box.hi[k] = std::max(box.hi[k], p[k]);
        }
    }
    return box;
}

shared::MortonFrame morton_frame(const CentroidBox& box, AxisRule rule) {
    shared::MortonFrame frame{};
    if (!(box.lo.x <= box.hi.x)) return frame;
    const glm::vec3 extent = box.hi - box.lo;
    glm::vec3 edge = extent;
    std::array<int, 3> bits{};
    for (int bit = kMortonBits - 1; bit >= 0; --bit) {
        int axis = (kMortonBits - 1 - bit) % 3;
        if (rule == AxisRule::longest_cell) {
            // The first of equal ones; one of the others where the longest has all its bits.
            float longest = -1;
            for (int k = 0; k < 3; ++k) {
                const bool longer =
                    edge[k] > longest && bits[static_cast<std::size_t>(k)] < kMostAxisBits;
                axis = longer ? k : axis;
                longest = longer ? edge[k] : longest;
            }
            edge[axis] *= 0.5f;
        }
        ++bits[static_cast<std::size_t>(axis)];
        (bit < 15 ? frame.axes_lo : frame.axes_hi) |= static_cast<std::uint32_t>(axis)
                                                      << (2 * (bit % 15));
    }
    frame.lo = box.lo;
    for (int k = 0; k < 3; ++k) {
        frame.cells[k] = static_cast<float>(1u << bits[static_cast<std::size_t>(k)]);
        frame.scale[k] = extent[k] > 0 ? frame.cells[k] * (1.0f / extent[k]) : 0.0f;
        // Of an extent so small that the quotient overflows, nothing can be told apart.
        if (!std::isfinite(frame.scale[k])) frame.scale[k] = 0;
    }
    return frame;
}

int axis_of_bit(const shared::MortonFrame& frame, int bit) {
    const std::uint32_t axes = bit < 15 ? frame.axes_lo : frame.axes_hi;
    return static_cast<int>((axes >> (2 * (bit % 15))) & 3u);
}

MortonCoder::MortonCoder(const shared::MortonFrame& frame) : frame_(frame), scattered_{} {
    std::array<int, 3> taken{};  // bits of the cell's number that have found their place
    for (int bit = 0; bit < kMortonBits; ++bit) {
        const auto axis = static_cast<std::size_t>(axis_of_bit(frame, bit));
        const int from = taken[axis]++;
        auto& half = scattered_[axis][from < 10 ? 0 : 1];
        for (std::uint32_t cell = 0; cell < half.size(); ++cell) {
            half[cell] |= ((cell >> (from % 10)) & 1u) << bit;
        }
    }
}

std::uint32_t MortonCoder::operator()(const glm::vec3& place) const {
    std::uint32_t code = 0;
    for (int k = 0; k < 3; ++k) {
        const float cell = (place[k] - frame_.lo[k]) * frame_.scale[k];
        const auto number =
            static_cast<std::uint32_t>(std::max(0.0f, std::min(cell, frame_.cells[k] - 1.0f)));
        const auto& scattered = scattered_[static_cast<std::size_t>(k)];
        code |= scattered[0][number & 1023u] | scattered[1][number >> 10];
    }
    return code;
}

void radix_sort(std::vector<CodedTriangle>& items) {
    std::vector<CodedTriangle> other(items.size());
    for (int shift = 0; shift < 32; shift += 8) {
        std::array<std::size_t, 257> first{};
        for (const CodedTriangle& item : items) ++first[((item.code >> shift) & 255u) + 1];
        for (std::size_t digit = 1; digit < 257; ++digit) first[digit] += first[digit - 1];
        for (const CodedTriangle& item : items) other[first[(item.code >> shift) & 255u]++] = item;
        std::swap(items, other);
    }
}

}  // namespace kino
