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
constexpr int kRadius = 2;
/// Far enough below every code that no difference to it is small, and all fit in 16 bits.
constexpr std::int16_t kNothing = -16000;

/// Nearest point of black (0,0,0) - blue (0,0,255) - cyan (0,255,255) - white (255,255,255), as
/// r + g + b there. Inputs are 0..255 with four fraction bits and may lie a little outside.
int ramp_position(int r, int g, int b) {
    constexpr int kTop = 255 * kFraction;
    const auto inside = [&](int v) { return std::clamp(v, 0, kTop); };
    const auto square = [](int v) { return v * v; };
    const int blue = square(r) + square(g) + square(b - inside(b));
    const int cyan = square(r) + square(g - inside(g)) + square(b - kTop);
    const int white = square(r - inside(r)) + square(g - kTop) + square(b - kTop);
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

/// Smallest and largest of `in` within kRadius to either side; plain loops, so they vectorise.
void row_spans(const std::int16_t* in, int width, std::int16_t* low, std::int16_t* high) {
    std::copy_n(in, width, low);
    std::copy_n(in, width, high);
    for (int dx = 1; dx <= std::min(kRadius, width - 1); ++dx) {
        for (int x = 0; x < width - dx; ++x) {
            low[x] = std::min(low[x], in[x + dx]);
            high[x] = std::max(high[x], in[x + dx]);
        }
        for (int x = dx; x < width; ++x) {
            low[x] = std::min(low[x], in[x - dx]);
            high[x] = std::max(high[x], in[x - dx]);
        }
    }
}

double clip_metres(const ClipDescription& clip, double v) {
    if (clip.scale == ClipScale::linear) return clip.dark_m + v * (clip.bright_m - clip.dark_m);
    const double raw = 2048 * std::cbrt(768 * (1 - v) / 9216);
    return 0.1236 * std::tan(raw / 2842.5 + 1.1863);
}

}  // namespace

ClipDepth::ClipDepth(ClipDescription description) : description_(std::move(description)) {
    for (int code = 0; code <= kFull; ++code) {
        const double metres = clip_metres(description_, static_cast<double>(code) / kFull);
        units_.push_back(static_cast<std::uint16_t>(metres * kClipUnitsPerMetre + 0.5));
    }
}

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
        row_spans(code_.row(y), width, row_low_.row(y), row_high_.row(y));
    }
    for (int y = 0; y < height; ++y) {
        std::int16_t* low = low_.row(y);
        std::int16_t* high = high_.row(y);
        std::copy_n(row_low_.row(y), width, low);
        std::copy_n(row_high_.row(y), width, high);
        for (int ny = std::max(0, y - kRadius); ny <= std::min(height - 1, y + kRadius); ++ny) {
            const std::int16_t* other_low = row_low_.row(ny);
            const std::int16_t* other_high = row_high_.row(ny);
            for (int x = 0; x < width; ++x) {
                low[x] = std::min(low[x], other_low[x]);
                high[x] = std::max(high[x], other_high[x]);
            }
        }
    }
}

void ClipDepth::drop_smear() {
    const int width = code_.width();
    const int span_limit = static_cast<int>(std::lround(description_.edge_span * kFull));
    const int least = static_cast<int>(std::ceil(description_.invalid_below * kFull));
    if (span_limit > 0) find_spans();
    surface_ = Image<std::int16_t>(width + 2 * kRadius, code_.height() + 2 * kRadius, kNothing);
    for (int y = 0; y < code_.height(); ++y) {
        std::int16_t* surface = surface_.row(y + kRadius) + kRadius;
        for (int x = 0; x < width; ++x) {
            const std::int16_t code = code_.at(x, y);
            bool valid = code >= least;
            if (valid && span_limit > 0) {
                const int low = low_.at(x, y);
                const int high = high_.at(x, y);
                const int quarter = (high - low) / 4;
                const bool on_far = low >= least && code <= low + quarter;
                valid = high - low <= span_limit || on_far || code >= high - quarter;
            }
            if (valid) surface[x] = code;
        }
    }
}

void ClipDepth::smooth() {
    const int width = code_.width();
    const int span = static_cast<int>(std::lround(description_.smooth_span * kFull));
    sum_.resize(static_cast<std::size_t>(width));
    count_.resize(static_cast<std::size_t>(width));
    std::int32_t* const sum = sum_.data();
    std::int32_t* const count = count_.data();
    for (int y = 0; y < code_.height(); ++y) {
        const std::int16_t* own = surface_.row(y + kRadius) + kRadius;
        const auto is_valid = [](std::int16_t code) { return code != kNothing; };
        const auto from = static_cast<int>(std::find_if(own, own + width, is_valid) - own);
        int to = width;
        while (to > from && !is_valid(own[to - 1])) --to;
        std::fill(sum, sum + width, 0);
        std::fill(count, count + width, 0);
        for (int dy = -kRadius; dy <= kRadius; ++dy) {
            for (int dx = -kRadius; dx <= kRadius; ++dx) {
                const std::int16_t* other = surface_.row(y + kRadius + dy) + kRadius + dx;
                for (int x = from; x < to; ++x) {
                    const int difference = other[x] - own[x];
                    const int near = difference <= span && -difference <= span ? 1 : 0;
                    sum[x] += near * other[x];
                    count[x] += near;
                }
            }
        }
        std::int16_t* out = code_.row(y);
        for (int x = 0; x < width; ++x) {
            out[x] = own[x] == kNothing
                         ? kNothing
                         : static_cast<std::int16_t>((sum[x] + count[x] / 2) / count[x]);
        }
    }
}

void ClipDepth::decode(const YuvPicture& picture, Image<std::uint16_t>& out) {
    read_codes(picture);
    drop_smear();
    smooth();
    out.resize(code_.width(), code_.height());
    for (int y = 0; y < code_.height(); ++y) {
        for (int x = 0; x < code_.width(); ++x) {
            const std::int16_t code = code_.at(x, y);
            out.at(x, y) =
                code == kNothing ? std::uint16_t{0} : units_[static_cast<std::size_t>(code)];
        }
    }
}

}  // namespace kino
