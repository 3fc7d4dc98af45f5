#include "viz/quality/edge_band.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace kino {
namespace {

template <class Apart>
Image<std::uint8_t> band_where(int width, int height, int radius, Apart apart) {
    Image<std::uint8_t> band(width, height, 0);
    const auto mark = [&](int x, int y) {
        for (int v = std::max(0, y - radius); v <= std::min(height - 1, y + radius); ++v) {
            for (int u = std::max(0, x - radius); u <= std::min(width - 1, x + radius); ++u) {
                band.at(u, v) = 1;
            }
        }
    };
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            if (x + 1 < width && apart(x, y, x + 1, y)) {
                mark(x, y);
                mark(x + 1, y);
            }
            if (y + 1 < height && apart(x, y, x, y + 1)) {
                mark(x, y);
                mark(x, y + 1);
            }
        }
    }
    return band;
}

}  // namespace

Image<std::uint8_t> depth_edge_band(const Image<float>& z, int radius_px, double relative) {
    return band_where(z.width(), z.height(), radius_px, [&](int x, int y, int u, int v) {
        const double a = z.at(x, y);
        const double b = z.at(u, v);
        if (!(a > 0) || !(b > 0)) return a > 0 || b > 0;
        return std::abs(a - b) > relative * std::min(a, b);
    });
}

Image<std::uint8_t> luma_edge_band(const Image<Rgba8>& picture, int radius_px, double step) {
    const auto luma = [&](int x, int y) {
        const Rgba8 p = picture.at(x, y);
        return 0.299 * p.r + 0.587 * p.g + 0.114 * p.b;
    };
    return band_where(
        picture.width(), picture.height(), radius_px,
        [&](int x, int y, int u, int v) { return std::abs(luma(x, y) - luma(u, v)) > step; });
}

Result<BandError> band_error(const Image<Rgba8>& a, const Image<Rgba8>& b,
                             const Image<std::uint8_t>& band) {
    if (a.width() != b.width() || a.height() != b.height() || a.width() != band.width() ||
        a.height() != band.height()) {
        return fail(fmt::format("the pictures have different sizes: {}x{} and {}x{}", a.width(),
                                a.height(), b.width(), b.height()));
    }
    BandError error;
    std::int64_t squares = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        if (band.pixels()[i] == 0) continue;
        ++error.pixels;
        const Rgba8 p = a.pixels()[i];
        const Rgba8 q = b.pixels()[i];
        for (const int d : {p.r - q.r, p.g - q.g, p.b - q.b}) squares += d * d;
    }
    if (error.pixels > 0) {
        error.mse = static_cast<double>(squares) / (3.0 * static_cast<double>(error.pixels));
    }
    return error;
}

}  // namespace kino
