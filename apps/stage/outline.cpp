#include "apps/stage/outline.h"

#include <algorithm>
#include <cstdint>
#include <vector>

#include "base/check.h"

namespace kino {
namespace {

constexpr float kOneSurfaceM = 0.1f;

/// How many pixels of the square round each have a reading, by running sums along both axes.
Image<std::uint16_t> count_readings(const Image<float>& depth_m, int radius) {
    const int width = depth_m.width(), height = depth_m.height();
    Image<std::uint16_t> along(width, height);
    for (int y = 0; y < height; ++y) {
        const float* row = &depth_m.at(0, y);
        std::uint16_t* out = &along.at(0, y);
        int sum = 0;
        for (int x = 0; x < std::min(radius, width); ++x) sum += row[x] > 0;
        for (int x = 0; x < width; ++x) {
            if (x + radius < width) sum += row[x + radius] > 0;
            if (x - radius - 1 >= 0) sum -= row[x - radius - 1] > 0;
            out[x] = static_cast<std::uint16_t>(sum);
        }
    }
    Image<std::uint16_t> count(width, height);
    std::vector<int> sums(static_cast<std::size_t>(width), 0);
    const auto add = [&](int y, int sign) {
        if (y < 0 || y >= height) return;
        const std::uint16_t* row = &along.at(0, y);
        for (int x = 0; x < width; ++x) sums[static_cast<std::size_t>(x)] += sign * row[x];
    };
    for (int y = 0; y < radius; ++y) add(y, 1);
    for (int y = 0; y < height; ++y) {
        add(y + radius, 1);
        add(y - radius - 1, -1);
        std::uint16_t* out = &count.at(0, y);
        for (int x = 0; x < width; ++x) {
            out[x] = static_cast<std::uint16_t>(sums[static_cast<std::size_t>(x)]);
        }
    }
    return count;
}

struct Reading {
    float depth_m = 0;
    Rgba8 color;
};

/// What the readings round a pixel say of it; there is one at least.
Reading mean_around(const Image<float>& depth_m, const Image<Rgba8>& color, int x, int y,
                    int radius) {
    const int x0 = std::max(0, x - radius), x1 = std::min(depth_m.width() - 1, x + radius);
    const int y0 = std::max(0, y - radius), y1 = std::min(depth_m.height() - 1, y + radius);
    float farthest = 0;
    for (int v = y0; v <= y1; ++v) {
        for (int u = x0; u <= x1; ++u) farthest = std::max(farthest, depth_m.at(u, v));
    }
    double sum_m = 0;
    int count = 0, known = 0, red = 0, green = 0, blue = 0;
    for (int v = y0; v <= y1; ++v) {
        for (int u = x0; u <= x1; ++u) {
            const float z = depth_m.at(u, v);
            if (!(z > 0 && z >= farthest - kOneSurfaceM)) continue;
            sum_m += z;
            ++count;
            if (color.size() == 0 || color.at(u, v).a == 0) continue;
            const Rgba8 c = color.at(u, v);
            red += c.r, green += c.g, blue += c.b;
            ++known;
        }
    }
    Reading reading{.depth_m = static_cast<float>(sum_m / count), .color = {0, 0, 0, 0}};
    if (known > 0) {
        const auto mean = [known](int sum) { return static_cast<std::uint8_t>(sum / known); };
        reading.color = {mean(red), mean(green), mean(blue), 255};
    }
    return reading;
}

}  // namespace

int outline_radius_px(int picture_width) {
    return std::clamp((picture_width + 80) / 160, 1, 8);
}

void smooth_outline(DepthSurface& surface, int radius_px) {
    KINO_CHECK(radius_px >= 0 && radius_px <= 100);
    if (radius_px == 0) return;
    const Image<float> depth_m = surface.depth_m;
    const Image<Rgba8> color = surface.color;
    const Image<std::uint16_t> count = count_readings(depth_m, radius_px);
    const int side = 2 * radius_px + 1;
    const int half = (side * side + 1) / 2;
    for (int y = 0; y < depth_m.height(); ++y) {
        for (int x = 0; x < depth_m.width(); ++x) {
            const bool there = depth_m.at(x, y) > 0;
            const bool wanted = count.at(x, y) >= half;
            if (there == wanted) continue;
            if (there) {
                surface.depth_m.at(x, y) = 0;
                continue;
            }
            const Reading reading = mean_around(depth_m, color, x, y, radius_px);
            surface.depth_m.at(x, y) = reading.depth_m;
            if (color.size() > 0) surface.color.at(x, y) = reading.color;
        }
    }
}

}  // namespace kino
