#include "skeleton/forest/split_search.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/check.h"
#include "skeleton/forest/training_random.h"

namespace kino {
namespace {

std::array<std::int16_t, 2> draw_offset(TrainingRandom& random, double reach_mm) {
    // An even radius looks closer near by, where parts differ most.
    const double radius = random.unit() * reach_mm * kForestOffsetsPerMm;
    const double angle = random.unit() * 2 * std::numbers::pi;
    return {static_cast<std::int16_t>(std::lround(radius * std::cos(angle))),
            static_cast<std::int16_t>(std::lround(radius * std::sin(angle)))};
}

double times_log2(std::uint64_t count) {
    static const std::vector<double> table = [] {
        std::vector<double> t(4096, 0.0);
        for (std::size_t i = 1; i < t.size(); ++i)
            t[i] = static_cast<double>(i) * std::log2(static_cast<double>(i));
        return t;
    }();
    if (count < table.size()) return table[count];
    return static_cast<double>(count) * std::log2(static_cast<double>(count));
}

}  // namespace

double information(std::span<const std::uint64_t> counts) {
    double sum = 0;
    for (const std::uint64_t c : counts) sum += times_log2(c);
    return sum;
}

SplitCandidates draw_candidates(const SplitSpace& space, std::uint64_t seed, std::uint64_t tree,
                                std::uint64_t path) {
    TrainingRandom random{seed, tree, path};
    SplitCandidates out;
    for (int f = 0; f < space.features; ++f) {
        ForestFeature feature;
        feature.u = draw_offset(random, space.reach_mm);
        if (random.unit() < 0.5) feature.v = draw_offset(random, space.reach_mm);
        out.features.push_back(feature);
        std::vector<std::int16_t> thresholds;
        for (int t = 0; t < space.thresholds; ++t) {
            // Squared: dense around no difference, sparse where only the background is.
            const double u = 2 * random.unit() - 1;
            thresholds.push_back(
                static_cast<std::int16_t>(std::lround(space.threshold_range_mm * u * std::abs(u))));
        }
        std::sort(thresholds.begin(), thresholds.end());
        out.thresholds_mm.insert(out.thresholds_mm.end(), thresholds.begin(), thresholds.end());
    }
    return out;
}

SplitSearch::SplitSearch(const SplitSpace& space, std::vector<SplitCandidates> nodes)
    : space_(space),
      nodes_(std::move(nodes)),
      per_feature_(static_cast<std::size_t>((space.thresholds + 1) * space.labels)),
      counts_(nodes_.size() * static_cast<std::size_t>(space.features) * per_feature_) {}

std::size_t SplitSearch::bytes_per_node(const SplitSpace& space) {
    const auto thresholds = static_cast<std::size_t>(space.thresholds);
    return static_cast<std::size_t>(space.features) *
           ((thresholds + 1) * static_cast<std::size_t>(space.labels) * sizeof(std::uint32_t) +
            thresholds * sizeof(std::int16_t) + sizeof(ForestFeature));
}

const std::uint32_t* SplitSearch::bins(std::size_t slot, int feature) const {
    return counts_.data() +
           (slot * static_cast<std::size_t>(space_.features) + static_cast<std::size_t>(feature)) *
               per_feature_;
}

void SplitSearch::count(std::size_t slot, std::span<const TrainingSample> samples,
                        const TrainingBlock& block, int first, int last) {
    const SplitCandidates& candidates = nodes_[slot];
    for (int f = first; f < last; ++f) {
        const ForestFeature& feature = candidates.features[static_cast<std::size_t>(f)];
        const std::int16_t* thresholds = candidates.thresholds_mm.data() + f * space_.thresholds;
        auto* const counts = const_cast<std::uint32_t*>(bins(slot, f));
        for (const TrainingSample& s : samples) {
            const std::int32_t wide =
                feature_response(block.image(s.image), s.xy, s.scale, feature);
            // Thresholds fit 16 bits and none reaches the limits, so this changes no comparison.
            const auto response = static_cast<std::int16_t>(std::clamp(wide, -32768, 32767));
            std::int16_t bin = 0;
            for (int t = 0; t < space_.thresholds; ++t)
                bin = static_cast<std::int16_t>(bin + (response > thresholds[t] ? 1 : 0));
            ++counts[bin * space_.labels + s.label];
        }
    }
}

std::vector<std::uint64_t> SplitSearch::totals(std::size_t slot) const {
    std::vector<std::uint64_t> out(static_cast<std::size_t>(space_.labels));
    const std::uint32_t* counts = bins(slot, 0);
    for (std::size_t i = 0; i < per_feature_; ++i) out[i % out.size()] += counts[i];
    return out;
}

BestSplit SplitSearch::best(std::size_t slot) const {
    const auto sum = [](const std::vector<std::uint64_t>& v) {
        std::uint64_t n = 0;
        for (const std::uint64_t c : v) n += c;
        return n;
    };
    const std::vector<std::uint64_t> all = totals(slot);
    const std::uint64_t n = sum(all);
    BestSplit best;
    if (n == 0) return best;
    // n H = n log n - sum of c log c, so n times the gain needs no division.
    const double whole = times_log2(n) - information(all);
    double best_gain = 0;
    std::vector<std::uint64_t> left(all.size()), right(all.size());
    for (int f = 0; f < space_.features; ++f) {
        const std::uint32_t* counts = bins(slot, f);
        std::fill(left.begin(), left.end(), 0);
        for (int t = 0; t < space_.thresholds; ++t) {
            for (std::size_t l = 0; l < left.size(); ++l) {
                left[l] += counts[static_cast<std::size_t>(t) * left.size() + l];
                right[l] = all[l] - left[l];
            }
            const std::uint64_t n_left = sum(left);
            if (n_left == 0 || n_left == n) continue;
            const double gain = whole - (times_log2(n_left) - information(left)) -
                                (times_log2(n - n_left) - information(right));
            if (gain <= best_gain) continue;
            best_gain = gain;
            best.feature = nodes_[slot].features[static_cast<std::size_t>(f)];
            best.threshold_mm =
                nodes_[slot].thresholds_mm[static_cast<std::size_t>(f * space_.thresholds + t)];
            best.left = left;
            best.right = right;
        }
    }
    best.gain_bits = best_gain / static_cast<double>(n);
    return best;
}

}  // namespace kino
