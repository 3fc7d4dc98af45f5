#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "viz/frame/renderer.h"
#include "viz/gpu/device.h"

namespace kino {

/// When a finished picture reaches the screen. What the surface does not offer becomes fifo, which
/// all do.
enum class PresentMode : std::uint8_t {
    fifo,      ///< at the next retrace after those before it: no tearing, times in whole retraces
    mailbox,   ///< at the next retrace, the newest one
    immediate  ///< at once; may tear
};

/// The images a surface shows, in turn. Drawing is waited for on the host before it is shown (the
/// executor does), so no semaphores are needed. Owns neither device nor surface.
class Swapchain {
  public:
    Swapchain(gpu::Device& device, VkSurfaceKHR surface, PresentMode mode = PresentMode::fifo)
        : device_(device), surface_(surface), wanted_(mode) {}
    ~Swapchain();
    Swapchain(const Swapchain&) = delete;
    Swapchain& operator=(const Swapchain&) = delete;

    /// The next image in the GENERAL layout. Empty where the surface has no area now, or changed
    /// while it was asked. `wanted`: size where the surface leaves it open.
    [[nodiscard]] Result<std::optional<PictureTarget>> acquire(VkExtent2D wanted);
    [[nodiscard]] Result<void> present();
    /// Of the images that there are now.
    [[nodiscard]] PresentMode mode() const { return mode_; }
    /// From the next picture on.
    void set_mode(PresentMode mode) {
        stale_ = stale_ || mode != wanted_;
        wanted_ = mode;
    }

  private:
    Result<bool> make(VkExtent2D wanted);  ///< false: no area
    void destroy_images();

    gpu::Device& device_;
    VkSurfaceKHR surface_;
    PresentMode wanted_;
    PresentMode mode_ = PresentMode::fifo;
    VkSwapchainKHR chain_ = VK_NULL_HANDLE;
    VkFence acquired_ = VK_NULL_HANDLE;
    VkFormat format_ = VK_FORMAT_UNDEFINED;
    VkExtent2D extent_{};
    std::vector<VkImage> images_;
    std::vector<VkImageView> views_;
    std::uint32_t current_ = 0;
    bool stale_ = true;  ///< must be made anew before the next picture
};

}  // namespace kino
