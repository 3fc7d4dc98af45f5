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
    ~UiContext();
    UiContext(const UiContext&) = delete;
    UiContext& operator=(const UiContext&) = delete;

    void begin_frame();
    [[nodiscard]] ImDrawData& end_frame();
    /// The pointer is over the user interface, or one of its widgets is being dragged.
    [[nodiscard]] bool wants_mouse() const;
    [[nodiscard]] bool wants_keyboard() const;
};

}  // namespace kino
