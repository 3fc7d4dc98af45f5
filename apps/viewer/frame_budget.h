#pragma once

#include <cstdint>
#include <string>
#include <vector>

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
};

/// What was chosen for a frame, and what it is expected to cost and lose.
struct FrameChoice {
    double lod = 1;
    int zoom = 1;
    std::vector<std::string> levels;  ///< "light: r 2", as the overlay shows them
    double predicted_ms = 0;
    double estimated_error = 0;  ///< mean FLIP
    friend bool operator==(const FrameChoice&, const FrameChoice&) = default;
};

/// Keeps a program's pictures at their rate: offers the governor what can be traded in this scene,
/// puts its choice into the frame's options, and tells it what the frame took.
class FrameBudget {
  public:
    explicit FrameBudget(const FrameBudgetOptions& options);

    /// Sets `frame.lod` and `frame.zoom` for the frame that is about to be drawn.
    const FrameChoice& begin_frame(const Scene& scene, const View& view, FrameOptions& frame);
    /// `frame_ms`: the whole of it, with what else shares the cores. `says_nothing`: a cut, a
    /// resize, a screenshot.
    void frame_took(const FrameResult& result, double frame_ms, bool says_nothing = false);

    [[nodiscard]] const FrameChoice& choice() const { return choice_; }
    void set_target(double ms);
    /// Choices of all frames so far, a line where one changed, for summaries; replay() repeats
    /// them instead of choosing.
    struct Logged {
        std::int64_t frame = 0;
        double lod = 1;
        int zoom = 1;
        friend bool operator==(const Logged&, const Logged&) = default;
    };
    [[nodiscard]] const std::vector<Logged>& log() const { return log_; }
    void replay(std::vector<Logged> log);

  private:
    FrameBudgetOptions options_;
    Governor governor_;
    FrameChoice choice_;
    std::vector<Logged> log_;
    std::vector<Logged> replayed_;
    std::int64_t frame_ = 0;
};

}  // namespace kino
