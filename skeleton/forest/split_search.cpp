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

// n log2 n, looked up where n is small.
class LogTable {
  public:
    LogTable() : values_(1 << 16, 0.0) {
        for (std::size_t i = 1; i < values_.size(); ++i) values_[i] = exact(i);
    }
    [[nodiscard]] double operator()(std::uint64_t n) const {
        return n < values_.size() ? values_[n] : exact(n);
    }

  private:
    static double exact(std::uint64_t n) {
        return static_cast<double>(n) * std::log2(static_cast<double>(n));
    }
    std::vector<double> values_;
};

const LogTable& times_log2() {
    static const LogTable table;
    return table;
}

// Histograms of this size stay in a core's cache beside a picture.
constexpr std::size_t kCountsBytes = 384 << 10;

int rounded_to_eight(int n) {
    return (n + 7) / 8 * 8;
}

std::uint32_t packed(const std::array<std::int16_t, 2>& offset) {
    return static_cast<std::uint16_t>(offset[0]) |
           static_cast<std::uint32_t>(static_cast<std::uint16_t>(offset[1])) << 16;
}

}  // namespace

double information(std::span<const std::uint64_t> counts) {
    double sum = 0;
    for (const std::uint64_t c : counts) sum += times_log2()(c);
    return sum;
}

SplitCandidates draw_candidates(const SplitSpace& space, std::uint64_t seed, std::uint64_t tree,
                                std::uint64_t path) {
    TrainingRandom random{seed, tree, path};
    SplitCandidates out;
    for (int f = 0; f < space.features; ++f) {
        ForestFeature feature;
        feature.u = draw_offset(random, space.reach_mm);
        if (f >= space.features / 2) feature.v = draw_offset(random, space.reach_mm);
        out.features.push_back(feature);
    }
    for (int t = 0; t < space.thresholds; ++t) {
        // One in each of even strata, then squared: dense around no difference, sparse where only
        // the background is.
        const double u = 2 * (t + random.unit()) / space.thresholds - 1;
        out.thresholds_mm.push_back(
            static_cast<std::int16_t>(std::lround(space.threshold_range_mm * u * std::abs(u))));
    }
    return out;
}

BestSplit SplitSearch::best(const SplitCandidates& candidates, int labels,
                            const NodeSamples& samples, std::span<const forest::WalkImage> images,
                            int first, int last) {
    prepare(candidates, labels, samples);
    BestSplit best;
    const std::size_t per_feature = present_.size() * bins_ * sizeof(std::uint32_t);
    if (per_feature == 0) return best;
    const int half = static_cast<int>(candidates.features.size()) / 2;
    const int step = std::max(16, static_cast<int>(kCountsBytes / per_feature));
    for (int at = first; at < last; at += step) {
        Chunk chunk{at, std::min(at + step, last), 0, 0};
        chunk.singles = std::clamp(half - at, 0, chunk.last - at);
        chunk.pairs_at = rounded_to_eight(chunk.singles);
        count(candidates, chunk, samples, images);
        judge(candidates, chunk, best);
    }
    best.gain_bits = best_gain_ / static_cast<double>(samples_);
    return best;
}

void SplitSearch::prepare(const SplitCandidates& candidates, int labels,
                          const NodeSamples& samples) {
    const auto& thresholds = candidates.thresholds_mm;
    bins_ = thresholds.size() + 1;
    low_ = thresholds.front();
    high_ = thresholds.back() + 1;
    bin_of_.resize(static_cast<std::size_t>(high_ - low_) + 1);
    std::size_t bin = 0;
    for (std::int32_t r = low_; r <= high_; ++r) {
        while (bin < thresholds.size() && r > thresholds[bin]) ++bin;
        bin_of_[static_cast<std::size_t>(r - low_)] = static_cast<std::uint8_t>(bin);
    }
    totals_.assign(static_cast<std::size_t>(labels), 0);
    samples_ = 0;
    for (const TrainingSample* s = samples.first; s < samples.last; s += samples.stride) {
        ++totals_[s->label];
        ++samples_;
    }
    present_.clear();
    slot_of_.assign(totals_.size(), -1);
    for (int l = 0; l < labels; ++l) {
        if (totals_[static_cast<std::size_t>(l)] == 0) continue;
        slot_of_[static_cast<std::size_t>(l)] = static_cast<int>(present_.size());
        present_.push_back(l);
    }
    // n H = n log n - sum of c log c, so n times the gain needs no division.
    whole_ = times_log2()(samples_) - information(totals_);
    best_gain_ = 0;
}

void SplitSearch::count(const SplitCandidates& candidates, const Chunk& chunk,
                        const NodeSamples& samples, std::span<const forest::WalkImage> images) {
    const auto features = static_cast<std::size_t>(chunk.last - chunk.first);
    const auto pairs = features - static_cast<std::size_t>(chunk.singles);
    const auto pairs_at = static_cast<std::size_t>(chunk.pairs_at);
    const auto padded_pairs = static_cast<std::size_t>(rounded_to_eight(static_cast<int>(pairs)));
    u_.assign(pairs_at + padded_pairs, 0);
    v_.assign(padded_pairs, 0);
    for (std::size_t i = 0; i < features; ++i) {
        const ForestFeature& f = candidates.features[static_cast<std::size_t>(chunk.first) + i];
        if (i < static_cast<std::size_t>(chunk.singles)) {
            u_[i] = packed(f.u);
            continue;
        }
        const std::size_t pair = i - static_cast<std::size_t>(chunk.singles);
        u_[pairs_at + pair] = packed(f.u);
        v_[pair] = packed(f.v);
    }
    responses_.resize(u_.size());
    counts_.assign(present_.size() * features * bins_, 0);
    const std::uint8_t* const bin_of = bin_of_.data();
    for (const TrainingSample* s = samples.first; s < samples.last; s += samples.stride) {
        const forest::WalkImage& image = images[s->image];
        const forest::ProbePixel pixel{s->xy, s->scale, low_, high_};
        functions_->probe(image, pixel, u_.data(), nullptr, pairs_at, responses_.data());
        functions_->probe(image, pixel, u_.data() + pairs_at, v_.data(), padded_pairs,
                          responses_.data() + pairs_at);
        std::uint32_t* at =
            counts_.data() + static_cast<std::size_t>(slot_of_[s->label]) * features * bins_;
        const std::int32_t* response = responses_.data();
        for (int i = 0; i < chunk.singles; ++i, at += bins_) ++at[bin_of[response[i]]];
        response += pairs_at;
        for (std::size_t i = 0; i < pairs; ++i, at += bins_) ++at[bin_of[response[i]]];
    }
}

void SplitSearch::judge(const SplitCandidates& candidates, const Chunk& chunk, BestSplit& best) {
    const LogTable& log = times_log2();
    const auto features = static_cast<std::size_t>(chunk.last - chunk.first);
    left_.resize(bins_);
    right_.resize(bins_);
    left_samples_.resize(bins_);
    for (std::size_t f = 0; f < features; ++f) {
        std::fill(left_.begin(), left_.end(), 0.0);
        std::fill(right_.begin(), right_.end(), 0.0);
        std::fill(left_samples_.begin(), left_samples_.end(), 0);
        for (std::size_t slot = 0; slot < present_.size(); ++slot) {
            const std::uint32_t* counts = counts_.data() + (slot * features + f) * bins_;
            const std::uint64_t all = totals_[static_cast<std::size_t>(present_[slot])];
            std::uint64_t sum = 0;
            double left = 0, right = log(all);
            for (std::size_t b = 0; b + 1 < bins_; ++b) {
                if (counts[b] != 0) {
                    sum += counts[b];
                    left = log(sum);
                    right = log(all - sum);
                }
                left_[b] += left;
                right_[b] += right;
                left_samples_[b] += sum;
            }
        }
        for (std::size_t b = 0; b + 1 < bins_; ++b) {
            const std::uint64_t n_left = left_samples_[b];
            if (n_left == 0 || n_left == samples_ || (b > 0 && n_left == left_samples_[b - 1]))
                continue;
            const double gain =
                whole_ - (log(n_left) - left_[b]) - (log(samples_ - n_left) - right_[b]);
            if (gain <= best_gain_) continue;
            best_gain_ = gain;
            best.candidate = chunk.first + static_cast<int>(f);
            best.feature = candidates.features[static_cast<std::size_t>(best.candidate)];
            best.threshold_mm = candidates.thresholds_mm[b];
            best.left.assign(totals_.size(), 0);
            best.right = totals_;
            for (std::size_t slot = 0; slot < present_.size(); ++slot) {
                const std::uint32_t* counts = counts_.data() + (slot * features + f) * bins_;
                const auto label = static_cast<std::size_t>(present_[slot]);
                for (std::size_t i = 0; i <= b; ++i) best.left[label] += counts[i];
                best.right[label] -= best.left[label];
            }
        }
    }
}

}  // namespace kino
