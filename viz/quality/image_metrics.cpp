#include "viz/quality/image_metrics.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

namespace kino {

namespace {

constexpr int kLargestShift = 8;

using Channels = std::array<int, 4>;

Channels channels(const Rgba8& pixel) {
    return {pixel.r, pixel.g, pixel.b, pixel.a};
}

Channels abs_difference(const Rgba8& a, const Rgba8& b) {
    const Channels ca = channels(a);
    const Channels cb = channels(b);
    Channels difference{};
    for (std::size_t i = 0; i < 4; ++i) difference[i] = std::abs(ca[i] - cb[i]);
    return difference;
}

int largest(const Channels& values) {
    return *std::max_element(values.begin(), values.end());
}

/// Whether a pixel of `image` within `radius` of (x, y) is `wanted` within the tolerance.
bool found_near(const Image<Rgba8>& image, int x, int y, const Rgba8& wanted,
                const CompareOptions& options) {
    const int radius = options.shift_radius;
    for (int ny = std::max(0, y - radius); ny <= std::min(image.height() - 1, y + radius); ++ny) {
        for (int nx = std::max(0, x - radius); nx <= std::min(image.width() - 1, x + radius);
             ++nx) {
            if (largest(abs_difference(image.at(nx, ny), wanted)) <= options.tolerance) return true;
        }
    }
    return false;
}

/// Equal is dark grey by the picture's own brightness; else blue, red, yellow by difference.
Rgba8 heat(int difference, const Rgba8& pixel) {
    if (difference == 0) {
        const int grey = (pixel.r + 2 * pixel.g + pixel.b) / 16;
        const auto level = static_cast<std::uint8_t>(grey);
        return {level, level, level, 255};
    }
    constexpr int kHalf = 16;
    constexpr int kFull = 64;
    const auto blend = [](int value, int from, int to) {
        return static_cast<std::uint8_t>(std::clamp(255 * (value - from) / (to - from), 0, 255));
    };
    const std::uint8_t red = blend(difference, 0, kHalf);
    const std::uint8_t green = blend(difference, kHalf, kFull);
    return {red, green, static_cast<std::uint8_t>(255 - red), 255};
}

}  // namespace

int ImageDifference::max_abs_any() const {
    return largest(max_abs);
}

std::string ImageDifference::to_string() const {
    if (equal()) return "equal";
    return fmt::format(
        "largest difference r {} g {} b {} a {}, {} pixels ({:.4f} %) fail, RMSE {:.4f}, "
        "PSNR {:.2f} dB",
        max_abs[0], max_abs[1], max_abs[2], max_abs[3], failing_pixels, 100 * failing_fraction,
        rmse, psnr_db);
}

Result<ImageDifference> compare_images(const Image<Rgba8>& a, const Image<Rgba8>& b,
                                       const CompareOptions& options) {
    KINO_CHECK_LE(0, options.tolerance);
    KINO_CHECK(options.shift_radius >= 0 && options.shift_radius <= kLargestShift);
    if (a.width() != b.width() || a.height() != b.height()) {
        return fail(fmt::format("the pictures have different sizes: {}x{} and {}x{}", a.width(),
                                a.height(), b.width(), b.height()));
    }
    if (a.empty()) return fail("the pictures are empty");

    ImageDifference result;
    std::int64_t squares = 0;
    for (int y = 0; y < a.height(); ++y) {
        for (int x = 0; x < a.width(); ++x) {
            const Channels difference = abs_difference(a.at(x, y), b.at(x, y));
            for (std::size_t i = 0; i < 4; ++i) {
                result.max_abs[i] = std::max(result.max_abs[i], difference[i]);
            }
            for (std::size_t i = 0; i < 3; ++i) squares += difference[i] * difference[i];
            if (largest(difference) <= options.tolerance) continue;
            // Both ways: a speck that only one picture has must not hide in the other's plain area.
            const bool forgiven = options.shift_radius > 0 &&
                                  found_near(b, x, y, a.at(x, y), options) &&
                                  found_near(a, x, y, b.at(x, y), options);
            if (!forgiven) ++result.failing_pixels;
        }
    }
    const auto pixels = static_cast<double>(a.size());
    result.failing_fraction = static_cast<double>(result.failing_pixels) / pixels;
    result.rmse = std::sqrt(static_cast<double>(squares) / (3 * pixels));
    result.psnr_db =
        squares == 0 ? std::numeric_limits<double>::infinity() : 20 * std::log10(255 / result.rmse);
    return result;
}

Result<GoldenVerdict> judge_golden(const Image<Rgba8>& actual, const Image<Rgba8>& golden,
                                   const GoldenGate& gate) {
    GoldenVerdict verdict;
    KINO_ASSIGN(verdict.difference, compare_images(actual, golden, gate.options));
    verdict.exact = verdict.difference.equal();
    verdict.passes =
        verdict.exact || verdict.difference.failing_fraction <= gate.max_failing_fraction;
    return verdict;
}

Image<Rgba8> difference_picture(const Image<Rgba8>& a, const Image<Rgba8>& b) {
    constexpr Rgba8 kOnlyOne{255, 0, 255, 255};
    Image<Rgba8> picture(std::max(a.width(), b.width()), std::max(a.height(), b.height()),
                         kOnlyOne);
    for (int y = 0; y < std::min(a.height(), b.height()); ++y) {
        for (int x = 0; x < std::min(a.width(), b.width()); ++x) {
            picture.at(x, y) = heat(largest(abs_difference(a.at(x, y), b.at(x, y))), a.at(x, y));
        }
    }
    return picture;
}

}  // namespace kino
