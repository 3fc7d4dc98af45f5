#pragma once

#include <memory>

#include "apps/calibrate/guided_capture.h"

namespace kino {

/// A guided capture in a window: each camera's picture with its fields (a field that no view has
/// shown is dark), the board drawn back in the colour of the guide's state, which tilts and
/// distances are there, and what to do now in large letters. Enter or closing the window ends the
/// capture and goes on with the views that are there.
class GuideWindow : public GuideScreen {
  public:
    /// Fails where there is no display or no Vulkan device.
    [[nodiscard]] static Result<std::unique_ptr<GuideWindow>> open(const Board& board);
    ~GuideWindow() override;

    [[nodiscard]] Result<bool> show(const GuidedFrame& frame) override;
    [[nodiscard]] Result<bool> idle() override;
    [[nodiscard]] bool wants_real_time() const override { return true; }

  private:
    struct State;
    explicit GuideWindow(std::unique_ptr<State> state);
    std::unique_ptr<State> state_;
};

}  // namespace kino
