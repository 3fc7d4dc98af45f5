#include "viz/quality/governor/governor.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/check.h"

namespace kino {
namespace {

constexpr double kLearn = 0.2;  ///< weight of a new measurement of a part
constexpr double kPace = 0.15;  ///< and of a whole frame
constexpr double kOdd = 4;      ///< a frame this much slower than expected teaches nothing
constexpr int kMostPatience = 1920;
/// A failure counts as another of the same for so many times what it waited.
constexpr int kRemembered = 12;
/// What failed is tried again when it costs so much less than it did.
constexpr double kRelief = 0.15;
/// Beside what failed, nothing is taken that is hardly cheaper.
constexpr double kBelowFailure = 0.97;

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

std::vector<std::vector<Level>> Governor::near(
    const std::vector<std::vector<Level>>& levels) const {
    constexpr double kNever = std::numeric_limits<double>::infinity();
    auto near = levels;
    for (std::size_t i = 0; i < levels.size(); ++i) {
        const double most = levels[i][choice_[i]].cost_ms + options_.small_step * target_ms();
        for (std::size_t level = 0; level < levels[i].size(); ++level) {
            const bool same = offered_[i].levels[level].kind == offered_[i].levels[choice_[i]].kind;
            if (!same || levels[i][level].cost_ms > most) near[i][level].cost_ms = kNever;
        }
    }
    return near;
}

double Governor::failed_cost(const std::vector<std::vector<Level>>& levels) const {
    constexpr double kAny = std::numeric_limits<double>::infinity();
    if (failed_.size() != levels.size() || frames_since_failure_ >= patience_) return kAny;
    for (std::size_t i = 0; i < failed_.size(); ++i) {
        if (failed_[i] >= levels[i].size()) return kAny;
    }
    const double now = sum_of(levels, failed_).cost_ms;
    return now < (1 - kRelief) * failed_ms_ ? kAny : now;
}

void Governor::note_failure() {
    // A new failure long after the last one is none of the same.
    const bool one_of_many = frames_since_failure_ < kRemembered * patience_;
    patience_ =
        std::min(kMostPatience, 2 * std::max(one_of_many ? patience_ : 0, options_.calm_frames));
    failed_ = choice_;
    failed_ms_ = tried_ms_;
    frames_since_failure_ = 0;
}

void Governor::change(std::vector<std::size_t> to, double cost_ms, int waited) {
    choice_ = std::move(to);
    tried_ms_ = cost_ms;
    frames_since_change_ = calm_frames_ = 0;
    late_in_a_row_ = 0;
    up_waited_ = waited;
    ++changes_;
}

void Governor::reconsider(const std::vector<std::vector<Level>>& levels, bool at_once) {
    const double budget = options_.headroom * options_.target_ms - pace_ * rest_ms_;
    auto wanted = choose_levels(levels, budget);
    if (at_once) {
        failed_.clear();
        if (wanted != choice_) change(wanted, sum_of(levels, wanted).cost_ms, 0);
        return;
    }
    if (wanted == choice_) return;
    const Level now = sum_of(levels, choice_);
    const double wanted_ms = sum_of(levels, wanted).cost_ms;
    if (late_in_a_row_ >= options_.late_frames && wanted_ms < now.cost_ms) {
        const int soon = 2 * std::max(up_waited_, options_.calm_frames);
        if (up_waited_ > 0 && frames_since_change_ < soon) note_failure();
        return change(std::move(wanted), wanted_ms, 0);
    }
    const double most = std::min(budget, kBelowFailure * failed_cost(levels));
    // Where one choice after the other fails, it is the load that comes and goes: cheaper ones wait
    // half as long as the last that failed.
    const int again =
        frames_since_failure_ < patience_ ? std::max(1, patience_ / (2 * options_.calm_frames)) : 1;
    const auto try_better = [&](const std::vector<std::vector<Level>>& among, int calm_for,
                                int calm) {
        if (calm_for < again * calm) return false;
        auto better = choose_levels(among, most);
        const Level then = sum_of(levels, better);
        if (!(then.error < (1 - options_.least_gain) * now.error)) return false;
        // While even the cheapest is late, a choice that nothing is won by is given up all the
        // same.
        const bool wins_nothing = then.cost_ms <= now.cost_ms;
        if (then.cost_ms > most && !wins_nothing) return false;
        if (late_in_a_row_ > 0 && !wins_nothing) return false;
        change(std::move(better), then.cost_ms, wins_nothing ? 0 : again * calm);
        return true;
    };
    if (try_better(levels, calm_frames_, options_.calm_frames)) return;
    if (!(options_.small_step > 0)) return;
    const int calm_for = calm_frames_;
    if (try_better(near(levels), frames_since_change_, options_.small_calm_frames)) {
        calm_frames_ = calm_for;
    }
}

std::span<const std::size_t> Governor::begin_frame(std::span<const PartOffer> wanted, bool jump) {
    for (const PartOffer& part : wanted) KINO_CHECK(!part.levels.empty());
    const bool new_parts = !same_parts(wanted, offered_) || choice_.size() != wanted.size();
    offered_.assign(wanted.begin(), wanted.end());
    const auto levels = costs(offered_);
    if (options_.mode == GovernorMode::automatic) {
        if (new_parts) {
            choice_.assign(offered_.size(), 0);
            late_in_a_row_ = frames_since_change_ = calm_frames_ = up_waited_ = 0;
        }
        reconsider(levels, new_parts || jump);
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
    ++calm_frames_;
    ++frames_since_failure_;
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
