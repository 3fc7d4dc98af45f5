#pragma once

#include <array>
#include <memory>
#include <optional>

#include "apps/demo_show/show_screen.h"
#include "viz/frame/renderer.h"

struct GLFWwindow;

namespace kino {

/// Puts screens over pictures. One at a time in the process.
class ScreenPainter {
  public:
    /// `window` null: for pictures, without input. `height`: about that of the pictures, px, which
    /// letters are made for.
    [[nodiscard]] static Result<std::unique_ptr<ScreenPainter>> create(gpu::Device& device,
                                                                       GLFWwindow* window,
                                                                       int height);

    /// Sets frame.overlay; leaves it empty where the screen is, which then costs nothing. `this`
    /// must stay until the frame is drawn.
    void prepare(const ShowScreen& screen, const View& view, double dt_s, FrameOptions& frame);
    /// After the frame: what went wrong in its overlay.
    [[nodiscard]] Result<void> result();

  private:
    explicit ScreenPainter(std::unique_ptr<UiContext> context, bool has_window)
        : context_(std::move(context)), has_window_(has_window) {}

    std::unique_ptr<UiContext> context_;
    std::unique_ptr<UiRenderer> ui_;
    bool has_window_;
    std::array<GuidanceSpot, 2> spots_;
    std::optional<Error> trouble_;
};

}  // namespace kino
