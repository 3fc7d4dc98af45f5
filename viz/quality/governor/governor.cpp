#include "viz/quality/governor/governor.h"

#include <algorithm>
#include <cmath>

#include "base/check.h"

namespace kino {
namespace {

constexpr double kLearn = 0.2;  ///< weight of a new measurement of a part
constexpr double kPace = 0.15;  ///< and of a whole frame
constexpr double kOdd = 4;      ///< a frame this much slower than expected teaches nothing
constexpr int kMostPatience = 1920;

bool same_parts(std::span<const PartOffer> a, std::span<const PartOffer> b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                      [](const PartOffer& x, const PartOffer& y) {
                          return x.name == y.name && x.levels.size() == y.levels.size();
                      });
}

}  // namespace

std::vector<std::vector<Level>> Governor::costs(std::span<const PartOffer> wanted) const {
    std::vector<std::vector<Level>> parts;
    for (const PartOffer& part : wanted) {
        const auto found = learnt_.find(part.name);
        std::vector<Level> levels;
        for (const LevelOffer& level : part.levels) {
            double rate = part.first_ms_per_work;
            if (found != learnt_.end()) {
                const auto own = found->second.ms_per_work.find(level.name);
                if (own != found->second.ms_per_work.end()) {
                    rate = own->second;
                } else if (found->second.newest_ms_per_work > 0) {
                    rate = found->second.newest_ms_per_work;
                }
            }
            levels.push_back({pace_ * rate * level.work, level.error});
        }
        parts.push_back(std::move(levels));
    }
    return parts;
}

std::vector<std::size_t> Governor::fixed_choice(std::span<const PartOffer> wanted) const {
    std::vector<std::size_t> choice(wanted.size(), 0);
    if (options_.mode != GovernorMode::fixed) return choice;
    for (std::size_t i = 0; i < wanted.size(); ++i) {
        const auto set = options_.fixed.find(wanted[i].name);
        if (set == options_.fixed.end()) continue;
        for (std::size_t level = 0; level < wanted[i].levels.size(); ++level) {
            if (wanted[i].levels[level].name == set->second) choice[i] = level;
        }
    }
    return choice;
}

void Governor::reconsider(const std::vector<std::vector<Level>>& levels, bool new_parts) {
    const double budget = options_.headroom * options_.target_ms - pace_ * rest_ms_;
    const auto wanted = choose_levels(levels, budget);
    if (new_parts) {
        choice_ = wanted;
        frames_since_change_ = 0;
        late_in_a_row_ = 0;
        last_change_was_up_ = false;
        return;
    }
    if (wanted == choice_) return;
    const Level now = sum_of(levels, choice_);
    const Level then = sum_of(levels, wanted);
    const bool late = late_in_a_row_ >= options_.late_frames;
    if (late && then.cost_ms < now.cost_ms) {
        // A step up that did not hold: wait twice as long before the next.
        if (last_change_was_up_ && frames_since_change_ < 2 * options_.calm_frames) {
            patience_ = std::min(kMostPatience, 2 * std::max(patience_, options_.calm_frames));
        }
        last_change_was_up_ = false;
    } else {
        const int calm = std::max(patience_, options_.calm_frames);
        const bool better = then.error < (1 - options_.least_gain) * now.error;
        // While even the cheapest is late, a choice that nothing is won by is given up all the
        // same.
        const bool wins_nothing = then.cost_ms <= now.cost_ms;
        if (!better || frames_since_change_ < calm) return;
        if (late_in_a_row_ > 0 && !wins_nothing) return;
        last_change_was_up_ = !wins_nothing;
    }
    choice_ = wanted;
    frames_since_change_ = 0;
    late_in_a_row_ = 0;
    ++changes_;
}

std::span<const std::size_t> Governor::begin_frame(std::span<const PartOffer> wanted) {
    for (const PartOffer& part : wanted) KINO_CHECK(!part.levels.empty());
    const bool new_parts = !same_parts(wanted, offered_) || choice_.size() != wanted.size();
    offered_.assign(wanted.begin(), wanted.end());
    const auto levels = costs(offered_);
    if (options_.mode == GovernorMode::automatic) {
        reconsider(levels, new_parts);
    } else {
        choice_ = fixed_choice(offered_);
    }
    const Level sum = sum_of(levels, choice_);
    predicted_ms_ = sum.cost_ms + pace_ * rest_ms_;
    estimated_error_ = sum.error;
    return choice_;
}

void Governor::part_took(std::string_view name, double ms) {
    if (!std::isfinite(ms) || ms < 0) return;
    for (std::size_t i = 0; i < offered_.size(); ++i) {
        if (offered_[i].name != name) continue;
        const LevelOffer& level = offered_[i].levels[choice_[i]];
        if (!(level.work > 0)) return;
        const double rate = ms / level.work / pace_;
        Learnt& learnt = learnt_[offered_[i].name];
        const auto [own, first] = learnt.ms_per_work.emplace(level.name, rate);
        if (!first) own->second += kLearn * (rate - own->second);
        learnt.newest_ms_per_work = own->second;
    }
}

void Governor::frame_took(double ms, bool says_nothing) {
    ++frames_since_change_;
    if (says_nothing || !std::isfinite(ms) || ms < 0) return;
    late_in_a_row_ = ms > options_.late_above * options_.target_ms ? late_in_a_row_ + 1 : 0;
    if (!options_.learns) return;
    const auto levels = costs(offered_);
    const double parts_ms = sum_of(levels, choice_).cost_ms;
    const bool all_measured =
        std::all_of(offered_.begin(), offered_.end(),
                    [&](const PartOffer& part) { return learnt_.count(part.name) > 0; });
    if (all_measured) {
        // What the parts do not explain is the rest, slowly; what neither does is the machine.
        const double rest = std::max(0.0, ms - parts_ms) / pace_;
        rest_ms_ += kLearn * (rest - rest_ms_);
    }
    const double expected = parts_ms + pace_ * rest_ms_;
    if (expected > 0 && ms < kOdd * expected) {
        pace_ = std::clamp(pace_ * (1 + kPace * (ms / expected - 1)), 0.1, 10.0);
    }
}

}  // namespace kino
