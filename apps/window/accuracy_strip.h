#pragma once

#include <optional>

#include "apps/viewer/frame_budget.h"
#include "apps/viewer/true_error.h"
#include "apps/viewer/zoom_chooser.h"

namespace kino {

/// What is drawn how accurately, what that costs and loses, and the knobs of it: bottom right.
class AccuracyStrip {
  public:
    /// The user's knobs act on both at once; at most one of them chooses.
    void draw(FrameBudget& budget, ZoomChooser& chooser);

    /// Compare a picture now and then with the same one in full.
    void want_true_error(bool on) { wants_true_error_ = on; }
    /// True if it is time to; then tell what was found.
    [[nodiscard]] bool true_error_due(std::int64_t picture) const;
    void found(const TrueError& error) { true_error_ = error; }

  private:
    bool wants_true_error_ = false;
    std::optional<TrueError> true_error_;
};

}  // namespace kino
