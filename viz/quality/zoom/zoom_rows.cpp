#include "viz/quality/zoom/zoom_rows.h"

namespace kino::zoom_rows {
namespace {

std::uint32_t upper(std::uint32_t value, std::uint32_t weight) {
    return value * weight >> 16;
}

std::uint32_t channel_of(std::uint32_t pixel, int channel) {
    return pixel >> 8 * channel & 0xFFu;
}

void replicate_row(const std::uint32_t* small, int count, int z, std::uint32_t* out) {
    for (int i = 0; i < count; ++i) {
        for (int p = 0; p < z; ++p) *out++ = small[i];
    }
}

void blur_row(const std::uint32_t* small, int count, int z, const Taps& taps, std::uint16_t* out) {
    for (int i = 0; i < count; ++i) {
        const std::uint32_t before = small[i > 0 ? i - 1 : 0];
        const std::uint32_t after = small[i + 1 < count ? i + 1 : i];
        for (int p = 0; p < z; ++p) {
            for (int c = 0; c < 4; ++c) {
                *out++ = static_cast<std::uint16_t>(
                    upper(channel_of(before, c) << 8, taps.before[p][c]) +
                    upper(channel_of(small[i], c) << 8, taps.at[p][c]) +
                    upper(channel_of(after, c) << 8, taps.after[p][c]));
            }
        }
    }
}

void blend_rows(const std::uint16_t* before, const std::uint16_t* at, const std::uint16_t* after,
                const std::uint16_t weights[3], int count, std::uint32_t* out) {
    for (int i = 0; i < count; ++i) {
        std::uint32_t pixel = 0;
        for (int c = 0; c < 4; ++c) {
            std::uint32_t sum = 128 + upper(at[4 * i + c], weights[1]);
            if (before != nullptr) sum += upper(before[4 * i + c], weights[0]);
            if (after != nullptr) sum += upper(after[4 * i + c], weights[2]);
            pixel |= (sum >> 8) << 8 * c;
        }
        out[i] = pixel;
    }
}

}  // namespace

const Kernels& portable() {
    static constexpr Kernels kKernels{replicate_row, blur_row, blend_rows};
    return kKernels;
}

}  // namespace kino::zoom_rows
