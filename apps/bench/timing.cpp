#include "apps/bench/timing.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "base/check.h"

namespace kino::bench {

namespace {

constexpr int kFewestRounds = 5;

using Clock = std::chrono::steady_clock;

double ms_since(Clock::time_point start) {
    return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

double run_once(const Candidate& candidate) {
    if (candidate.prepare) candidate.prepare();
    const auto start = Clock::now();
    candidate.run();
    return ms_since(start);
}

}  // namespace

double quantile(std::span<const double> samples, double q) {
    if (samples.empty()) return std::numeric_limits<double>::quiet_NaN();
    KINO_CHECK(q >= 0 && q <= 1);
    std::vector<double> sorted(samples.begin(), samples.end());
    std::sort(sorted.begin(), sorted.end());
    const double rank = q * static_cast<double>(sorted.size() - 1);
    const auto below = static_cast<std::size_t>(std::floor(rank));
    const auto above = std::min(below + 1, sorted.size() - 1);
    return std::lerp(sorted[below], sorted[above], rank - static_cast<double>(below));
}

double Timing::median_ms() const {
    return quantile(ms, 0.5);
}
double Timing::p95_ms() const {
    return quantile(ms, 0.95);
}

const Timing& Comparison::operator[](std::string_view name) const {
    const auto found = std::find_if(timings_.begin(), timings_.end(),
                                    [&](const Timing& timing) { return timing.name == name; });
    KINO_CHECK(found != timings_.end());
    return *found;
}

double Comparison::speedup(std::string_view candidate, std::string_view baseline) const {
    const Timing& fast = (*this)[candidate];
    const Timing& slow = (*this)[baseline];
    KINO_CHECK_EQ(fast.ms.size(), slow.ms.size());
    std::vector<double> ratios(fast.ms.size());
    for (std::size_t i = 0; i < ratios.size(); ++i) {
        // A clock tick is the least that anything can take.
        ratios[i] = std::max(slow.ms[i], 1e-6) / std::max(fast.ms[i], 1e-6);
    }
    return quantile(ratios, 0.5);
}

Comparison compare(std::span<const Candidate> candidates, RepeatOptions options) {
    KINO_CHECK_LT(0, options.repeats);
    std::vector<Timing> timings(candidates.size());
    for (std::size_t i = 0; i < candidates.size(); ++i) {
        KINO_CHECK(static_cast<bool>(candidates[i].run));
        timings[i].name = candidates[i].name;
    }
    for (int round = 0; round < options.warm_up; ++round) {
        for (const Candidate& candidate : candidates) static_cast<void>(run_once(candidate));
    }
    const auto start = Clock::now();
    for (int round = 0; round < options.repeats; ++round) {
        if (round >= kFewestRounds && ms_since(start) > options.max_seconds * 1000) break;
        for (std::size_t i = 0; i < candidates.size(); ++i) {
            const std::size_t which = round % 2 == 0 ? i : candidates.size() - 1 - i;
            timings[which].ms.push_back(run_once(candidates[which]));
        }
    }
    return Comparison(std::move(timings));
}

}  // namespace kino::bench
