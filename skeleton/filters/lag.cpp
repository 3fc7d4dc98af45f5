#include "skeleton/filters/lag.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <vector>

#include "base/check.h"

namespace kino {
namespace {

glm::dvec3 mean_of(std::span<const glm::dvec3> track) {
    glm::dvec3 sum(0);
    for (const glm::dvec3& p : track) sum += p;
    return track.empty() ? sum : sum / static_cast<double>(track.size());
}

double correlation(std::span<const glm::dvec3> a, std::span<const glm::dvec3> b) {
    const glm::dvec3 mean_a = mean_of(a), mean_b = mean_of(b);
    double ab = 0, aa = 0, bb = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        ab += glm::dot(a[i] - mean_a, b[i] - mean_b);
        aa += glm::dot(a[i] - mean_a, a[i] - mean_a);
        bb += glm::dot(b[i] - mean_b, b[i] - mean_b);
    }
    const double scale = std::sqrt(aa * bb);
    return scale > 1e-12 ? ab / scale : 0;
}

}  // namespace

LagAndResidual measure_lag(std::span<const glm::dvec3> truth, std::span<const glm::dvec3> filtered,
                           double dt_s, double max_lag_s) {
    KINO_CHECK_EQ(truth.size(), filtered.size());
    KINO_CHECK(dt_s > 0 && max_lag_s >= 0);
    const auto size = static_cast<std::ptrdiff_t>(truth.size());
    const auto reach = static_cast<std::ptrdiff_t>(std::ceil(max_lag_s / dt_s));
    const std::ptrdiff_t count = size - 2 * reach;
    KINO_CHECK(count > 0);
    const auto middle =
        filtered.subspan(static_cast<std::size_t>(reach), static_cast<std::size_t>(count));
    std::vector<double> scores;
    for (std::ptrdiff_t lag = -reach; lag <= reach; ++lag)
        scores.push_back(correlation(
            truth.subspan(static_cast<std::size_t>(reach - lag), static_cast<std::size_t>(count)),
            middle));
    const std::ptrdiff_t best = std::max_element(scores.begin(), scores.end()) - scores.begin();
    LagAndResidual out;
    out.correlation = scores[static_cast<std::size_t>(best)];
    double lag = static_cast<double>(best - reach);
    if (out.correlation <= 0) {
        out.correlation = 0;
        lag = 0;
    } else if (best > 0 && best < 2 * reach) {
        const double before = scores[static_cast<std::size_t>(best - 1)];
        const double after = scores[static_cast<std::size_t>(best + 1)];
        const double bend = before - 2 * out.correlation + after;
        if (bend < 0) {
            lag += 0.5 * (before - after) / bend;
            out.correlation -= (before - after) * (before - after) / (8 * bend);
        }
    }
    double sum = 0;
    for (std::ptrdiff_t i = reach; i < size - reach; ++i) {
        const double at =
            std::clamp(static_cast<double>(i) - lag, 0.0, static_cast<double>(size - 1));
        const auto low = static_cast<std::size_t>(at);
        const std::size_t high = std::min(low + 1, truth.size() - 1);
        const glm::dvec3 meant = glm::mix(truth[low], truth[high], at - static_cast<double>(low));
        const glm::dvec3 off = filtered[static_cast<std::size_t>(i)] - meant;
        sum += glm::dot(off, off);
    }
    out.lag_s = lag * dt_s;
    out.residual_rms_m = std::sqrt(sum / static_cast<double>(count));
    return out;
}

double rms_about_mean_m(std::span<const glm::dvec3> track) {
    if (track.empty()) return 0;
    const glm::dvec3 mean = mean_of(track);
    double sum = 0;
    for (const glm::dvec3& p : track) sum += glm::dot(p - mean, p - mean);
    return std::sqrt(sum / static_cast<double>(track.size()));
}

}  // namespace kino
