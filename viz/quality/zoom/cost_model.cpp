#include "viz/quality/zoom/cost_model.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "base/check.h"
#include "viz/quality/zoom/zoom_options.h"

namespace kino {
namespace {

/// Before anything is learnt, costs may be off by about themselves.
constexpr double kStartVariance = 1;
constexpr std::size_t kFrameFeature = 0, kCopyFeature = 4;

std::vector<double> costs_in_order(const ZoomWorkCosts& costs) {
    std::vector<double> all{costs.frame, costs.vertex, costs.triangle, costs.draw, costs.copy};
    all.insert(all.end(), costs.pixel.begin(), costs.pixel.end());
    return all;
}

}  // namespace

WorkCostModel::WorkCostModel(std::vector<double> start_ms, const WorkCostOptions& options)
    : options_(options),
      n_(start_ms.size()),
      scale_(std::move(start_ms)),
      cost_(n_, 1.0),
      covariance_(n_ * n_, 0.0) {
    for (const double s : scale_) KINO_CHECK(s > 0);
    for (std::size_t i = 0; i < n_; ++i) covariance_[i * n_ + i] = kStartVariance;
}

double WorkCostModel::predict_ms(std::span<const double> work) const {
    KINO_CHECK_EQ(work.size(), n_);
    double sum = 0;
    for (std::size_t i = 0; i < n_; ++i) sum += cost_[i] * scale_[i] * work[i];
    return sum;
}

std::vector<double> WorkCostModel::costs_ms() const {
    std::vector<double> costs(n_);
    for (std::size_t i = 0; i < n_; ++i) costs[i] = cost_[i] * scale_[i];
    return costs;
}

void WorkCostModel::learn(std::span<const double> work, double ms) {
    KINO_CHECK_EQ(work.size(), n_);
    bool usable = std::isfinite(ms) && ms >= 0;
    std::vector<double> x(n_);
    for (std::size_t i = 0; i < n_; ++i) {
        x[i] = work[i] * scale_[i];
        usable = usable && std::isfinite(x[i]);
    }
    if (!usable) return;
    std::vector<double> px(n_, 0.0);
    double against = options_.forgetting;
    for (std::size_t i = 0; i < n_; ++i) {
        for (std::size_t j = 0; j < n_; ++j) px[i] += covariance_[i * n_ + j] * x[j];
        against += x[i] * px[i];
    }
    const double error = ms - predict_ms(work);
    for (std::size_t i = 0; i < n_; ++i) {
        cost_[i] = std::max(0.0, cost_[i] + px[i] / against * error);
    }
    for (std::size_t i = 0; i < n_; ++i) {
        for (std::size_t j = 0; j < n_; ++j) {
            double& p = covariance_[i * n_ + j];
            p = (p - px[i] * px[j] / against) / options_.forgetting;
        }
    }
    bound();
}

void WorkCostModel::bound() {
    double trace = 0;
    for (std::size_t i = 0; i < n_; ++i) trace += covariance_[i * n_ + i];
    const double most = options_.most_growth * kStartVariance * static_cast<double>(n_);
    // Shrunk as a whole, so that it stays what it is in proportion, and positive.
    const double shrink = trace > most ? most / trace : 1;
    for (double& p : covariance_) p *= shrink;
    const double ridge = options_.ridge * std::min(trace, most);
    for (std::size_t i = 0; i < n_; ++i) {
        covariance_[i * n_ + i] += ridge;
        for (std::size_t j = 0; j < i; ++j) {
            const double mean = 0.5 * (covariance_[i * n_ + j] + covariance_[j * n_ + i]);
            covariance_[i * n_ + j] = covariance_[j * n_ + i] = mean;
        }
    }
}

PredictiveZoom::PredictiveZoom(const ZoomRules& rules, const ZoomWorkCosts& start,
                               const WorkCostOptions& options)
    : rules_(rules),
      release_(rules),
      materials_(start.pixel.size()),
      model_(costs_in_order(start), options) {
    KINO_CHECK(rules.most >= 1 && rules.most <= kMaxZoom);
}

std::vector<double> PredictiveZoom::features(const ZoomWork& work, int z) const {
    KINO_CHECK_EQ(work.pixels.size(), materials_);
    std::vector<double> all{1, work.vertices, work.triangles, work.draws, z > 1 ? 1.0 : 0.0};
    for (const double pixels : work.pixels) all.push_back(pixels / (z * z));
    return all;
}

double PredictiveZoom::predict_ms(const ZoomWork& work, int z) const {
    return model_.predict_ms(features(work, z));
}

ZoomChoice PredictiveZoom::choose(const ZoomWork& work) {
    std::array<double, kMaxZoom> ms{};
    for (int z = 1; z <= rules_.most; ++z) {
        ms[static_cast<std::size_t>(z - 1)] = predict_ms(work, z);
    }
    const ZoomChoice choice =
        release_.choose(std::span(ms).first(static_cast<std::size_t>(rules_.most)));
    work_ = work;
    z_ = choice.z;
    return choice;
}

void PredictiveZoom::frame_took(double ms) {
    learn(work_, z_, ms);
}

void PredictiveZoom::learn(const ZoomWork& work, int z, double ms) {
    if (work.pixels.size() == materials_) model_.learn(features(work, z), ms);
}

void PredictiveZoom::copy_took(double ms) {
    std::vector<double> own(kCopyFeature + 1 + materials_, 0.0);
    own[kCopyFeature] = 1;
    model_.learn(own, ms);
}

void PredictiveZoom::part_took(const ZoomWork& part, int z, double ms) {
    std::vector<double> own = features(part, z);
    own[kFrameFeature] = own[kCopyFeature] = 0;
    // Nothing done teaches nothing, but would be forgetting.
    if (std::any_of(own.begin(), own.end(), [](double x) { return x > 0; })) model_.learn(own, ms);
}

}  // namespace kino
