#include "sensor/clip_depth.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

namespace kino {
namespace {

constexpr int kFraction = 16;
constexpr int kFull = 765 * kFraction;
/// Chroma cells farther apart than this (sum of both differences, of 255) belong to two surfaces.
constexpr int kSameSurfaceChroma = 24;
constexpr int kEdgeRadius = 2;

/// Nearest point of black (0,0,0) - blue (0,0,255) - cyan (0,255,255) - white (255,255,255), as
/// r + g + b there. Inputs are 0..255 with four fraction bits and may lie a little outside.
int ramp_position(int r, int g, int b) {
    constexpr int kTop = 255 * kFraction;
    const auto inside = [&](int v) { return std::clamp(v, 0, kTop); };
    const auto square = [](int v) { return static_cast<std::int64_t>(v) * v; };
    const std::int64_t blue = square(r) + square(g) + square(b - inside(b));
    const std::int64_t cyan = square(r) + square(g - inside(g)) + square(b - kTop);
    const std::int64_t white = square(r - inside(r)) + square(g - kTop) + square(b - kTop);
    if (blue <= cyan && blue <= white) return inside(b);
    if (cyan <= white) return kTop + inside(g);
    return 2 * kTop + inside(r);
}

struct Chroma {
    int u = 0;  ///< times 16
    int v = 0;
};

/// Chroma at a luma pixel: the four cells around it weighted 9:3:3:1 (chroma sits in the middle of
/// its 2x2 pixels); a cell unlike the pixel's own is replaced by it.
Chroma chroma_at(const YuvPicture& picture, int x, int y) {
    const int cx = x / 2;
    const int cy = y / 2;
    const int nx = std::clamp(cx + (x % 2 == 0 ? -1 : 1), 0, picture.u.width() - 1);
    const int ny = std::clamp(cy + (y % 2 == 0 ? -1 : 1), 0, picture.u.height() - 1);
    const int u = picture.u.at(cx, cy);
    const int v = picture.v.at(cx, cy);
    Chroma sum{9 * u, 9 * v};
    const auto add = [&](int px, int py, int weight) {
        const int pu = picture.u.at(px, py);
        const int pv = picture.v.at(px, py);
        const bool same = std::abs(pu - u) + std::abs(pv - v) <= kSameSurfaceChroma;
        sum.u += weight * (same ? pu : u);
        sum.v += weight * (same ? pv : v);
    };
    add(nx, cy, 3);
    add(cx, ny, 3);
    add(nx, ny, 1);
    return sum;
}

}  // namespace

void ClipDepth::read_codes(const YuvPicture& picture) {
    const int width = picture.y.width();
    const int height = picture.y.height();
    code_.resize(width, height);
    if (description_.code == ClipCode::luma) {
        for (int y = 0; y < height; ++y) {
            for (int x = 0; x < width; ++x) {
                const int luma = std::clamp(picture.y.at(x, y) - 16, 0, 219);
                code_.at(x, y) = static_cast<std::int16_t>((luma * kFull + 109) / 219);
            }
        }
        return;
    }
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const Chroma chroma = chroma_at(picture, x, y);
            // ITU-R BT.601 limited range in 1/1024; luma brought to chroma's sixteenths.
            const int l = 1192 * kFraction * (picture.y.at(x, y) - 16);
            const int u = chroma.u - 128 * kFraction;
            const int v = chroma.v - 128 * kFraction;
            const int r = (l + 1634 * v) / 1024;
            const int g = (l - 401 * u - 832 * v) / 1024;
            const int b = (l + 2066 * u) / 1024;
            code_.at(x, y) = static_cast<std::int16_t>(ramp_position(r, g, b));
        }
    }
}

void ClipDepth::find_spans() {
    const int width = code_.width();
    const int height = code_.height();
    for (Image<std::int16_t>* image : {&low_, &high_, &row_low_, &row_high_}) {
        image->resize(width, height);
    }
    for (int y = 0; y < height; ++y) {
        const std::int16_t* in = code_.row(y);
        for (int x = 0; x < width; ++x) {
            const int from = std::max(0, x - kEdgeRadius);
            const int to = std::min(width - 1, x + kEdgeRadius);
            const auto [low, high] = std::minmax_element(in + from, in + to + 1);
            row_low_.at(x, y) = *low;
            row_high_.at(x, y) = *high;
        }
    }
    for (int y = 0; y < height; ++y) {
        std::copy_n(row_low_.row(y), width, low_.row(y));
        std::copy_n(row_high_.row(y), width, high_.row(y));
        for (int ny = std::max(0, y - kEdgeRadius); ny <= std::min(height - 1, y + kEdgeRadius);
             ++ny) {
            const std::int16_t* other_low = row_low_.row(ny);
            const std::int16_t* other_high = row_high_.row(ny);
            for (int x = 0; x < width; ++x) {
                low_.at(x, y) = std::min(low_.at(x, y), other_low[x]);
                high_.at(x, y) = std::max(high_.at(x, y), other_high[x]);
            }
        }
    }
}

void ClipDepth::decode(const YuvPicture& picture, Image<std::uint16_t>& out) {
    read_codes(picture);
    const int span_limit = static_cast<int>(std::lround(description_.edge_span * kFull));
    if (span_limit > 0) find_spans();
    const int least = static_cast<int>(std::ceil(description_.invalid_below * kFull));
    const double dark = description_.dark_m * kClipUnitsPerMetre;
    const double per_code = (description_.bright_m * kClipUnitsPerMetre - dark) / kFull;
    out.resize(code_.width(), code_.height());
    for (int y = 0; y < code_.height(); ++y) {
        for (int x = 0; x < code_.width(); ++x) {
            const int code = code_.at(x, y);
            bool valid = code >= least;
            if (valid && span_limit > 0) {
                const int low = low_.at(x, y);
                const int high = high_.at(x, y);
                const int quarter = (high - low) / 4;
                valid = high - low <= span_limit || code <= low + quarter || code >= high - quarter;
            }
            out.at(x, y) =
                valid ? static_cast<std::uint16_t>(std::lround(dark + per_code * code)) : 0;
        }
    }
}

}  // namespace kino
