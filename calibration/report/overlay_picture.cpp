#include "calibration/report/overlay_picture.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "calibration/rig.h"

namespace kino {
namespace {

Rgba8 mixed(const Rgba8& below, const Rgba8& above, double share) {
    const auto mix = [&](std::uint8_t a, std::uint8_t b) {
        return static_cast<std::uint8_t>(std::lround(a + share * (b - a)));
    };
    return {mix(below.r, above.r), mix(below.g, above.g), mix(below.b, above.b), 255};
}

// Red, yellow, green, cyan, blue.
Rgba8 color_of(double at) {
    const double hue = 4 * std::clamp(at, 0.0, 1.0);
    const auto bump = [&](double middle) {
        return static_cast<std::uint8_t>(
            std::lround(255 * std::clamp(2 - std::abs(hue - middle), 0.0, 1.0)));
    };
    return {static_cast<std::uint8_t>(std::lround(255 * std::clamp(2 - hue, 0.0, 1.0))), bump(2),
            static_cast<std::uint8_t>(std::lround(255 * std::clamp(hue - 2, 0.0, 1.0)))};
}

bool is_contour(const Image<float>& depth_m, int x, int y) {
    const float z = depth_m.at(x, y);
    for (const auto& [dx, dy] :
         {std::pair(1, 0), std::pair(-1, 0), std::pair(0, 1), std::pair(0, -1)}) {
        if (!depth_m.contains(x + dx, y + dy)) continue;
        const float other = depth_m.at(x + dx, y + dy);
        if (other > 1.05f * z && other > z + 4 * Rig::quantisation_step_m(z)) return true;
    }
    return false;
}

}  // namespace

Result<Image<Rgba8>> depth_over_color(const DepthFrame& depth, const Image<Rgba8>& color,
                                      const RigParameters& rig, int widest) {
    if (!rig.color || rig.color->width != color.width() || rig.color->height != color.height()) {
        return fail("the calibration has no colour camera of this picture's size");
    }
    KINO_ASSIGN(Rig made, Rig::create(rig));
    RegisteredDepth registered;
    KINO_TRY(made.register_depth(depth, registered));
    std::vector<float> seen;
    for (const float z : registered.depth_m.pixels()) {
        if (z > 0) seen.push_back(z);
    }
    std::sort(seen.begin(), seen.end());
    const double near = seen.empty() ? 0 : 1 / static_cast<double>(seen[seen.size() / 50]);
    const double far =
        seen.empty() ? 1 : 1 / static_cast<double>(seen[seen.size() - 1 - seen.size() / 50]);

    const int shrink = std::max(1, (color.width() + widest - 1) / widest);
    Image<Rgba8> out(color.width() / shrink, color.height() / shrink);
    for (int y = 0; y < out.height(); ++y) {
        for (int x = 0; x < out.width(); ++x) {
            int sum[3] = {0, 0, 0};
            for (int i = 0; i < shrink * shrink; ++i) {
                const Rgba8& p = color.at(x * shrink + i % shrink, y * shrink + i / shrink);
                sum[0] += p.r;
                sum[1] += p.g;
                sum[2] += p.b;
            }
            const auto mean = [&](int channel) {
                return static_cast<std::uint8_t>(sum[channel] / (shrink * shrink));
            };
            out.at(x, y) = {mean(0), mean(1), mean(2), 255};
        }
    }
    const Image<Rgba8> photo = out;
    for (int pass = 0; pass < 2; ++pass) {
        for (int y = 0; y < registered.depth_m.height(); ++y) {
            for (int x = 0; x < registered.depth_m.width(); ++x) {
                const float z = registered.depth_m.at(x, y);
                const ColorUv uv = registered.uv.at(x, y);
                if (!(z > 0) || !uv.valid()) continue;
                const int px = (uv.u >> kUvFractionBits) / shrink;
                const int py = (uv.v >> kUvFractionBits) / shrink;
                if (!out.contains(px, py)) continue;
                // Contours last, so that nothing covers them.
                if (pass == 0) {
                    const double at =
                        (near - 1 / static_cast<double>(z)) / std::max(1e-6, near - far);
                    out.at(px, py) = mixed(photo.at(px, py), color_of(at), 0.4);
                } else if (is_contour(registered.depth_m, x, y)) {
                    out.at(px, py) = {255, 255, 255, 255};
                }
            }
        }
    }
    return out;
}

}  // namespace kino
