// The one translation unit that holds volk, the Vulkan loader's function table.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wpedantic"
#pragma GCC diagnostic ignored "-Wconversion"
#define VOLK_IMPLEMENTATION
#include <volk.h>
#pragma GCC diagnostic pop

#include "viz/gpu/vulkan.h"

namespace kino::gpu {

const char* result_name(VkResult result) {
    switch (result) {
        case VK_SUCCESS:
            return "success";
        case VK_TIMEOUT:
            return "timeout";
        case VK_ERROR_OUT_OF_HOST_MEMORY:
            return "out of host memory";
        case VK_ERROR_OUT_OF_DEVICE_MEMORY:
            return "out of device memory";
        case VK_ERROR_INITIALIZATION_FAILED:
            return "initialization failed";
        case VK_ERROR_DEVICE_LOST:
            return "device lost";
        case VK_ERROR_EXTENSION_NOT_PRESENT:
            return "extension not present";
        case VK_ERROR_FEATURE_NOT_PRESENT:
            return "feature not present";
        case VK_ERROR_INCOMPATIBLE_DRIVER:
            return "incompatible driver";
        case VK_ERROR_OUT_OF_DATE_KHR:
            return "surface out of date";
        case VK_ERROR_SURFACE_LOST_KHR:
            return "surface lost";
        default:
            return "Vulkan error";
    }
}

tl::unexpected<Error> vulkan_error(VkResult result, const std::string& call) {
    return fail(std::string(result_name(result)) + " (VkResult " +
                    std::to_string(static_cast<int>(result)) + ") while " + call,
                "Vulkan");
}

}  // namespace kino::gpu
