#pragma once

#include <filesystem>
#include <functional>
#include <glm/vec2.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "viz/frame/renderer.h"
#include "viz/gpu/device.h"
#include "viz/output/swapchain.h"

struct GLFWwindow;

namespace kino {

struct WindowOptions {
    std::string title = "Kinoscope";
    int width = 1280;  ///< px
    int height = 720;
    PresentMode present = PresentMode::fifo;
};

/// A key, named by GLFW's key codes (printable keys are their ASCII capitals).
struct KeyPress {
    int key = 0;
    bool shift = false;
    bool control = false;
    bool repeat = false;
};

struct MouseButtonEvent {
    int button = 0;  ///< 0 left, 1 right, 2 middle
    bool down = false;
    glm::dvec2 at{0};  ///< px of the picture
};

/// What happened since the last poll, oldest first.
struct WindowInput {
    std::vector<KeyPress> keys;
    std::vector<MouseButtonEvent> buttons;
    std::vector<std::filesystem::path> dropped;
    glm::dvec2 scroll{0};
    glm::dvec2 cursor_px{0};  ///< px of the picture, whatever the scale of the display
};

/// A window with a swapchain; pictures are drawn straight into its images. One thread, one at a
/// time in the process.
class Window {
  public:
    /// Fails, rather than ends, where there is no display.
    [[nodiscard]] static Result<std::unique_ptr<Window>> open(const WindowOptions& options);
    ~Window();
    Window(const Window&) = delete;
    Window& operator=(const Window&) = delete;

    /// What the device must be made with so that it can present here.
    [[nodiscard]] std::vector<std::string> instance_extensions() const;
    /// Must be undone by detach() before the device goes.
    [[nodiscard]] Result<void> attach(gpu::Device& device);
    void detach();

    [[nodiscard]] bool should_close() const;
    void close();
    void set_title(const std::string& title);
    /// Waits up to `timeout` for something to happen (0: looks only).
    [[nodiscard]] WindowInput poll(TimeNs timeout);
    [[nodiscard]] bool is_key_down(int key) const;
    [[nodiscard]] bool is_button_down(int button) const;
    [[nodiscard]] bool minimised() const;
    /// Hides the cursor and lets it move without end, for looking around.
    void capture_cursor(bool capture);

    /// An image to draw the next picture into. Empty: minimised, or the size just changed; poll and
    /// call again.
    [[nodiscard]] Result<std::optional<PictureTarget>> begin_picture();
    /// Shows what was drawn; the device must be done with it.
    [[nodiscard]] Result<void> present();
    /// How pictures are shown now; fifo where the surface does not offer what was asked for.
    [[nodiscard]] PresentMode present_mode() const;

    [[nodiscard]] GLFWwindow* handle() const;

  private:
    struct State;
    explicit Window(std::unique_ptr<State> state);
    std::unique_ptr<State> state_;
};

}  // namespace kino
