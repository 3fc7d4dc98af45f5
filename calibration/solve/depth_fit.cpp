#include "calibration/solve/depth_fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/check.h"

namespace kino {
namespace {

constexpr double kLeastSpread = 1.5;
constexpr double kDropSigmas = 4;
constexpr std::size_t kLeastFitSamples = 100;
constexpr std::size_t kLeastInCell = 50;

struct Line {
    double offset = 0;
    double slope = 0;
    double rms = 0;  // of raw, not of 1/z
};

// 1/z over raw; the noise sits in raw, but the slope is so exact that it does not matter.
std::optional<Line> fit_line(const std::vector<DepthSample>& samples) {
    double n = 0;
    double raw_mean = 0;
    double inverse_mean = 0;
    for (const DepthSample& s : samples) {
        ++n;
        raw_mean += (s.measured - raw_mean) / n;
        inverse_mean += (1 / s.true_m - inverse_mean) / n;
    }
    double square = 0;
    double mixed = 0;
    for (const DepthSample& s : samples) {
        square += (s.measured - raw_mean) * (s.measured - raw_mean);
        mixed += (s.measured - raw_mean) * (1 / s.true_m - inverse_mean);
    }
    if (!(square > 0) || mixed == 0) return std::nullopt;
    Line line;
    line.slope = mixed / square;
    line.offset = inverse_mean - line.slope * raw_mean;
    double sum = 0;
    for (const DepthSample& s : samples) {
        const double off = (1 / s.true_m - line.offset) / line.slope - s.measured;
        sum += off * off;
    }
    line.rms = std::sqrt(sum / n);
    return line;
}

}  // namespace

Result<DisparityFit> fit_disparity(const std::vector<DepthSample>& samples,
                                   const DisparityParameters& known) {
    if (samples.size() < kLeastFitSamples) {
        return fail(fmt::format("{} depth pixels lie on boards; {} are needed", samples.size(),
                                kLeastFitSamples));
    }
    const auto [near, far] = std::minmax_element(
        samples.begin(), samples.end(),
        [](const DepthSample& a, const DepthSample& b) { return a.true_m < b.true_m; });
    DisparityFit out;
    out.nearest_m = near->true_m;
    out.farthest_m = far->true_m;
    if (out.farthest_m < kLeastSpread * out.nearest_m) {
        return fail(fmt::format("all boards are at about one distance ({:.2f} to {:.2f} m)",
                                out.nearest_m, out.farthest_m),
                    "disparity", "bring the board nearer and farther, by half at least");
    }
    std::vector<DepthSample> kept = samples;
    auto line = fit_line(kept);
    if (line) {
        std::erase_if(kept, [&](const DepthSample& s) {
            const double off = (1 / s.true_m - line->offset) / line->slope - s.measured;
            return std::abs(off) > kDropSigmas * line->rms + 1e-9;
        });
        line = fit_line(kept);
    }
    if (!line || !(line->slope < 0)) {
        return fail("the depth does not grow with the raw disparity", "disparity");
    }
    // Per cm, as the device states its lengths.
    const double offset = line->offset / 100;
    const double slope = line->slope / 100;
    const double p = known.reference_pixel_size_mm;
    const double e = known.emitter_distance_cm;
    const double r = -p / (4 * slope * e);
    out.parameters = known;
    out.parameters.reference_distance_cm = r;
    out.parameters.const_shift = (offset - 1 / r) * r * e / p - 0.375;
    out.rms_steps = line->rms;
    out.samples = static_cast<int>(kept.size());
    return out;
}

Result<BiasFit> fit_bias(const std::vector<DepthSample>& samples, int width, int height,
                         int columns, int rows) {
    KINO_CHECK(width > 0 && height > 0 && columns > 0 && rows > 0);
    const auto cells = static_cast<std::size_t>(columns * rows);
    std::vector<std::vector<float>> found(cells);
    for (const DepthSample& s : samples) {
        const int c = std::clamp(static_cast<int>((s.x + 0.5) / width * columns), 0, columns - 1);
        const int r = std::clamp(static_cast<int>((s.y + 0.5) / height * rows), 0, rows - 1);
        found[static_cast<std::size_t>(r * columns + c)].push_back(
            static_cast<float>(1 / s.measured - 1 / s.true_m));
    }
    BiasFit fit;
    DepthBias& out = fit.bias;
    out = {width, height, columns, rows, std::vector<float>(cells, 0)};
    std::vector<bool> known(cells, false);
    for (std::size_t i = 0; i < cells; ++i) {
        if (found[i].size() < kLeastInCell) continue;
        const auto middle = found[i].begin() + static_cast<std::ptrdiff_t>(found[i].size() / 2);
        std::nth_element(found[i].begin(), middle, found[i].end());
        out.per_m[i] = *middle;
        known[i] = true;
    }
    if (std::find(known.begin(), known.end(), true) == known.end()) {
        return fail("no part of the picture has enough depth on boards", "depth bias",
                    "bring the board to all parts of the picture");
    }
    fit.seen_share = static_cast<double>(std::count(known.begin(), known.end(), true)) /
                     static_cast<double>(cells);
    while (std::find(known.begin(), known.end(), false) != known.end()) {
        const std::vector<bool> before = known;
        for (int r = 0; r < rows; ++r) {
            for (int c = 0; c < columns; ++c) {
                const auto own = static_cast<std::size_t>(r * columns + c);
                if (before[own]) continue;
                float sum = 0;
                float count = 0;
                for (int dr = -1; dr <= 1; ++dr) {
                    for (int dc = -1; dc <= 1; ++dc) {
                        if (c + dc < 0 || r + dr < 0 || c + dc >= columns || r + dr >= rows)
                            continue;
                        const auto other = static_cast<std::size_t>((r + dr) * columns + c + dc);
                        if (!before[other]) continue;
                        sum += out.per_m[other];
                        ++count;
                    }
                }
                if (count == 0) continue;
                out.per_m[own] = sum / count;
                known[own] = true;
            }
        }
    }
    double before = 0;
    double after = 0;
    for (const DepthSample& s : samples) {
        const double off = 1 / s.measured - 1 / s.true_m;
        const double rest = off - out.at(static_cast<double>(s.x), static_cast<double>(s.y));
        before += off * off;
        after += rest * rest;
    }
    // At 1 m a difference of 1/z is one of z.
    fit.samples = static_cast<int>(samples.size());
    fit.rms_before_mm = 1000 * std::sqrt(before / fit.samples);
    fit.rms_after_mm = 1000 * std::sqrt(after / fit.samples);
    return fit;
}

}  // namespace kino
