#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "apps/viewer/picture_cost.h"
#include "apps/viewer/picture_levels.h"
#include "apps/viewer/picture_work.h"
#include "apps/viewer/surprises.h"
#include "viz/frame/renderer.h"
#include "viz/quality/governor/governor.h"
#include "viz/scene/scene.h"
#include "viz/scene/view.h"

namespace kino {

struct FrameBudgetOptions {
    /// Off: full quality. Fixed: `lod` and `zoom` as they are. Automatic: the governor's choice.
    GovernorMode mode = GovernorMode::off;
    double target_ms = 1000.0 / 30;
    double lod = 1;     ///< fixed: resizing factor of the light
    int zoom = 1;       ///< fixed: pixels of the screen along a side of a drawn one
    int most_zoom = 2;  ///< automatic: not beyond
    /// Automatic: levels that lose more (mean FLIP) are not taken however late frames are.
    double worst_error = 1;
    /// With guided coarse light: at most this share of the pixels, those that no coarse one
    /// resembles, is shaded anew (FramebufferLodOptions::fix_share).
    double fix_share = 0;
};

/// What was chosen for a frame, and what it is expected to cost and lose.
struct FrameChoice {
    double lod = 1;
    int zoom = 1;
    bool bilinear = false;            ///< the light is brought to full size without guides
    std::vector<std::string> levels;  ///< "light 1/2", as the overlay shows them; empty: full
    double predicted_ms = 0;          ///< 0: not known
    double estimated_error = 0;       ///< mean FLIP
    friend bool operator==(const FrameChoice&, const FrameChoice&) = default;
};

/// Keeps a program's pictures at their rate: offers the governor what can be traded in this scene,
/// puts its choice into the frame's options, and tells it what the frame took. A level that is
/// expected to save less than a twentieth of the frame is not worth its error and not chosen; nor,
/// where it misses the target all the same, one that saves little for what it loses.
class FrameBudget {
  public:
    explicit FrameBudget(const FrameBudgetOptions& options);

    /// Sets `frame.lod` and `frame.zoom` for the frame that is about to be drawn, and has groups
    /// of passes measured as far as it wants to know them (frame.timing). Off: leaves all as is.
    const FrameChoice& begin_frame(const Scene& scene, const View& view, FrameOptions& frame);
    /// `frame_ms`: the whole of it, with what else shares the cores. `says_nothing`: a cut, a
    /// resize, a screenshot.
    void frame_took(const FrameResult& result, double frame_ms, bool says_nothing = false);

    /// What hardly a frame takes longer than, judged by the last ones: how long before its turn to
    /// begin a picture (frame_pacer.h). In every mode; the target before the first frame.
    [[nodiscard]] double expected_ms() const;
    [[nodiscard]] const FrameChoice& choice() const { return choice_; }
    [[nodiscard]] double target_ms() const { return options_.target_ms; }
    [[nodiscard]] GovernorMode mode() const { return options_.mode; }
    void set_target(double ms);
    void set_mode(GovernorMode mode) { options_.mode = mode; }
    /// Fixed levels: from the next frame on, as somebody else chooses (ZoomChooser).
    void set_zoom(int zoom) { options_.zoom = zoom; }
    /// Expected parts of the frame at the level that was chosen; empty before anything was learnt
    /// and where the mode is not automatic.
    [[nodiscard]] std::vector<PictureCost::Part> parts() const;

    /// Choices of all frames so far, a line where one changed, for summaries; replay() repeats
    /// them instead of choosing.
    struct Logged {
        std::int64_t frame = 0;
        double lod = 1;
        int zoom = 1;
        bool bilinear = false;
        friend bool operator==(const Logged&, const Logged&) = default;
    };
    [[nodiscard]] const std::vector<Logged>& log() const { return log_; }
    /// Frames count from the next one on; before the first line they are drawn in full.
    void replay(std::vector<Logged> log);

  private:
    void choose(const Scene& scene, const View& view);
    /// The work is quite another than in the frame before.
    [[nodiscard]] bool jumped(const PictureWork& before) const;
    /// Share of the target that a choice may fill.
    [[nodiscard]] double headroom() const;
    /// Whether a level is worth its error beside a better and dearer one.
    [[nodiscard]] bool pays(std::size_t level, double ms, double better_ms,
                            double better_error) const;
    void take(const PictureLevel& level);
    void note();

    FrameBudgetOptions options_;
    Governor governor_;
    PictureCost cost_;
    std::vector<PictureLevel> levels_;
    std::size_t level_ = 0;  ///< of levels_, that the frame is drawn at
    glm::ivec2 size_{0};
    bool staged_ = false;
    PictureWork work_;
    Surprises surprises_;
    bool knew_groups_ = false;
    int late_in_a_row_ = 0;
    int frames_since_change_ = 0;
    int frames_since_jump_ = 0;
    FrameChoice choice_;
    std::vector<Logged> log_;
    std::vector<Logged> replayed_;
    bool replays_ = false;
    std::int64_t frame_ = 0;
    std::array<double, 32> recent_ms_{};
    std::size_t recent_ = 0;  ///< of all frames' times
};

}  // namespace kino
