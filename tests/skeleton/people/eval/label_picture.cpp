#include "tests/skeleton/people/eval/label_picture.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace kino::test {

Image<Rgba8> label_picture(const Image<float>& depth_m, const Image<std::uint8_t>& labels,
                           int width) {
    static constexpr std::array<std::array<float, 3>, 7> kColors = {{{1, 1, 1},
                                                                     {1.0f, 0.45f, 0.25f},
                                                                     {0.3f, 0.75f, 1.0f},
                                                                     {0.55f, 0.9f, 0.35f},
                                                                     {1.0f, 0.85f, 0.3f},
                                                                     {0.85f, 0.5f, 1.0f},
                                                                     {0.4f, 0.95f, 0.85f}}};
    Image<Rgba8> out(width, width * 3 / 4);
    const int step = std::max(1, depth_m.width() / width);
    for (int y = 0; y < out.height(); ++y) {
        for (int x = 0; x < out.width(); ++x) {
            const int u = x * depth_m.width() / out.width();
            const int v = y * depth_m.height() / out.height();
            const float z = depth_m.at(u, v);
            Rgba8& p = out.at(x, y);
            p = {18, 18, 24, 255};
            if (!(z > 0.1f && z < 20)) continue;
            float slope = 0;
            if (u + step < depth_m.width() && v + step < depth_m.height()) {
                const float right = depth_m.at(u + step, v), below = depth_m.at(u, v + step);
                if (right > 0.1f && below > 0.1f) slope = (right - z) + 1.5f * (below - z);
            }
            const float cell = z * static_cast<float>(step) / 500;
            const float shade = std::clamp(0.5f - 0.12f * slope / cell, 0.15f, 1.0f);
            const float fade = std::clamp(1.35f - 0.2f * z, 0.35f, 1.0f);
            const std::uint8_t label = labels.at(u, v);
            const float base = 255 * shade * fade * (label ? 1.25f : 0.8f);
            const auto& c = kColors[std::min<std::size_t>(label, 6)];
            const auto part = [&](float w) {
                return static_cast<std::uint8_t>(
                    std::clamp((label ? 40.0f * w : 0.0f) + base * w, 0.0f, 255.0f));
            };
            p = {part(c[0]), part(c[1]), part(c[2]), 255};
        }
    }
    return out;
}

Image<Rgba8> contact_sheet(const std::vector<Image<Rgba8>>& pictures, int columns) {
    if (pictures.empty()) return {};
    constexpr int kGap = 4;
    const int width = pictures.front().width(), height = pictures.front().height();
    const int count = static_cast<int>(pictures.size());
    const int lines = (count + columns - 1) / columns;
    Image<Rgba8> sheet(columns * (width + kGap) - kGap, lines * (height + kGap) - kGap,
                       Rgba8{255, 255, 255, 255});
    for (int i = 0; i < count; ++i) {
        const Image<Rgba8>& from = pictures[static_cast<std::size_t>(i)];
        const int left = (i % columns) * (width + kGap), top = (i / columns) * (height + kGap);
        for (int y = 0; y < std::min(height, from.height()); ++y)
            std::copy_n(from.row(y), std::min(width, from.width()), sheet.row(top + y) + left);
    }
    return sheet;
}

}  // namespace kino::test
