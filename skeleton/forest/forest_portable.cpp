#include <algorithm>

#include "skeleton/forest/forest_kernel.h"

namespace kino::forest {
namespace {

std::int32_t sample(const WalkImage& image, std::int32_t x, std::int32_t y) {
    x = std::clamp<std::int32_t>(x, 0, image.max_x);
    y = std::clamp<std::int32_t>(y, 0, image.max_y);
    return image.depth[y * image.pitch + x];
}

std::int32_t pixels(std::int32_t offset, std::int32_t scale) {
    return (offset * scale + (1 << 14)) >> 15;
}

void walk(const WalkNode* nodes, const WalkImage& image, const WalkPixels& in, std::int32_t* leaf) {
    for (std::size_t i = 0; i < in.count; ++i) {
        const auto x = static_cast<std::int32_t>(in.xy[i] & 0xFFFF);
        const auto y = static_cast<std::int32_t>(in.xy[i] >> 16);
        const std::int32_t scale = in.scale[i];
        std::int32_t at = 0;
        while (nodes[at].child != at) {
            const WalkNode& n = nodes[at];
            const std::int32_t difference =
                sample(image, x + pixels(n.ux, scale), y + pixels(n.uy, scale)) -
                sample(image, x + pixels(n.vx, scale), y + pixels(n.vy, scale));
            at = n.child + (difference > n.threshold ? 1 : 0);
        }
        leaf[i] = static_cast<std::uint16_t>(nodes[at].ux) |
                  static_cast<std::int32_t>(static_cast<std::uint16_t>(nodes[at].uy)) << 16;
    }
}

void vote(const VoteInput& in, std::size_t count, std::uint8_t* label, std::uint16_t* votes) {
    for (std::size_t i = 0; i < count; ++i) {
        std::uint16_t sum[32] = {};
        for (int t = 0; t < in.tree_count; ++t) {
            const std::uint8_t* row =
                in.distributions + static_cast<std::ptrdiff_t>(in.leaf[t][i]) * in.stride;
            for (int l = 0; l < in.stride; ++l)
                sum[l] = static_cast<std::uint16_t>(sum[l] + row[l]);
        }
        const std::uint16_t* best = std::max_element(sum, sum + in.stride);
        label[i] = static_cast<std::uint8_t>(best - sum);
        votes[i] = *best;
    }
}

void probe(const WalkImage& image, const ProbePixel& p, const std::uint32_t* u,
           const std::uint32_t* v, std::size_t count, std::int32_t* out) {
    const auto x = static_cast<std::int32_t>(p.xy & 0xFFFF);
    const auto y = static_cast<std::int32_t>(p.xy >> 16);
    const auto depth = [&](std::uint32_t offset) {
        return sample(image, x + pixels(static_cast<std::int16_t>(offset & 0xFFFF), p.scale),
                      y + pixels(static_cast<std::int16_t>(offset >> 16), p.scale));
    };
    const std::int32_t own = sample(image, x, y);
    for (std::size_t i = 0; i < count; ++i) {
        const std::int32_t difference = depth(u[i]) - (v == nullptr ? own : depth(v[i]));
        out[i] = std::clamp(difference, p.low, p.high) - p.low;
    }
}

}  // namespace

const Functions& portable_functions() {
    static constexpr Functions kPortable{walk, vote, probe, "portable"};
    return kPortable;
}

const Functions& functions() {
#if defined(__x86_64__)
    static const Functions& best = [&]() -> const Functions& {
        const bool able = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
        const Functions* avx2 = able ? avx2_functions() : nullptr;
        return avx2 != nullptr ? *avx2 : portable_functions();
    }();
    return best;
#else
    return portable_functions();
#endif
}

#if !defined(__x86_64__)
const Functions* avx2_functions() {
    return nullptr;
}
#endif

}  // namespace kino::forest
