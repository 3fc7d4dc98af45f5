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

/// tests/apps/viewer/picture_levels_test.cpp holds these against the committed table.
constexpr std::array kLodErrors = {
    LodError{1, 0, 0},
    LodError{1.25, 0.005840, 0.061468},
    LodError{1.5, 0.006481, 0.073002},
    LodError{2, 0.007188, 0.085756},
    LodError{3, 0.011111, 0.115617},
    LodError{4, 0.014567, 0.134433},
    LodError{5.6, 0.019712, 0.164157},
    LodError{8, 0.024838, 0.195665},
};

constexpr std::array kResizings = {1.0, 1.25, 1.5, 2.0, 2.5, 3.0, 4.0, 6.0, 8.0};
/// The light-painting stage at 640x360, docs/accuracy/governor.csv.
constexpr double kFirstZoomError = 0.042;

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
    return z <= 1 ? 0 : kFirstZoomError * std::log2(z);
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
    for (int zoom = 1; zoom <= std::max(1, most_zoom); ++zoom) {
        for (const double r : kResizings) {
            for (const auto way : {Reconstruction::geometry_aware, Reconstruction::bilinear}) {
                if (r > 1 && !staged) continue;
                if (r == 1 && way == Reconstruction::bilinear) continue;
                levels.push_back({.lod = r,
                                  .reconstruction = way,
                                  .zoom = zoom,
                                  .error = lod_error(r, way) + zoom_error(zoom)});
            }
        }
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
