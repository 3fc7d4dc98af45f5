#include "sensor/filters/hole_filter.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numbers>

namespace kino {

std::span<const filters::Setting<HoleParameters>> HoleParameters::settings() {
    using P = HoleParameters;
    static constexpr std::array kSettings = {
        filters::setting<&P::gap>("gap", 1, 250, "widest hole that is bridged, px"),
        filters::setting<&P::steps>("steps", 0, 50,
                                    "jump that is no surface, sensor steps of 0.00307 1/m"),
        filters::setting<&P::angle_deg>("angle", 0, 89, "steepest surface drawn across, degrees"),
        filters::setting<&P::focal_px>("focal", 0, 100000,
                                       "focal length, px; 0: 0.893 of the width"),
        filters::setting<&P::edge>("edge", 0, 250,
                                   "widest hole between two surfaces that both share, px"),
        filters::setting<&P::background>(
            "background", 0, 1,
            "1: wider holes between two surfaces get the farther, 0: no hole between two gets any"),
    };
    return kSettings;
}

Result<std::unique_ptr<HoleFilter>> HoleFilter::create(const HoleParameters& parameters,
                                                       FilterOptions options) {
    KINO_TRY(filters::check_settings("holes", parameters));
    return std::unique_ptr<HoleFilter>(new HoleFilter(parameters, options));
}

HoleFilter::HoleFilter(const HoleParameters& parameters, FilterOptions options)
    : parameters_(parameters), run_(filters::choose(options.simd)) {}

float HoleFilter::Bridge::at(int step) const {
    const int before_middle = gap + 1 - 2 * step;
    if (!one_surface && shared && before_middle > 0) return from_z;
    if (!one_surface && shared && before_middle < 0) return to_z;
    if (!one_surface) return std::max(from_z, to_z);
    const float z = 1.0f / (from_inverse + slope * static_cast<float>(step));
    // Rounding must not leave the range of the two sides: equal sides give their own value.
    return std::clamp(z, std::min(from_z, to_z), std::max(from_z, to_z));
}

HoleFilter::Bridge HoleFilter::bridge(float from_z, float to_z, int gap) const {
    const float from = 1.0f / from_z;
    const float to = 1.0f / to_z;
    const float reach = static_cast<float>(gap + 1);
    const float limit = step_ + slope_ * reach * std::min(from, to);
    return {.from_z = from_z,
            .to_z = to_z,
            .from_inverse = from,
            .slope = (to - from) / reach,
            .gap = gap,
            .one_surface = std::abs(to - from) <= limit,
            .shared = gap <= parameters_.edge};
}

void HoleFilter::fill_column(int x, int first, int end, Image<float>& out) {
    const int gap = end - first;
    if (gap > parameters_.gap) return;
    const Bridge across = bridge(out.at(x, first - 1), out.at(x, end), gap);
    if (!across.one_surface && !parameters_.background) return;
    for (int y = first; y < end; ++y) {
        out.at(x, y) = across.at(y - first + 1);
        column_gap_[static_cast<std::size_t>(y) * static_cast<std::size_t>(out.width()) +
                    static_cast<std::size_t>(x)] = static_cast<std::uint8_t>(gap);
    }
}

void HoleFilter::fill_span(int y, int first, int end, Image<float>& out) {
    const int gap = end - first;
    if (gap > parameters_.gap) return;
    float* row = out.row(y);
    const Bridge across = bridge(row[first - 1], row[end], gap);
    if (!across.one_surface && !parameters_.background) return;
    const std::uint8_t* column_gap =
        column_gap_.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(out.width());
    for (int x = first; x < end; ++x) {
        const float z = across.at(x - first + 1);
        const int other = column_gap[x];
        if (other == 0 || gap < other || (gap == other && z > row[x])) row[x] = z;
    }
}

// Holes begin and end where the bits of a row differ from those of the row above.
void HoleFilter::fill_columns(int y, const std::uint64_t* bits, Image<float>& out) {
    const std::uint64_t* above = bits - words_;
    for (int word = 0; word < words_; ++word) {
        std::uint64_t changed = bits[word] ^ (y > 0 ? above[word] : 0);
        while (changed != 0) {
            const int bit = std::countr_zero(changed);
            changed &= changed - 1;
            const int x = word * 64 + bit;
            int& start = hole_start_[static_cast<std::size_t>(x)];
            if ((bits[word] >> bit & 1) == 0) {
                start = y;
            } else if (start > 0) {
                fill_column(x, start, y, out);
            }
        }
    }
}

void HoleFilter::fill_row(int y, const std::uint64_t* bits, Image<float>& out) {
    int start = -1;
    std::uint64_t before = 0;  // the last pixel of the word to the left
    for (int word = 0; word < words_; ++word) {
        std::uint64_t changed = bits[word] ^ (bits[word] << 1 | before);
        before = bits[word] >> 63;
        while (changed != 0) {
            const int bit = std::countr_zero(changed);
            changed &= changed - 1;
            const int x = word * 64 + bit;
            if (x >= out.width()) return;
            if ((bits[word] >> bit & 1) == 0) {
                start = x;
            } else if (start > 0) {
                fill_span(y, start, x, out);
            }
        }
    }
}

void HoleFilter::apply(const Image<float>& in, Image<float>& out) {
    const int width = in.width();
    const int height = in.height();
    out.resize(width, height);
    words_ = (width + 63) / 64;
    bits_.resize(static_cast<std::size_t>(words_) * static_cast<std::size_t>(height));
    hole_start_.assign(static_cast<std::size_t>(width), -1);
    column_gap_.assign(in.size(), 0);
    const double focal =
        parameters_.focal_px > 0 ? parameters_.focal_px : kKinectFocalShare * width;
    step_ = static_cast<float>(parameters_.steps * kKinectStepPerM);
    slope_ = static_cast<float>(std::tan(parameters_.angle_deg * std::numbers::pi / 180) / focal);
    const auto bits_of = [&](int y) { return bits_.data() + std::ptrdiff_t{y} * words_; };
    for (int y = 0; y < height; ++y) {
        run_.classify(in.row(y), static_cast<std::size_t>(width), out.row(y), bits_of(y));
        fill_columns(y, bits_of(y), out);
    }
    for (int y = 0; y < height; ++y) fill_row(y, bits_of(y), out);
}

}  // namespace kino
