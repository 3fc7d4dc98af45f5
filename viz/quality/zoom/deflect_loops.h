#pragma once

// One pixel at a time, from `first` on: all of a row in deflect_rows.cpp, its end in
// deflect_rows_avx2.cpp, which includes this, too, for its own processor.
#include "viz/quality/zoom/deflect_rows.h"

namespace kino::deflect_rows {
namespace {

inline int within(int i, int size) {
    return i < 0 ? 0 : i >= size ? size - 1 : i;
}

// Whole numbers by way of int; places far outside are brought near first, so that they fit. What is
// no number goes high, as the SIMD twin's minimum does.
inline float bounded(float x, int size) {
    const float low = -4.0f;
    const float high = static_cast<float>(size) + 4.0f;
    const float y = x < high ? x : high;
    return y > low ? y : low;
}

inline int floor_of(float x) {
    const int i = static_cast<int>(x);
    return i - (x < static_cast<float>(i) ? 1 : 0);
}

inline float magnitude(float x) {
    return x < 0 ? -x : x;
}

inline float depth_of(const Row& row, int i, int j) {
    return row.inverse_z[within(j, row.height) * row.depth_pitch + within(i, row.width)];
}

template <bool kDepths>
int places_of(const Row& row, int first_x, int count, float* u, float* v) {
    int outside = 0;
    const float last_x = static_cast<float>(row.width) - 0.5f;
    const float last_y = static_cast<float>(row.height) - 0.5f;
    for (int x = first_x; x < count; ++x) {
        const float t = static_cast<float>(x);
        const float z = row.ray[2] + t * row.step[2];
        const float r = 1.0f / (z > 1e-4f ? z : 1e-4f);
        const float a = (row.ray[0] + t * row.step[0]) * r;
        const float b = (row.ray[1] + t * row.step[1]) * r;
        const float at_u = row.fx * a + row.cx;
        const float at_v = row.fy * b + row.cy;
        const float along_u = row.fx * (row.eye[0] - a * row.eye[2]);
        const float along_v = row.fy * (row.eye[1] - b * row.eye[2]);
        float w = row.plane;
        if (kDepths) {
            const auto depth_at = [&](float inverse) {
                const float pu = bounded(at_u + inverse * along_u, row.width);
                const float pv = bounded(at_v + inverse * along_v, row.height);
                return depth_of(row, floor_of(pu + 0.5f), floor_of(pv + 0.5f));
            };
            const float first = depth_at(w);
            const float second = depth_at(first);
            const float third = depth_at(second);
            // Half a pixel apart is not settled: an edge, or what it hid. Of the last two places
            // the one with the farther surface is shown.
            const float off = magnitude(third - second) * (magnitude(along_u) + magnitude(along_v));
            const float farther = second < third ? first : second;
            w = off > 0.5f ? farther : third;
        }
        float to_u = at_u + w * along_u;
        float to_v = at_v + w * along_v;
        outside += to_u >= -0.5f && to_u < last_x && to_v >= -0.5f && to_v < last_y ? 0 : 1;
        to_u = bounded(to_u, row.width);
        to_v = bounded(to_v, row.height);
        if (kDepths) {
            // Across an edge nothing is blended, else it would leave a line where it was.
            const int i = floor_of(to_u);
            const int j = floor_of(to_v);
            const float upper = depth_of(row, i, j);
            const float lower = depth_of(row, i + 1, j + 1);
            const bool edge =
                magnitude(upper - lower) * (magnitude(along_u) + magnitude(along_v)) > 0.5f;
            to_u = edge ? static_cast<float>(floor_of(to_u + 0.5f)) : to_u;
            to_v = edge ? static_cast<float>(floor_of(to_v + 0.5f)) : to_v;
        }
        u[x] = to_u;
        v[x] = to_v;
    }
    return outside;
}

void nearest_from(const Source& from, int first, const float* u, const float* v, int count,
                  std::uint32_t* out) {
    for (int x = first; x < count; ++x) {
        const int i = within(floor_of(u[x] + 0.5f), from.width);
        const int j = within(floor_of(v[x] + 0.5f), from.height);
        out[x] = from.pixels[j * from.pitch + i];
    }
}

// Channels 0 and 2 of a pixel, and 1 and 3, each pair in one word: two are blended at a time.
inline std::uint32_t between(std::uint32_t a, std::uint32_t b, std::uint32_t part) {
    return (a * (256u - part) + b * part + 0x00800080u) >> 8 & 0x00FF00FFu;
}

void bilinear_from(const Source& from, int first, const float* u, const float* v, int count,
                   std::uint32_t* out) {
    for (int x = first; x < count; ++x) {
        const int i = floor_of(u[x]);
        const int j = floor_of(v[x]);
        const auto part_x = static_cast<std::uint32_t>((u[x] - static_cast<float>(i)) * 256.0f);
        const auto part_y = static_cast<std::uint32_t>((v[x] - static_cast<float>(j)) * 256.0f);
        const int i0 = within(i, from.width), i1 = within(i + 1, from.width);
        const std::uint32_t* upper = from.pixels + within(j, from.height) * from.pitch;
        const std::uint32_t* lower = from.pixels + within(j + 1, from.height) * from.pitch;
        const std::uint32_t mask = 0x00FF00FFu;
        const std::uint32_t even =
            between(between(upper[i0] & mask, upper[i1] & mask, part_x),
                    between(lower[i0] & mask, lower[i1] & mask, part_x), part_y);
        const std::uint32_t odd =
            between(between(upper[i0] >> 8 & mask, upper[i1] >> 8 & mask, part_x),
                    between(lower[i0] >> 8 & mask, lower[i1] >> 8 & mask, part_x), part_y);
        out[x] = even | odd << 8;
    }
}

}  // namespace
}  // namespace kino::deflect_rows
