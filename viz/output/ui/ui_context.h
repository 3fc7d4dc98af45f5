#pragma once

#include <memory>

#include "base/error.h"

struct GLFWwindow;
struct ImDrawData;
struct ImFont;

namespace kino {

/// Dear ImGui for one window: context, look, font, input. Make it after the window's own callbacks
/// are set; it passes on to them. It goes before the window.
class UiContext {
  public:
    explicit UiContext(GLFWwindow* window, float font_px = 15);
    /// Without window and input, for pictures: begin_picture() instead of begin_frame().
    explicit UiContext(float font_px);
    ~UiContext();
    UiContext(const UiContext&) = delete;
    UiContext& operator=(const UiContext&) = delete;

    void begin_frame();
    /// A frame of this size (px), `dt_s` > 0 after the last; asks no window and no clock.
    void begin_picture(int width, int height, double dt_s);
    [[nodiscard]] ImDrawData& end_frame();
    /// The pointer is over the user interface, or one of its widgets is being dragged.
    [[nodiscard]] bool wants_mouse() const;
    [[nodiscard]] bool wants_keyboard() const;

  private:
    bool has_window_ = false;
};

}  // namespace kino
