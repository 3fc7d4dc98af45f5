#include "skeleton/gestures/gesture_template.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <utility>

namespace kino {
namespace {

constexpr double kLeastS = 0.2, kMostS = 5, kLeastTravel = 0.5;
constexpr double kThresholdOfSpread = 1.6, kLeastThreshold = 0.12, kMostSpread = 0.35;
constexpr std::ptrdiff_t kBand = 6;

bool uses(Hand hand, std::size_t side) {
    return hand == Hand::both || hand == (side == 0 ? Hand::left : Hand::right);
}

GestureTemplate::Example resample(const HandPath& path) {
    const auto& in = path.samples;
    GestureTemplate::Example out;
    std::size_t at = 0;
    for (std::size_t i = 0; i < GestureTemplate::kSamples; ++i) {
        const double w = static_cast<double>(i) / (GestureTemplate::kSamples - 1);
        const double t = glm::mix(in.front().time_s, in.back().time_s, w);
        while (at + 2 < in.size() && in[at + 1].time_s < t) ++at;
        const HandPath::Sample &a = in[at], &b = in[at + 1];
        const double span = b.time_s - a.time_s;
        const double part = span > 0 ? std::clamp((t - a.time_s) / span, 0.0, 1.0) : 1;
        out.push_back({glm::mix(a.hand[0], b.hand[0], part), glm::mix(a.hand[1], b.hand[1], part)});
    }
    return out;
}

double travel(const GestureTemplate::Example& example, std::size_t side) {
    double sum = 0;
    for (std::size_t i = 1; i < example.size(); ++i)
        sum += glm::distance(example[i - 1][side], example[i][side]);
    return sum;
}

}  // namespace

double GestureTemplate::distance(const Example& a, const Example& b) const {
    struct Cell {
        double sum = std::numeric_limits<double>::infinity();
        double weight = 1;
    };
    constexpr auto n = static_cast<std::ptrdiff_t>(kSamples);
    std::array<Cell, kSamples> above{}, row{};
    for (std::ptrdiff_t i = 0; i < n; ++i) {
        row.fill({});
        for (std::ptrdiff_t j = std::max<std::ptrdiff_t>(0, i - kBand);
             j <= std::min(n - 1, i + kBand); ++j) {
            const auto u = static_cast<std::size_t>(i), v = static_cast<std::size_t>(j);
            double cost = 0;
            for (std::size_t side = 0; side < 2; ++side)
                if (uses(hand_, side)) cost = std::max(cost, glm::distance(a[u][side], b[v][side]));
            Cell best = i == 0 && j == 0 ? Cell{0, 0} : Cell{};
            double step = 2;
            if (i > 0 && j > 0) best = above[v - 1];
            if (i > 0 && above[v].sum + cost < best.sum + step * cost) best = above[v], step = 1;
            if (j > 0 && row[v - 1].sum + cost < best.sum + step * cost)
                best = row[v - 1], step = 1;
            row[v] = {best.sum + step * cost, best.weight + step};
        }
        above = row;
    }
    return above.back().sum / above.back().weight;
}

double GestureTemplate::distance(const HandPath& path) const {
    double best = std::numeric_limits<double>::infinity();
    if (path.samples.size() < 2) return best;
    const Example seen = resample(path);
    for (const Example& example : examples_) best = std::min(best, distance(seen, example));
    return best;
}

Result<GestureTemplate> GestureTemplate::learn(std::string name, Hand hand,
                                               std::span<const HandPath> paths) {
    if (paths.size() < 3 || paths.size() > kMaxExamples)
        return fail(fmt::format("{} examples given", paths.size()), name,
                    fmt::format("3 to {} examples are needed", kMaxExamples));
    if (hand == Hand::none) return fail("a learned gesture needs a hand", name);
    GestureTemplate out;
    out.name_ = name;
    out.hand_ = hand;
    double shortest = kMostS, longest = 0;
    for (const HandPath& path : paths) {
        const double span_s =
            path.samples.size() < 2 ? 0 : path.samples.back().time_s - path.samples.front().time_s;
        if (!(span_s >= kLeastS && span_s <= kMostS))
            return fail("an example is too short or too long", name, "0.2 s to 5 s");
        shortest = std::min(shortest, span_s);
        longest = std::max(longest, span_s);
        out.examples_.push_back(resample(path));
        for (std::size_t side = 0; side < 2; ++side)
            if (uses(hand, side) && !(travel(out.examples_.back(), side) >= kLeastTravel))
                return fail("a hand hardly moves in an example", name,
                            "half an arm's length at least");
    }
    double spread = 0;
    for (std::size_t i = 0; i < out.examples_.size(); ++i)
        for (std::size_t j = 0; j < i; ++j)
            spread = std::max(spread, out.distance(out.examples_[i], out.examples_[j]));
    if (!(spread <= kMostSpread))
        return fail("the examples differ too much from each other", name,
                    "perform the gesture alike each time");
    return restore(std::move(name), hand, 0.6 * shortest, 1.6 * longest,
                   std::max(kLeastThreshold, kThresholdOfSpread * spread),
                   std::move(out.examples_));
}

Result<GestureTemplate> GestureTemplate::restore(std::string name, Hand hand, double least_s,
                                                 double most_s, double threshold,
                                                 std::vector<Example> examples) {
    if (name.empty() || name.size() > 64)
        return fail("a learned gesture needs a name of 1 to 64 bytes", name);
    if (hand == Hand::none) return fail("a learned gesture needs a hand", name);
    if (!(least_s >= 0.05 && least_s <= most_s && most_s <= 10))
        return fail("durations are out of order or range", name, "0.05 s to 10 s");
    if (!(threshold >= 0.01 && threshold <= 1))
        return fail("the threshold is out of range", name, "0.01 to 1");
    if (examples.empty() || examples.size() > kMaxExamples)
        return fail("the number of examples is out of range", name);
    for (const Example& example : examples) {
        if (example.size() != kSamples) return fail("an example has not 32 samples", name);
        for (const auto& hands : example)
            for (const glm::dvec3& p : hands)
                if (!(std::abs(p.x) < 10 && std::abs(p.y) < 10 && std::abs(p.z) < 10))
                    return fail("a sample is out of reach", name);
    }
    GestureTemplate out;
    out.name_ = std::move(name);
    out.hand_ = hand;
    out.least_s_ = least_s;
    out.most_s_ = most_s;
    out.threshold_ = threshold;
    out.examples_ = std::move(examples);
    return out;
}

}  // namespace kino
