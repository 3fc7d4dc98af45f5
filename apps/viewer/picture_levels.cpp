#include "apps/viewer/picture_levels.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace kino {
namespace {

struct LodError {
    double r = 1;
    double guided = 0;
    double bilinear = 0;
};
struct ZoomError {
    int z = 1;
    double error = 0;
};

/// tests/apps/viewer/picture_levels_test.cpp holds these against the committed tables.
constexpr std::array kLodErrors = {
    LodError{1, 0, 0},
    LodError{1.125, 0.0070, 0.0530},
    LodError{1.25, 0.0073, 0.0617},
    LodError{1.5, 0.0092, 0.0734},
    LodError{2, 0.0101, 0.0862},
    LodError{2.5, 0.0150, 0.1020},
    LodError{3, 0.0184, 0.1160},
    LodError{4, 0.0254, 0.1349},
    LodError{5.6, 0.0376, 0.1645},
    LodError{8, 0.0575, 0.1960},
};
constexpr std::array kZoomErrors = {ZoomError{1, 0},      ZoomError{2, 0.0460},
                                    ZoomError{3, 0.0570}, ZoomError{4, 0.0740},
                                    ZoomError{6, 0.0800}, ZoomError{8, 0.0900}};

/// About a fifth fewer samples from each to the next.
constexpr std::array kResizings = {1.0,  kLeastResizing,
                                   1.25, 1.375,
                                   1.5,  1.75,
                                   2.0,  2.25,
                                   2.5,  2.75,
                                   3.0,  3.5,
                                   4.0,  4.5,
                                   5.0,  5.5,
                                   6.0,  7.0,
                                   8.0};
/// Without guides few are worth a try.
constexpr std::array kBilinearResizings = {1.5, 2.0, 3.0, 4.0, 6.0, 8.0};

}  // namespace

double lod_error(double r, Reconstruction reconstruction) {
    const auto of = [&](const LodError& e) {
        return reconstruction == Reconstruction::bilinear ? e.bilinear : e.guided;
    };
    if (!(r > 1)) return 0;
    for (std::size_t i = 1; i < kLodErrors.size(); ++i) {
        const LodError& a = kLodErrors[i - 1];
        const LodError& b = kLodErrors[i];
        if (r > b.r) continue;
        const double t = std::log(r / a.r) / std::log(b.r / a.r);
        return of(a) + t * (of(b) - of(a));
    }
    return of(kLodErrors.back());
}

double zoom_error(int z) {
    for (std::size_t i = 1; i < kZoomErrors.size(); ++i) {
        const ZoomError& a = kZoomErrors[i - 1];
        const ZoomError& b = kZoomErrors[i];
        if (z > b.z) continue;
        const double t = std::log(std::max(1, z) / static_cast<double>(a.z)) /
                         std::log(b.z / static_cast<double>(a.z));
        return a.error + t * (b.error - a.error);
    }
    return kZoomErrors.back().error;
}

double picture_error(const PictureLevel& level) {
    if (!(level.lod > 1)) return zoom_error(level.zoom);
    const double r = level.lod * std::sqrt(static_cast<double>(std::max(1, level.zoom)));
    return lod_error(r, level.reconstruction) + zoom_error(level.zoom);
}

std::string PictureLevel::name() const {
    std::string text;
    if (lod > 1) {
        text = fmt::format("light 1/{:g}{}", lod,
                           reconstruction == Reconstruction::bilinear ? " bilinear" : "");
    }
    if (zoom > 1) text += fmt::format("{}picture 1/{}", text.empty() ? "" : ", ", zoom);
    return text.empty() ? "full" : text;
}

std::vector<PictureLevel> picture_levels(bool staged, int most_zoom) {
    std::vector<PictureLevel> levels;
    const auto add = [&](double r, Reconstruction way, int zoom) {
        levels.push_back({.lod = r, .reconstruction = way, .zoom = zoom});
        levels.back().error = picture_error(levels.back());
    };
    for (int zoom = 1; zoom <= std::max(1, most_zoom); ++zoom) {
        add(1, Reconstruction::geometry_aware, zoom);
        if (!staged) continue;
        for (const double r : kResizings) {
            if (r > 1) add(r, Reconstruction::geometry_aware, zoom);
        }
        for (const double r : kBilinearResizings) add(r, Reconstruction::bilinear, zoom);
    }
    std::stable_sort(
        levels.begin(), levels.end(),
        [](const PictureLevel& a, const PictureLevel& b) { return a.error < b.error; });
    return levels;
}

PictureShare share_of(const PictureLevel& level, glm::ivec2 size) {
    const auto down = [&](int pixels) {
        return (std::max(1, pixels) + level.zoom - 1) / level.zoom;
    };
    const int width = down(size.x);
    const int height = down(size.y);
    const double all = static_cast<double>(std::max(1, size.x)) * std::max(1, size.y);
    const LodSize coarse = lod_size(width, height, level.lod);
    return {.drawn = static_cast<double>(width) * height / all,
            .shaded = static_cast<double>(coarse.width) * coarse.height / all};
}

}  // namespace kino
