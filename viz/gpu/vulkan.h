#pragma once

#include <volk.h>

#include <string>

#include "base/error.h"

namespace kino::gpu {

[[nodiscard]] const char* result_name(VkResult result);

/// The error a failed Vulkan call becomes; `call` says what was being done.
[[nodiscard]] tl::unexpected<Error> vulkan_error(VkResult result, const std::string& call);

}  // namespace kino::gpu

#define KINO_VK_TRY(call, doing)                                      \
    do {                                                              \
        if (const VkResult kino_vk = (call); kino_vk != VK_SUCCESS) { \
            return ::kino::gpu::vulkan_error(kino_vk, doing);         \
        }                                                             \
    } while (false)
