#include "viz/quality/lod_plan.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/check.h"

namespace kino {
namespace {

constexpr std::array<double, 8> kPlanLevels = {1, 1.25, 1.5, 2, 3, 4, 5.6, 8};

/// Lagrange's factor for one component.
double factor_at(const LodComponent& c, double lambda, double most) {
    if (c.error <= 0) return most;
    const double r =
        std::pow(2 * lambda * c.cost_ns / (c.exponent * c.error), 1 / (c.exponent + 2));
    return std::clamp(r, 1.0, most);
}

double nearest_level(std::span<const double> levels, double r) {
    return *std::min_element(levels.begin(), levels.end(), [r](double a, double b) {
        return std::abs(std::log(a / r)) < std::abs(std::log(b / r));
    });
}

/// Plans compare by error within the budget; beyond it, by cost.
bool better(const LodPlan& a, const LodPlan& b) {
    if (a.within_budget != b.within_budget) return a.within_budget;
    return a.within_budget ? a.error < b.error : a.cost_ns < b.cost_ns;
}

/// Tries every change of one component, and of two at once, until none helps.
LodPlan bettered(std::span<const LodComponent> components, LodPlan plan, double budget_ns,
                 double reconstruction_ns, std::span<const double> levels, LodChain chain) {
    const auto price = [&](const std::vector<double>& r) {
        return price_lod_plan(components, r, budget_ns, reconstruction_ns, chain);
    };
    for (bool moved = true; moved;) {
        moved = false;
        for (std::size_t i = 0; i < components.size(); ++i) {
            for (std::size_t j = i; j < components.size(); ++j) {
                for (const double ri : levels) {
                    for (const double rj : levels) {
                        if (i == j && ri != rj) continue;
                        std::vector<double> r = plan.r;
                        r[i] = ri;
                        r[j] = rj;
                        const LodPlan other = price(r);
                        if (!better(other, plan)) continue;
                        plan = other;
                        moved = true;
                    }
                }
            }
        }
    }
    return plan;
}

/// Reconstructions of a chain of these factors, in full-size ones.
double chain_length(std::vector<double> r) {
    std::sort(r.begin(), r.end());
    double sum = 0;
    double finer = 1;
    for (const double factor : r) {
        if (factor <= finer) continue;
        sum += 1 / (finer * finer);
        finer = factor;
    }
    return sum;
}

}  // namespace

std::span<const double> lod_plan_levels() {
    return kPlanLevels;
}

bool LodPlan::resizes() const {
    return std::any_of(r.begin(), r.end(), [](double v) { return v > 1; });
}

LodPlan price_lod_plan(std::span<const LodComponent> components, std::vector<double> r,
                       double budget_ns, double reconstruction_ns, LodChain chain) {
    KINO_CHECK_EQ(components.size(), r.size());
    LodPlan plan;
    plan.r = std::move(r);
    for (std::size_t i = 0; i < components.size(); ++i) {
        const LodComponent& c = components[i];
        const double factor = plan.r[i];
        plan.cost_ns += c.cost_ns / (factor * factor);
        if (factor > 1) plan.error += c.error * std::pow(factor, c.exponent);
    }
    if (plan.resizes()) {
        plan.cost_ns +=
            reconstruction_ns * (chain == LodChain::nested ? chain_length(plan.r) : 1.0);
    }
    plan.within_budget = plan.cost_ns <= budget_ns;
    return plan;
}

LodPlan plan_lod(std::span<const LodComponent> components, double budget_ns,
                 double reconstruction_ns, std::span<const double> levels, LodChain chain) {
    KINO_CHECK(!levels.empty() && levels.front() == 1);
    const auto price = [&](std::vector<double> r) {
        return price_lod_plan(components, std::move(r), budget_ns, reconstruction_ns, chain);
    };
    LodPlan best = price(std::vector<double>(components.size(), 1.0));
    if (best.within_budget) return best;  // nothing is gained by resizing

    // What is not resized at all adds no error, a step that Lagrange's condition does not know: it
    // is asked for every split of the components.
    constexpr std::size_t kMostSplit = 10;
    KINO_CHECK_LE(components.size(), kMostSplit);
    for (std::size_t whole = 0; whole < std::size_t{1} << components.size(); ++whole) {
        const auto factors = [&](double lambda) {
            std::vector<double> r;
            r.reserve(components.size());
            for (std::size_t i = 0; i < components.size(); ++i) {
                r.push_back(
                    (whole >> i & 1) != 0 ? 1.0 : factor_at(components[i], lambda, levels.back()));
            }
            return r;
        };
        double low = 1e-12;
        double high = 1e12;
        for (int step = 0; step < 60; ++step) {
            const double middle = std::sqrt(low * high);
            (price(factors(middle)).cost_ns > budget_ns ? low : high) = middle;
        }
        std::vector<double> snapped = factors(high);
        for (double& r : snapped) r = nearest_level(levels, r);
        LodPlan plan = bettered(components, price(std::move(snapped)), budget_ns, reconstruction_ns,
                                levels, chain);
        if (better(plan, best)) best = std::move(plan);
    }
    return best;
}

LodPlan plan_nested_lod(std::span<const LodComponent> components, double budget_ns,
                        double reconstruction_ns) {
    constexpr double kMostNested = 8;
    LodPlan best;
    for (double first = 1.25; first <= 4; first += 0.25) {
        std::vector<double> levels = {1};
        for (double r = first; r <= kMostNested; r *= 2) levels.push_back(r);
        LodPlan plan = plan_lod(components, budget_ns, reconstruction_ns, levels, LodChain::nested);
        if (best.r.empty() || better(plan, best)) best = std::move(plan);
    }
    return best;
}

LodTimeFit fit_lod_time(std::span<const double> r, std::span<const double> ms) {
    KINO_CHECK_EQ(r.size(), ms.size());
    double uu = 0, uv = 0, vv = 0, u1 = 0, v1 = 0;
    for (std::size_t i = 0; i < r.size(); ++i) {
        const double u = 1 / (r[i] * r[i] * ms[i]);
        const double v = 1 / ms[i];
        uu += u * u;
        uv += u * v;
        vv += v * v;
        u1 += u;
        v1 += v;
    }
    const double determinant = uu * vv - uv * uv;
    KINO_CHECK(determinant > 0);
    return {(u1 * vv - v1 * uv) / determinant, (uu * v1 - uv * u1) / determinant};
}

}  // namespace kino
