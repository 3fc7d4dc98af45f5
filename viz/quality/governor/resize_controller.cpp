#include "viz/quality/governor/resize_controller.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "base/check.h"

namespace kino {
namespace {

constexpr std::size_t kRecent = 5;
/// An estimate a little too high is slow, one too low oscillates.
constexpr double kCaution = 1.1;
constexpr double kNear = 0.1;
constexpr double kLeastShare = 0.7;
constexpr double kLeastCostMs = 0.1;

}  // namespace

double stability_bound(int delay) {
    return 2 * std::sin(std::numbers::pi / (2 * (2.0 * delay + 1)));
}

double no_overshoot_bound(int delay) {
    if (delay == 0) return 1;
    return std::pow(delay, delay) / std::pow(delay + 1.0, delay + 1.0);
}

ResizeController::ResizeController(const ResizeOptions& options)
    : options_(options), model_(options.initial_cost_ms, 0), r_(options.r_start) {
    KINO_CHECK(options.r_min > 0 && options.delay >= 0);
    KINO_CHECK(options.r_start >= options.r_min && options.r_start <= options.r_max);
    KINO_CHECK(options.initial_cost_ms > 0 && options.target_ms > 0);
}

double ResizeController::r() const {
    if (options_.quantum <= 0) return r_;
    const double steps = std::round(r_ / options_.quantum);
    return std::clamp(steps * options_.quantum, options_.r_min, options_.r_max);
}

bool ResizeController::is_outlier(double ms) const {
    if (!options_.reject_outliers || recent_ms_.size() < kRecent) return false;
    std::vector<double> sorted(recent_ms_.begin(), recent_ms_.end());
    std::nth_element(sorted.begin(), sorted.begin() + kRecent / 2, sorted.end());
    return ms > 2 * sorted[kRecent / 2];
}

double ResizeController::begin_frame() {
    const double drawn = r();
    drawn_u_.push_back(1 / (drawn * drawn));
    return drawn;
}

void ResizeController::frame_took(double ms, bool says_nothing) {
    KINO_CHECK(!drawn_u_.empty());
    const double u_then = drawn_u_.front();
    drawn_u_.pop_front();
    if (says_nothing || !std::isfinite(ms) || ms < 0) return;

    const bool outlier = is_outlier(ms);
    recent_ms_.push_back(ms);
    if (recent_ms_.size() > kRecent) recent_ms_.pop_front();
    const bool emergency = ms > 2 * options_.target_ms;
    if (outlier && !emergency) return;
    if (!outlier && options_.learn) model_.add(u_then, ms);
    double miss = options_.target_ms - ms;
    if (std::abs(miss) < options_.dead_band * options_.target_ms) return;
    double cost = options_.initial_cost_ms;
    if (options_.learn) {
        // Near the target most of a miss is noise, and following it all would double it.
        if (std::abs(miss) < kNear * options_.target_ms) miss *= 0.5;
        // Were there no rest, all pixels would take ms / u: K is at most that, whatever the line
        // says that still remembers the load of before.
        const double most = std::max(kLeastCostMs, ms / u_then);
        cost = std::clamp(kCaution * model_.slope(), kLeastShare * most, most) /
               no_overshoot_bound(options_.delay);
    }
    const double limit = emergency ? options_.emergency_step
                                   : std::max(options_.max_step, options_.max_relative_step * r_);
    move_to(1 / (r_ * r_) + miss / cost, std::max(limit, options_.max_step));
}

void ResizeController::move_to(double u, double step_limit) {
    const double wanted = u > 0 ? 1 / std::sqrt(u) : options_.r_max;
    const double step = std::clamp(wanted - r_, -step_limit, step_limit);
    r_ = std::clamp(r_ + step, options_.r_min, options_.r_max);
}

}  // namespace kino
