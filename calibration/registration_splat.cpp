#include "calibration/registration_splat.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

#include "calibration/rig.h"

namespace kino::registration {
namespace {

constexpr std::uint8_t kRight = 1;
constexpr std::uint8_t kDown = 2;

float tangent_deg(double degrees) {
    return static_cast<float>(std::tan(degrees * std::numbers::pi / 180));
}

// As the kernels round: nearest, ties to even, for |x| < 2^22.
int nearest_whole(float x) {
    constexpr float kMagic = 12582912.0f;
    return static_cast<int>((x + kMagic) - kMagic);
}

int whole_below(float x) {
    const int near = static_cast<int>(x);
    return near - (static_cast<float>(near) > x ? 1 : 0);
}

int whole_above(float x) {
    const int near = static_cast<int>(x);
    return near + (static_cast<float>(near) < x ? 1 : 0);
}

// While drawing, the picture holds 1/z: 0 is "nothing", and the larger one is the nearer.
void keep_nearer(float& place, float inverse_z) {
    place = std::max(place, inverse_z);
}

void invert_all(float* values, std::size_t n) {
    for (std::size_t i = 0; i < n; ++i) values[i] = values[i] > 0 ? 1.0f / values[i] : 0.0f;
}

std::size_t picture_size(const Geometry& g) {
    return static_cast<std::size_t>(g.width) * static_cast<std::size_t>(g.height);
}

}  // namespace

void draw_four_pixels(const Geometry& g, const Places& places, std::size_t n) {
    float* picture = places.depth_in_color_m;
    std::fill_n(picture, picture_size(g), 0.0f);
    for (std::size_t i = 0; i < n; ++i) {
        if (places.uv[i] == kInvalid) continue;
        const float u = places.u[i];
        const float v = places.v[i];
        const int left = whole_below(u);
        const int top = whole_below(v);
        const int right = std::min(whole_above(u), g.width - 1);
        const int bottom = std::min(whole_above(v), g.height - 1);
        const float inverse_z = 1.0f / places.z[i];
        for (int y = std::max(top, 0); y <= bottom; ++y) {
            for (int x = std::max(left, 0); x <= right; ++x) {
                keep_nearer(picture[y * g.width + x], inverse_z);
            }
        }
    }
    invert_all(picture, picture_size(g));
}

// How a piece's place and 1/z change from one depth pixel to the next along x and along y.
struct Splat::Piece {
    float u_x, v_x, w_x;
    float u_y, v_y, w_y;
};

Splat::Splat(int width, int height, double depth_focal_px, double pixel_ratio)
    : width_(width),
      height_(height),
      three_steps_(3 * Rig::quantisation_step_m(1.0f)),
      usual_slope_(tangent_deg(kUsualTiltDeg) / static_cast<float>(depth_focal_px)),
      steepest_slope_(tangent_deg(kSteepestTiltDeg) / static_cast<float>(depth_focal_px)),
      largest_reach_px_(kLargestPiece * static_cast<float>(std::max(pixel_ratio, 1.0))) {
    const auto n = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    linked_.resize(n);
    inverse_z_.resize(n);
}

// Whether the step from pixel i to `next` of its line, i being number `at` of `size`, goes on
// straight in 1/z before or after it.
bool Splat::continues(const float* depth_m, std::size_t i, std::size_t next, int at,
                      int size) const {
    const std::size_t stride = next - i;
    const auto straight = [&](float before, float middle, float after) {
        if (!(before > 0) || !(after > 0)) return false;
        return std::abs(1 / before - 2 / middle + 1 / after) <= three_steps_;
    };
    if (at > 0 && straight(depth_m[i - stride], depth_m[i], depth_m[next])) return true;
    return at + 2 < size && straight(depth_m[i], depth_m[next], depth_m[next + stride]);
}

void Splat::link(const Places& places) {
    const float* z = places.depth_m;
    const auto stride = static_cast<std::size_t>(width_);
    const auto one_surface = [&](std::size_t i, std::size_t next, int at, int size) {
        if (!(places.z[i] > 0) || !(places.z[next] > 0)) return false;
        const float nearer = std::min(z[i], z[next]);
        const float step = std::abs(z[next] - z[i]);
        const float noise = three_steps_ * (nearer * nearer);
        if (step <= noise + usual_slope_ * nearer) return true;
        if (!(step <= noise + steepest_slope_ * nearer)) return false;
        return continues(z, i, next, at, size);
    };
    for (int y = 0; y < height_; ++y) {
        for (int x = 0; x < width_; ++x) {
            const std::size_t i =
                static_cast<std::size_t>(y) * stride + static_cast<std::size_t>(x);
            std::uint8_t to = 0;
            if (x + 1 < width_ && one_surface(i, i + 1, x, width_)) to = kRight;
            if (y + 1 < height_ && one_surface(i, i + stride, y, height_)) to |= kDown;
            linked_[i] = to;
            inverse_z_[i] = places.z[i] > 0 ? 1.0f / places.z[i] : 0.0f;
        }
    }
}

// The neighbours' rays cut at this reading's own depth take the place of missing neighbours.
void Splat::face_camera(const Geometry& geometry, const RayTable& table, const Places& places,
                        std::size_t i, int x, int y, Piece& piece) const {
    const auto stride = static_cast<std::size_t>(width_);
    const std::size_t at[] = {x > 0 ? i - 1 : i, x + 1 < width_ ? i + 1 : i, y > 0 ? i - stride : i,
                              y + 1 < height_ ? i + stride : i};
    float ray[3][4];
    for (int k = 0; k < 4; ++k) table.read(at[k], 1, &ray[0][k], &ray[1][k], &ray[2][k]);
    const float depth = places.depth_m[i];
    const float depths[] = {depth, depth, depth, depth};
    float u[4], v[4], z[4];
    std::uint32_t uv[4], key[4];
    std::int32_t cell[4];
    Geometry from_scratch = geometry;
    from_scratch.ray_x = ray[0];
    from_scratch.ray_y = ray[1];
    from_scratch.ray_z = ray[2];
    kPortable.project(from_scratch, depths, 0, 4, {uv, cell, key, u, v, z});
    const auto change = [&](int low, float(&out)[3]) {
        const int high = low + 1;
        out[0] = out[1] = out[2] = 0;
        if (at[low] == at[high]) return;
        // A neighbour without a ray: the other half has to do.
        const int first = z[low] > 0 ? low : -1;
        const int last = z[high] > 0 ? high : -1;
        const float own[3] = {places.u[i], places.v[i], inverse_z_[i]};
        const auto place = [&](int k, int value) {
            if (k < 0) return own[value];
            return value == 0 ? u[k] : value == 1 ? v[k] : 1 / z[k];
        };
        const bool both = first >= 0 && last >= 0 && at[low] != i && at[high] != i;
        for (int value = 0; value < 3; ++value) {
            out[value] = (place(last, value) - place(first, value)) * (both ? 0.5f : 1.0f);
        }
    };
    const auto linked = [&](std::size_t before, std::size_t from, std::uint8_t way) {
        return (before != from && (linked_[before] & way) != 0) || (linked_[from] & way) != 0;
    };
    float changes[3];
    if (!linked(at[0], i, kRight)) {
        change(0, changes);
        piece.u_x = changes[0], piece.v_x = changes[1], piece.w_x = changes[2];
    }
    if (!linked(at[2], i, kDown)) {
        change(2, changes);
        piece.u_y = changes[0], piece.v_y = changes[1], piece.w_y = changes[2];
    }
}

void Splat::draw_piece(const Geometry& g, const Places& places, std::size_t i, Piece p,
                       bool refuse_back) const {
    constexpr float kHalf = 0.5f + kOverlap;
    const float u = places.u[i];
    const float v = places.v[i];
    const float w = inverse_z_[i];
    // Far outside every picture, or infinitely so.
    if (!(std::abs(u) < 65536.0f && std::abs(v) < 65536.0f)) return;
    float* picture = places.depth_in_color_m;
    // Steeper than any piece can be seen: noise. It then has its reading's depth all over.
    if (!(kHalf * (std::abs(p.w_x) + std::abs(p.w_y)) < 0.5f * w)) p.w_x = p.w_y = 0;
    const float det = p.u_x * p.v_y - p.u_y * p.v_x;
    const bool drawable = std::abs(det) > 1e-6f;
    const float inverse = drawable ? 1.0f / det : 0.0f;
    // The place (a, b) in the piece, in depth pixels from its reading, of a colour pixel's centre.
    const float a_u = drawable ? p.v_y * inverse : 0.0f;
    const float a_v = drawable ? -p.u_y * inverse : 0.0f;
    const float b_u = drawable ? -p.v_x * inverse : 0.0f;
    const float b_v = drawable ? p.u_x * inverse : 0.0f;

    if (drawable) {
        const float reach_u =
            std::min((std::abs(p.u_x) + std::abs(p.u_y)) * kHalf, largest_reach_px_);
        const float reach_v =
            std::min((std::abs(p.v_x) + std::abs(p.v_y)) * kHalf, largest_reach_px_);
        const int left = whole_above(std::max(u - reach_u, 0.0f));
        const int top = whole_above(std::max(v - reach_v, 0.0f));
        const int right = whole_below(std::min(u + reach_u, static_cast<float>(g.width - 1)));
        const int bottom = whole_below(std::min(v + reach_v, static_cast<float>(g.height - 1)));
        for (int y = top; y <= bottom; ++y) {
            const float dv = static_cast<float>(y) - v;
            for (int x = left; x <= right; ++x) {
                const float du = static_cast<float>(x) - u;
                const float a = a_u * du + a_v * dv;
                const float b = b_u * du + b_v * dv;
                if (!(std::abs(a) <= kHalf && std::abs(b) <= kHalf)) continue;
                keep_nearer(picture[y * g.width + x], w + (a * p.w_x + b * p.w_y));
            }
        }
    }
    if (places.uv[i] == kInvalid) return;
    const int x = nearest_whole(u);
    const int y = nearest_whole(v);
    const float du = static_cast<float>(x) - u;
    const float dv = static_cast<float>(y) - v;
    const float a = std::clamp(a_u * du + a_v * dv, -kHalf, kHalf);
    const float b = std::clamp(b_u * du + b_v * dv, -kHalf, kHalf);
    const float here = w + (a * p.w_x + b * p.w_y);
    keep_nearer(picture[y * g.width + x], here);
    places.key[i] = std::bit_cast<std::uint32_t>(1.0f / here);
    if (refuse_back && det < 0) places.uv[i] = kInvalid;
}

void Splat::draw(const Geometry& g, const RayTable& table, const Places& places,
                 bool refuse_backs) {
    std::fill_n(places.depth_in_color_m, picture_size(g), 0.0f);
    link(places);
    const auto stride = static_cast<std::size_t>(width_);
    for (int y = 0; y < height_; ++y) {
        for (int x = 0; x < width_; ++x) {
            const std::size_t i =
                static_cast<std::size_t>(y) * stride + static_cast<std::size_t>(x);
            if (!(places.z[i] > 0)) continue;
            const std::size_t to_right = linked_[i] & kRight;
            const std::size_t to_left = x > 0 ? linked_[i - 1] & kRight : 0;
            const std::size_t down = (linked_[i] & kDown) / kDown;
            const std::size_t up = y > 0 ? (linked_[i - stride] & kDown) / kDown : 0;
            const float half_x = to_right + to_left == 2 ? 0.5f : 1.0f;
            const float half_y = up + down == 2 ? 0.5f : 1.0f;
            const std::size_t x0 = i - to_left;
            const std::size_t x1 = i + to_right;
            const std::size_t y0 = i - up * stride;
            const std::size_t y1 = i + down * stride;
            Piece piece{(places.u[x1] - places.u[x0]) * half_x,
                        (places.v[x1] - places.v[x0]) * half_x,
                        (inverse_z_[x1] - inverse_z_[x0]) * half_x,
                        (places.u[y1] - places.u[y0]) * half_y,
                        (places.v[y1] - places.v[y0]) * half_y,
                        (inverse_z_[y1] - inverse_z_[y0]) * half_y};
            const bool has_slope = to_right + to_left > 0 && up + down > 0;
            if (!has_slope) face_camera(g, table, places, i, x, y, piece);
            draw_piece(g, places, i, piece, refuse_backs && has_slope);
        }
    }
    invert_all(places.depth_in_color_m, picture_size(g));
}

}  // namespace kino::registration
