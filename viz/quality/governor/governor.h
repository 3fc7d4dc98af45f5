#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "viz/quality/governor/level_choice.h"

namespace kino {

enum class GovernorMode : std::uint8_t {
    off,       ///< every part at its best level
    fixed,     ///< the levels that were set, by name
    automatic  ///< what loses least within the budget
};

/// One setting of a part: how much it is to do, in any unit that grows with the time (pixels,
/// pixels times lights), and the mean FLIP that it adds to the picture.
struct LevelOffer {
    std::string name;
    double work = 1;
    double error = 0;
    int kind = 0;  ///< small steps between levels of one kind are seen by nobody
};

/// Something whose accuracy can be traded for time in this frame; levels best first. What a scene
/// does not call for is not offered.
struct PartOffer {
    std::string name;
    std::vector<LevelOffer> levels;
    double first_ms_per_work = 1e-6;  ///< taken until something was measured
};

struct GovernorOptions {
    GovernorMode mode = GovernorMode::automatic;
    double target_ms = 1000.0 / 30;
    double headroom = 0.95;    ///< share of the target that a choice may fill
    int late_frames = 3;       ///< this many over the target in a row ask for cheaper levels
    int calm_frames = 30;      ///< and after a change, better ones wait this long
    double least_gain = 0.05;  ///< share of the error that a better choice must save
    double late_above = 1;     ///< a frame is late beyond this many targets
    /// Within their kinds, levels that take at most this share of the target more need to wait only
    /// `small_calm_frames`; 0: all better ones wait for `calm_frames`.
    double small_step = 0;
    int small_calm_frames = 4;
    /// False: offers are times already (ms = work x first_ms_per_work), learnt by who makes them.
    bool learns = true;
    std::map<std::string, std::string> fixed;  ///< part -> level, for GovernorMode::fixed
};

/// Owns the frame budget. Parts are offered every frame; their costs are learnt from what they
/// took, and the set of levels that loses least within the budget is chosen (choose_levels). Gets
/// cheaper after a few late frames, better after a calm time. A choice that had to be taken back
/// waits twice as long as the last time, and so does all that is as dear, so that it does not swing
/// between two. A choice that is neither cheaper nor better than another is left after the calm
/// time, late or not.
class Governor {
  public:
    explicit Governor(GovernorOptions options) : options_(std::move(options)) {}

    /// Levels for the frame that is about to be drawn, one index a part. Parts that were not
    /// offered last time bring a new choice at once, from what their work is predicted to take; so
    /// does a `jump`, work that is known before drawing to be quite another than last time.
    [[nodiscard]] std::span<const std::size_t> begin_frame(std::span<const PartOffer> wanted,
                                                           bool jump = false);
    /// What a part of this frame took, where it was measured on its own.
    void part_took(std::string_view name, double ms);
    /// Ends the frame. `says_nothing`: pipelines were made, or the picture cut.
    void frame_took(double ms, bool says_nothing = false);

    void set_target(double ms) { options_.target_ms = ms; }
    void set_headroom(double share) { options_.headroom = share; }
    [[nodiscard]] double target_ms() const { return options_.target_ms; }
    /// Of the frame begun last: what it is expected to take, and to lose.
    [[nodiscard]] double predicted_ms() const { return predicted_ms_; }
    [[nodiscard]] double estimated_error() const { return estimated_error_; }
    [[nodiscard]] std::int64_t changes() const { return changes_; }

  private:
    struct Learnt {
        std::map<std::string, double, std::less<>> ms_per_work;  ///< by level's name
        double newest_ms_per_work = 0;                           ///< of any level; 0: none yet
    };

    [[nodiscard]] std::vector<std::vector<Level>> costs(std::span<const PartOffer> wanted) const;
    [[nodiscard]] std::vector<std::size_t> fixed_choice(std::span<const PartOffer> wanted) const;
    void reconsider(const std::vector<std::vector<Level>>& levels, bool at_once);
    /// What is not beyond a small step from the choice.
    [[nodiscard]] std::vector<std::vector<Level>> near(
        const std::vector<std::vector<Level>>& levels) const;
    /// Costs that a better choice stays below: those of the one that failed, while it waits.
    [[nodiscard]] double failed_cost(const std::vector<std::vector<Level>>& levels) const;
    void note_failure();
    void change(std::vector<std::size_t> to, double cost_ms, int waited);

    GovernorOptions options_;
    std::map<std::string, Learnt, std::less<>> learnt_;
    std::vector<PartOffer> offered_;
    std::vector<std::size_t> choice_;
    double rest_ms_ = 0;  ///< what no part accounts for
    double pace_ = 1;     ///< how much slower everything is than what was learnt
    double predicted_ms_ = 0;
    double estimated_error_ = 0;
    int late_in_a_row_ = 0;
    int frames_since_change_ = 0;
    int calm_frames_ = 0;  ///< since a change that was no small step to better
    int up_waited_ = 0;    ///< frames that the last change waited, if it was to better; else 0
    std::vector<std::size_t> failed_;  ///< the choice that had to be taken back last
    double tried_ms_ = 0;              ///< what the last change was thought to take
    double failed_ms_ = 0;             ///< and the one that failed
    int patience_ = 0;                 ///< frames that it waits
    int frames_since_failure_ = 0;
    std::int64_t changes_ = 0;
};

}  // namespace kino
