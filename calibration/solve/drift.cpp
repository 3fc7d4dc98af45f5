#include "calibration/solve/drift.h"

#include <algorithm>
#include <cmath>

namespace kino {
namespace {

constexpr double kFullTile = 0.9;
constexpr double kMovedShare = 0.05;
constexpr std::size_t kLeastTiles = 3;
constexpr std::size_t kLeastPoints = 8;
constexpr double kStandsOutSigmas = 4;

double middle_of(std::vector<double>& values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

// y = a + b x by least squares, with the deviation of b from the residuals.
struct DriftLine {
    double a = 0, b = 0, b_sigma = 0, squares = 0;
};
DriftLine line_through(const std::vector<double>& x, const std::vector<double>& y) {
    const auto n = static_cast<double>(x.size());
    double mx = 0;
    double my = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
        mx += x[i] / n;
        my += y[i] / n;
    }
    double xx = 0;
    double xy = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
        xx += (x[i] - mx) * (x[i] - mx);
        xy += (x[i] - mx) * (y[i] - my);
    }
    DriftLine line;
    if (!(xx > 0)) return line;
    line.b = xy / xx;
    line.a = my - line.b * mx;
    for (std::size_t i = 0; i < x.size(); ++i) {
        const double off = y[i] - line.a - line.b * x[i];
        line.squares += off * off;
    }
    line.b_sigma = std::sqrt(line.squares / std::max(1.0, n - 3) / xx);
    return line;
}

}  // namespace

std::vector<double> DriftWatch::tiles_of(const Image<float>& depth_m) const {
    std::vector<double> out;
    std::vector<double> values;
    for (int top = 0; top + kTile <= depth_m.height(); top += kTile) {
        for (int left = 0; left + kTile <= depth_m.width(); left += kTile) {
            values.clear();
            double sum = 0;
            for (int y = top; y < top + kTile; ++y) {
                for (int x = left; x < left + kTile; ++x) {
                    if (depth_m.at(x, y) > 0) values.push_back(depth_m.at(x, y));
                }
            }
            if (static_cast<double>(values.size()) < kFullTile * kTile * kTile) {
                out.push_back(0);
                continue;
            }
            // The mean of what lies near the median: a median alone moves by whole steps.
            const double middle = middle_of(values);
            double count = 0;
            for (const double value : values) {
                if (std::abs(value - middle) > kMovedShare * middle) continue;
                sum += value;
                ++count;
            }
            out.push_back(count < kFullTile * kTile * kTile ? 0 : sum / count);
        }
    }
    return out;
}

void DriftWatch::add(double time_s, const Image<float>& depth_m,
                     std::optional<double> temperature_c) {
    const std::vector<double> tiles = tiles_of(depth_m);
    if (reference_.empty()) {
        reference_.assign(tiles.size(), 0);
        reference_counts_.assign(tiles.size(), 0);
    }
    if (frames_++ < kReferenceFrames) {
        for (std::size_t i = 0; i < tiles.size(); ++i) {
            if (tiles[i] == 0) continue;
            const double count = ++reference_counts_[i];
            reference_[i] += (tiles[i] - reference_[i]) / count;
        }
    }
    std::vector<double> distances;
    std::vector<double> ratios;
    for (std::size_t i = 0; i < tiles.size(); ++i) {
        if (tiles[i] == 0 || reference_[i] == 0) continue;
        const double ratio = tiles[i] / reference_[i];
        if (std::abs(ratio - 1) > kMovedShare) continue;
        ratios.push_back(ratio);
        distances.push_back(tiles[i]);
    }
    if (ratios.size() < kLeastTiles) return;
    DriftPoint point;
    point.time_s = time_s;
    point.distance_m = middle_of(distances);
    point.scale = middle_of(ratios);
    for (double& ratio : ratios) ratio = std::abs(ratio - point.scale);
    point.sigma = middle_of(ratios) / 0.6745 / std::sqrt(static_cast<double>(ratios.size()));
    point.temperature_c = temperature_c;
    seen_.push_back(point);
}

DriftSeries DriftWatch::series(int points) const {
    DriftSeries out;
    if (seen_.empty()) return out;
    const double first = seen_.front().time_s;
    const double span = std::max(1e-9, seen_.back().time_s - first);
    std::size_t at = 0;
    for (int bin = 0; bin < points && at < seen_.size(); ++bin) {
        const double end = first + span * (bin + 1) / points;
        DriftPoint mean{};
        mean.scale = 0;
        double count = 0;
        double temperature = 0;
        double temperatures = 0;
        for (; at < seen_.size() && (seen_[at].time_s <= end || bin + 1 == points); ++at) {
            const DriftPoint& p = seen_[at];
            mean.time_s += p.time_s - first;
            mean.distance_m += p.distance_m;
            mean.scale += p.scale;
            mean.sigma += p.sigma * p.sigma;
            ++count;
            if (!p.temperature_c) continue;
            temperature += *p.temperature_c;
            ++temperatures;
        }
        if (count == 0) continue;
        mean.time_s /= count;
        mean.distance_m /= count;
        mean.scale /= count;
        mean.sigma = std::sqrt(mean.sigma) / count;
        if (temperatures > 0) mean.temperature_c = temperature / temperatures;
        out.points.push_back(mean);
    }
    out.warm_up = fit_warm_up(out.points);
    std::vector<double> kelvin;
    std::vector<double> scale;
    for (const DriftPoint& p : out.points) {
        if (!p.temperature_c) continue;
        kelvin.push_back(*p.temperature_c);
        scale.push_back(p.scale);
    }
    if (kelvin.size() >= kLeastPoints) {
        const DriftLine line = line_through(kelvin, scale);
        if (line.b_sigma > 0) out.per_kelvin = line.b;
    }
    return out;
}

std::optional<WarmUp> fit_warm_up(const std::vector<DriftPoint>& points) {
    if (points.size() < kLeastPoints) return std::nullopt;
    const double span = points.back().time_s - points.front().time_s;
    if (!(span > 0)) return std::nullopt;
    std::vector<double> y;
    for (const DriftPoint& p : points) y.push_back(p.scale);
    std::optional<DriftLine> best;
    double tau = 0;
    for (double t = span / 50; t < 2 * span; t *= 1.05) {
        std::vector<double> x;
        for (const DriftPoint& p : points) x.push_back(std::exp(-p.time_s / t));
        const DriftLine line = line_through(x, y);
        if (best && line.squares >= best->squares) continue;
        best = line;
        tau = t;
    }
    if (!best || !(std::abs(best->b) > kStandsOutSigmas * best->b_sigma)) return std::nullopt;
    return WarmUp{best->a, -best->b / best->a, tau};
}

}  // namespace kino
