#include "viz/output/swapchain.h"

#include <algorithm>
#include <array>

#include "base/check.h"
#include "viz/gpu/commands.h"

namespace kino {
namespace {

/// An 8-bit format without sRGB coding: what is drawn is coded already.
Result<VkSurfaceFormatKHR> choose_format(VkPhysicalDevice physical, VkSurfaceKHR surface) {
    std::uint32_t count = 0;
    KINO_VK_TRY(vkGetPhysicalDeviceSurfaceFormatsKHR(physical, surface, &count, nullptr),
                "listing surface formats");
    std::vector<VkSurfaceFormatKHR> formats(count);
    KINO_VK_TRY(vkGetPhysicalDeviceSurfaceFormatsKHR(physical, surface, &count, formats.data()),
                "listing surface formats");
    for (const VkFormat wanted : {VK_FORMAT_B8G8R8A8_UNORM, VK_FORMAT_R8G8B8A8_UNORM}) {
        for (const VkSurfaceFormatKHR& format : formats) {
            if (format.format == wanted) return format;
        }
    }
    return fail("the window offers no plain 8-bit format", "Vulkan");
}

VkPresentModeKHR vulkan_mode(PresentMode mode) {
    switch (mode) {
        case PresentMode::mailbox:
            return VK_PRESENT_MODE_MAILBOX_KHR;
        case PresentMode::immediate:
            return VK_PRESENT_MODE_IMMEDIATE_KHR;
        case PresentMode::fifo:
            break;
    }
    return VK_PRESENT_MODE_FIFO_KHR;
}

/// The wanted one where the surface offers it.
Result<PresentMode> choose_mode(VkPhysicalDevice physical, VkSurfaceKHR surface,
                                PresentMode wanted) {
    std::uint32_t count = 0;
    KINO_VK_TRY(vkGetPhysicalDeviceSurfacePresentModesKHR(physical, surface, &count, nullptr),
                "listing present modes");
    std::vector<VkPresentModeKHR> modes(count);
    KINO_VK_TRY(vkGetPhysicalDeviceSurfacePresentModesKHR(physical, surface, &count, modes.data()),
                "listing present modes");
    const bool there = std::find(modes.begin(), modes.end(), vulkan_mode(wanted)) != modes.end();
    return there ? wanted : PresentMode::fifo;
}

}  // namespace

Swapchain::~Swapchain() {
    device_.wait_idle();
    destroy_images();
    if (chain_ != VK_NULL_HANDLE) vkDestroySwapchainKHR(device_.handle(), chain_, nullptr);
    if (acquired_ != VK_NULL_HANDLE) vkDestroyFence(device_.handle(), acquired_, nullptr);
}

void Swapchain::destroy_images() {
    for (VkImageView view : views_) vkDestroyImageView(device_.handle(), view, nullptr);
    views_.clear();
    images_.clear();
}

Result<bool> Swapchain::make(VkExtent2D wanted) {
    VkSurfaceCapabilitiesKHR can;
    KINO_VK_TRY(vkGetPhysicalDeviceSurfaceCapabilitiesKHR(device_.physical(), surface_, &can),
                "asking the surface");
    VkExtent2D extent = can.currentExtent;
    if (extent.width == UINT32_MAX) {
        extent = {std::clamp(wanted.width, can.minImageExtent.width, can.maxImageExtent.width),
                  std::clamp(wanted.height, can.minImageExtent.height, can.maxImageExtent.height)};
    }
    if (extent.width == 0 || extent.height == 0) return false;
    if (acquired_ == VK_NULL_HANDLE) {
        const VkFenceCreateInfo fence{.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
        KINO_VK_TRY(vkCreateFence(device_.handle(), &fence, nullptr, &acquired_),
                    "creating a fence");
    }
    KINO_ASSIGN(const VkSurfaceFormatKHR format, choose_format(device_.physical(), surface_));
    KINO_ASSIGN(mode_, choose_mode(device_.physical(), surface_, wanted_));
    std::uint32_t count = std::max(can.minImageCount, 3u);
    if (can.maxImageCount != 0) count = std::min(count, can.maxImageCount);
    const VkSwapchainKHR old = chain_;
    const VkSwapchainCreateInfoKHR create{
        .sType = VK_STRUCTURE_TYPE_SWAPCHAIN_CREATE_INFO_KHR,
        .surface = surface_,
        .minImageCount = count,
        .imageFormat = format.format,
        .imageColorSpace = format.colorSpace,
        .imageExtent = extent,
        .imageArrayLayers = 1,
        .imageUsage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT |
                      (can.supportedUsageFlags &
                       (VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT)),
        .imageSharingMode = VK_SHARING_MODE_EXCLUSIVE,
        .preTransform = can.currentTransform,
        .compositeAlpha = VK_COMPOSITE_ALPHA_OPAQUE_BIT_KHR,
        .presentMode = vulkan_mode(mode_),
        .clipped = VK_TRUE,
        .oldSwapchain = old};
    device_.wait_idle();
    KINO_VK_TRY(vkCreateSwapchainKHR(device_.handle(), &create, nullptr, &chain_),
                "creating the swapchain");
    destroy_images();
    if (old != VK_NULL_HANDLE) vkDestroySwapchainKHR(device_.handle(), old, nullptr);
    format_ = format.format;
    extent_ = extent;
    KINO_VK_TRY(vkGetSwapchainImagesKHR(device_.handle(), chain_, &count, nullptr),
                "listing swapchain images");
    images_.resize(count);
    KINO_VK_TRY(vkGetSwapchainImagesKHR(device_.handle(), chain_, &count, images_.data()),
                "listing swapchain images");
    for (VkImage image : images_) {
        const VkImageViewCreateInfo view{
            .sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO,
            .image = image,
            .viewType = VK_IMAGE_VIEW_TYPE_2D,
            .format = format_,
            .subresourceRange = {
                .aspectMask = VK_IMAGE_ASPECT_COLOR_BIT, .levelCount = 1, .layerCount = 1}};
        VkImageView made = VK_NULL_HANDLE;
        KINO_VK_TRY(vkCreateImageView(device_.handle(), &view, nullptr, &made),
                    "creating a swapchain view");
        views_.push_back(made);
    }
    stale_ = false;
    return true;
}

Result<std::optional<PictureTarget>> Swapchain::acquire(VkExtent2D wanted) {
    if (stale_) {
        KINO_ASSIGN(const bool made, make(wanted));
        if (!made) return std::nullopt;
    }
    const VkResult got = vkAcquireNextImageKHR(device_.handle(), chain_, UINT64_MAX, VK_NULL_HANDLE,
                                               acquired_, &current_);
    if (got == VK_ERROR_OUT_OF_DATE_KHR) {
        stale_ = true;
        return std::nullopt;
    }
    if (got == VK_SUBOPTIMAL_KHR) {
        stale_ = true;  // still good for this one picture
    } else {
        KINO_VK_TRY(got, "asking for a swapchain image");
    }
    KINO_VK_TRY(vkWaitForFences(device_.handle(), 1, &acquired_, VK_TRUE, UINT64_MAX),
                "waiting for a swapchain image");
    KINO_VK_TRY(vkResetFences(device_.handle(), 1, &acquired_), "resetting a fence");
    KINO_TRY(device_.submit_and_wait([&](VkCommandBuffer commands) {
        gpu::Commands(device_, commands).to_general(images_[current_]);
    }));
    return PictureTarget{
        .image = images_[current_], .view = views_[current_], .extent = extent_, .format = format_};
}

Result<void> Swapchain::present() {
    KINO_TRY(device_.submit_and_wait([&](VkCommandBuffer commands) {
        gpu::Commands(device_, commands).to_present(images_[current_]);
    }));
    const VkPresentInfoKHR info{.sType = VK_STRUCTURE_TYPE_PRESENT_INFO_KHR,
                                .swapchainCount = 1,
                                .pSwapchains = &chain_,
                                .pImageIndices = &current_};
    const VkResult shown = vkQueuePresentKHR(device_.queue(), &info);
    if (shown == VK_SUBOPTIMAL_KHR || shown == VK_ERROR_OUT_OF_DATE_KHR) {
        stale_ = true;
        return {};
    }
    KINO_VK_TRY(shown, "showing a picture");
    return {};
}

}  // namespace kino
