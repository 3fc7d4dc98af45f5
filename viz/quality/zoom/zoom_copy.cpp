#include "viz/quality/zoom/zoom_copy.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <utility>
#include <vector>

#include "base/check.h"
#include "viz/quality/zoom/zoom_rows.h"

namespace kino {
namespace {

using zoom_rows::Kernels;
using zoom_rows::kSlack;
using zoom_rows::Taps;

/// Weights of the pixels before, at and after a block's own at its phase p, summing to 1. The block
/// itself is a box; each pass of the blur is one more, of width z (for even z of z + 1 pixels with
/// half-weight ends, so that it stays centred). One more box makes the tent.
std::array<double, 3> weights_at(int p, int z, ZoomBlur blur) {
    if (blur == ZoomBlur::none) return {0, 1, 0};
    if (blur == ZoomBlur::box) {
        const double off = (2.0 * p + 1 - z) / (2.0 * z);
        return {std::max(0.0, -off), 1 - std::abs(off), std::max(0.0, off)};
    }
    // The mean of the tent's weights under the second box.
    std::array<double, 3> sum{};
    const int reach = z / 2;
    for (int k = -reach; k <= reach; ++k) {
        const double share = (z % 2 == 0 && std::abs(k) == reach ? 0.5 : 1.0) / z;
        const int at = p + k;
        const int block = at < 0 ? -1 : at >= z ? 1 : 0;
        const auto tent = weights_at(at - block * z, z, ZoomBlur::box);
        for (int n = 0; n < 3; ++n) {
            const int tap = n + block;
            // Reach is half a block, where the tent leans to this side: what falls off is 0.
            if (tap >= 0 && tap < 3)
                sum[static_cast<std::size_t>(tap)] += share * tent[static_cast<std::size_t>(n)];
        }
    }
    return sum;
}

std::uint16_t fixed(double weight) {
    return static_cast<std::uint16_t>(std::min(65535.0, std::round(weight * 65536)));
}

Taps taps_of(int z, ZoomBlur blur) {
    Taps taps;
    for (int p = 0; p < z; ++p) {
        const auto w = weights_at(p, z, blur);
        for (int c = 0; c < 4; ++c) {
            taps.before[p][c] = fixed(w[0]);
            taps.at[p][c] = fixed(w[1]);
            taps.after[p][c] = fixed(w[2]);
        }
    }
    return taps;
}

/// Columns of a row of the output that lie within the enlarged picture: [first, last).
struct Inside {
    int first = 0;
    int last = 0;
};

Inside inside_of(int width, int enlarged, int offset) {
    const int first = std::clamp(-offset, 0, width);
    return {first, std::clamp(enlarged - offset, first, width)};
}

void fill_outside(std::uint32_t* row, int width, const Inside& in, std::uint32_t left,
                  std::uint32_t right) {
    std::fill(row, row + in.first, left);
    std::fill(row + in.last, row + width, right);
}

void copy_blocks(const Kernels& kernels, const ImageView<const std::uint32_t>& small, int z,
                 const ImageView<std::uint32_t>& out, glm::ivec2 offset, const Inside& in) {
    std::vector<std::uint32_t> line(z > 1 ? static_cast<std::size_t>(small.width * z) + kSlack : 0);
    int made = -1;
    for (int y = 0; y < out.height; ++y) {
        const int j = std::clamp(y + offset.y, 0, small.height * z - 1) / z;
        const std::uint32_t* from = small.row(j);
        if (z > 1) {
            if (std::exchange(made, j) != j) kernels.replicate(from, small.width, z, line.data());
            from = line.data();
        }
        std::uint32_t* to = out.row(y);
        if (in.first < in.last) {
            std::memcpy(to + in.first, from + in.first + offset.x,
                        static_cast<std::size_t>(in.last - in.first) * 4);
        }
        fill_outside(to, out.width, in, small.row(j)[0], small.row(j)[small.width - 1]);
    }
}

void copy_blurred(const Kernels& kernels, const ImageView<const std::uint32_t>& small, int z,
                  ZoomBlur blur, const ImageView<std::uint32_t>& out, glm::ivec2 offset,
                  const Inside& in) {
    const Taps taps = taps_of(z, blur);
    const std::size_t length = 4 * (static_cast<std::size_t>(small.width * z) + kSlack);
    std::vector<std::uint16_t> lines(3 * length);
    std::array<int, 3> made{-1, -1, -1};
    const auto line = [&](int j) {
        j = std::clamp(j, 0, small.height - 1);
        const auto slot = static_cast<std::size_t>(j % 3);
        std::uint16_t* at = lines.data() + slot * length;
        if (std::exchange(made[slot], j) != j) {
            kernels.blur(small.row(j), small.width, z, taps, at);
        }
        return static_cast<const std::uint16_t*>(at);
    };
    for (int y = 0; y < out.height; ++y) {
        const int enlarged = std::clamp(y + offset.y, 0, small.height * z - 1);
        const int j = enlarged / z;
        const int p = enlarged % z;
        const std::uint16_t weights[3] = {taps.before[p][0], taps.at[p][0], taps.after[p][0]};
        const std::uint16_t* rows[3] = {weights[0] != 0 ? line(j - 1) : nullptr, line(j),
                                        weights[2] != 0 ? line(j + 1) : nullptr};
        const auto blend = [&](int from, int count, std::uint32_t* to) {
            const auto start = [&](const std::uint16_t* row) {
                return row == nullptr ? nullptr : row + 4 * from;
            };
            kernels.blend(start(rows[0]), start(rows[1]), start(rows[2]), weights, count, to);
        };
        std::uint32_t* to = out.row(y);
        if (in.first < in.last) blend(in.first + offset.x, in.last - in.first, to + in.first);
        if (in.first > 0 || in.last < out.width) {
            std::uint32_t left = 0, right = 0;
            blend(0, 1, &left);
            blend(small.width * z - 1, 1, &right);
            fill_outside(to, out.width, in, left, right);
        }
    }
}

std::int64_t enlarge_by(const Kernels& kernels, const ImageView<const std::uint32_t>& small, int z,
                        ZoomBlur blur, const ImageView<std::uint32_t>& out, glm::ivec2 offset) {
    KINO_CHECK(z >= 1 && z <= kMaxZoom && small.width > 0 && small.height > 0);
    KINO_CHECK(small.pitch >= small.width && out.pitch >= out.width);
    if (out.width <= 0 || out.height <= 0) return 0;
    KINO_CHECK(out.row(out.height - 1) + out.width <= small.data ||
               small.row(small.height - 1) + small.width <= out.data);
    const glm::ivec2 enlarged{small.width * z, small.height * z};
    // So far outside that everything is; keeps sums of coordinates from overflowing.
    offset = {std::clamp(offset.x, -out.width, enlarged.x),
              std::clamp(offset.y, -out.height, enlarged.y)};
    const Inside in = inside_of(out.width, enlarged.x, offset.x);
    if (z == 1 || blur == ZoomBlur::none) {
        copy_blocks(kernels, small, z, out, offset, in);
    } else {
        copy_blurred(kernels, small, z, blur, out, offset, in);
    }
    const Inside rows = inside_of(out.height, enlarged.y, offset.y);
    return std::int64_t{out.width} * out.height -
           std::int64_t{in.last - in.first} * (rows.last - rows.first);
}

}  // namespace

std::int64_t enlarge(const ImageView<const std::uint32_t>& small, int z, ZoomBlur blur,
                     const ImageView<std::uint32_t>& out, glm::ivec2 offset) {
    const bool wide = __builtin_cpu_supports("avx2") != 0;
    return enlarge_by(wide ? zoom_rows::avx2() : zoom_rows::portable(), small, z, blur, out,
                      offset);
}

std::int64_t enlarge_portable(const ImageView<const std::uint32_t>& small, int z, ZoomBlur blur,
                              const ImageView<std::uint32_t>& out, glm::ivec2 offset) {
    return enlarge_by(zoom_rows::portable(), small, z, blur, out, offset);
}

}  // namespace kino
