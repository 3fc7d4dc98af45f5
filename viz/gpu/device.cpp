#include "viz/gpu/device.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <cstring>

#include "base/check.h"

namespace kino::gpu {
namespace {

constexpr std::array<const char*, 1> kLayers = {"VK_LAYER_KHRONOS_validation"};

VKAPI_ATTR VkBool32 VKAPI_CALL on_message(VkDebugUtilsMessageSeverityFlagBitsEXT severity,
                                          VkDebugUtilsMessageTypeFlagsEXT types,
                                          const VkDebugUtilsMessengerCallbackDataEXT* data,
                                          void* device) {
    // Only the validation layer's own findings count; loaders and drivers chat as "general".
    if (severity >= VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT &&
        (types & VK_DEBUG_UTILS_MESSAGE_TYPE_GENERAL_BIT_EXT) == 0) {
        std::fprintf(stderr, "vulkan: %s\n", data->pMessage);
        static_cast<Device*>(device)->count_validation_message();
    }
    return VK_FALSE;
}

bool has_layer(const char* wanted) {
    std::uint32_t count = 0;
    vkEnumerateInstanceLayerProperties(&count, nullptr);
    std::vector<VkLayerProperties> layers(count);
    vkEnumerateInstanceLayerProperties(&count, layers.data());
    return std::any_of(layers.begin(), layers.end(), [&](const VkLayerProperties& layer) {
        return std::strcmp(layer.layerName, wanted) == 0;
    });
}

bool has_extension(VkPhysicalDevice device, const char* wanted) {
    std::uint32_t count = 0;
    vkEnumerateDeviceExtensionProperties(device, nullptr, &count, nullptr);
    std::vector<VkExtensionProperties> extensions(count);
    vkEnumerateDeviceExtensionProperties(device, nullptr, &count, extensions.data());
    return std::any_of(extensions.begin(), extensions.end(), [&](const auto& extension) {
        return std::strcmp(extension.extensionName, wanted) == 0;
    });
}

int rank(VkPhysicalDeviceType type) {
    switch (type) {
        case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU:
            return 0;
        case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU:
            return 1;
        case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU:
            return 2;
        case VK_PHYSICAL_DEVICE_TYPE_CPU:
            return 3;
        default:
            return 4;
    }
}

std::string lower(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return text;
}

bool matches(const VkPhysicalDeviceProperties& properties, const std::string& wanted) {
    if (wanted.empty()) return true;
    if (wanted == "discrete") return rank(properties.deviceType) == 0;
    if (wanted == "integrated") return rank(properties.deviceType) == 1;
    if (wanted == "cpu") return rank(properties.deviceType) == 3;
    return lower(properties.deviceName).find(lower(wanted)) != std::string::npos;
}

DeviceInfo describe(VkPhysicalDevice physical) {
    VkPhysicalDeviceDriverProperties driver{
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES};
    VkPhysicalDeviceProperties2 properties{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2,
                                           .pNext = &driver};
    vkGetPhysicalDeviceProperties2(physical, &properties);
    VkPhysicalDeviceVulkan11Features features11{
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_1_FEATURES};
    VkPhysicalDeviceVulkan12Features features12{
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES, .pNext = &features11};
    VkPhysicalDeviceFeatures2 features{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2,
                                       .pNext = &features12};
    vkGetPhysicalDeviceFeatures2(physical, &features);
    DeviceInfo info;
    info.name = properties.properties.deviceName;
    info.driver = fmt::format("{} {}", driver.driverName, driver.driverInfo);
    info.is_cpu = properties.properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU;
    info.has_int64_atomics = features.features.shaderInt64 && features12.shaderBufferInt64Atomics;
    info.has_geometry_shader = features.features.geometryShader;
    info.has_multi_draw = features.features.multiDrawIndirect &&
                          features.features.drawIndirectFirstInstance &&
                          features11.shaderDrawParameters && features12.drawIndirectCount;
    info.has_statistics = features.features.pipelineStatisticsQuery;
    info.storage_alignment =
        std::max<VkDeviceSize>(16, properties.properties.limits.minStorageBufferOffsetAlignment);
    info.max_texels = properties.properties.limits.maxTexelBufferElements;
    return info;
}

Result<std::vector<VkPhysicalDevice>> physical_devices(VkInstance instance) {
    std::uint32_t count = 0;
    KINO_VK_TRY(vkEnumeratePhysicalDevices(instance, &count, nullptr), "listing devices");
    std::vector<VkPhysicalDevice> devices(count);
    KINO_VK_TRY(vkEnumeratePhysicalDevices(instance, &count, devices.data()), "listing devices");
    std::stable_sort(devices.begin(), devices.end(), [](VkPhysicalDevice a, VkPhysicalDevice b) {
        VkPhysicalDeviceProperties pa;
        VkPhysicalDeviceProperties pb;
        vkGetPhysicalDeviceProperties(a, &pa);
        vkGetPhysicalDeviceProperties(b, &pb);
        return rank(pa.deviceType) < rank(pb.deviceType);
    });
    return devices;
}

}  // namespace

Result<std::unique_ptr<Device>> Device::create(const DeviceOptions& options) {
    std::unique_ptr<Device> device(new Device());
    KINO_TRY(device->create_instance(options));
    KINO_TRY(device->choose_physical(options.device));
    KINO_TRY(device->create_device(options.presents));
    return device;
}

Result<void> Device::create_instance(const DeviceOptions& options) {
    constexpr const char* kHint = "install a Vulkan driver; mesa-vulkan-drivers needs no GPU";
    if (volkInitialize() != VK_SUCCESS) {
        return fail("no Vulkan loader on this machine", "Vulkan", "install libvulkan1");
    }
    if (volkGetInstanceVersion() < VK_API_VERSION_1_3) {
        return fail("the Vulkan loader is older than 1.3", "Vulkan", kHint);
    }
    validating_ = options.validation && has_layer(kLayers[0]);
    if (options.validation && !validating_) {
        return fail("the validation layer is asked for and not installed", "Vulkan",
                    "install vulkan-validationlayers");
    }
    std::vector<const char*> extensions;
    for (const std::string& name : options.instance_extensions) extensions.push_back(name.c_str());
    if (validating_) extensions.push_back(VK_EXT_DEBUG_UTILS_EXTENSION_NAME);
    const VkApplicationInfo app{.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO,
                                .pApplicationName = "kinoscope",
                                .apiVersion = VK_API_VERSION_1_3};
    const VkDebugUtilsMessengerCreateInfoEXT messenger{
        .sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT,
        .messageSeverity = VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT |
                           VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT,
        .messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_GENERAL_BIT_EXT |
                       VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT,
        .pfnUserCallback = on_message,
        .pUserData = this};
    const VkInstanceCreateInfo create{
        .sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO,
        .pNext = validating_ ? &messenger : nullptr,
        .pApplicationInfo = &app,
        .enabledLayerCount = validating_ ? 1u : 0u,
        .ppEnabledLayerNames = kLayers.data(),
        .enabledExtensionCount = static_cast<std::uint32_t>(extensions.size()),
        .ppEnabledExtensionNames = extensions.data()};
    if (const VkResult result = vkCreateInstance(&create, nullptr, &instance_);
        result != VK_SUCCESS) {
        instance_ = VK_NULL_HANDLE;
        Error error = vulkan_error(result, "creating the instance").value();
        error.hint = kHint;
        return fail(std::move(error));
    }
    volkLoadInstance(instance_);
    if (validating_) {
        KINO_VK_TRY(vkCreateDebugUtilsMessengerEXT(instance_, &messenger, nullptr, &messenger_),
                    "creating the debug messenger");
    }
    return {};
}

Result<void> Device::choose_physical(const std::string& wanted) {
    KINO_ASSIGN(const std::vector<VkPhysicalDevice> devices, physical_devices(instance_));
    std::string seen;
    for (VkPhysicalDevice candidate : devices) {
        VkPhysicalDeviceProperties properties;
        vkGetPhysicalDeviceProperties(candidate, &properties);
        seen += (seen.empty() ? "" : ", ") + std::string(properties.deviceName);
        if (!matches(properties, wanted) || properties.apiVersion < VK_API_VERSION_1_3 ||
            !has_extension(candidate, VK_KHR_PUSH_DESCRIPTOR_EXTENSION_NAME)) {
            continue;
        }
        std::uint32_t count = 0;
        vkGetPhysicalDeviceQueueFamilyProperties(candidate, &count, nullptr);
        std::vector<VkQueueFamilyProperties> families(count);
        vkGetPhysicalDeviceQueueFamilyProperties(candidate, &count, families.data());
        for (std::uint32_t family = 0; family < count; ++family) {
            constexpr VkQueueFlags kNeeded = VK_QUEUE_GRAPHICS_BIT | VK_QUEUE_COMPUTE_BIT;
            if ((families[family].queueFlags & kNeeded) != kNeeded) continue;
            physical_ = candidate;
            queue_family_ = family;
            info_ = describe(candidate);
            vkGetPhysicalDeviceMemoryProperties(physical_, &memory_types_);
            return {};
        }
    }
    if (devices.empty()) {
        return fail("no Vulkan device is there", "Vulkan",
                    "install mesa-vulkan-drivers: its lavapipe needs no GPU");
    }
    return fail(wanted.empty() ? std::string("no device has Vulkan 1.3 with push descriptors")
                               : "no usable device matches '" + wanted + "'",
                "Vulkan", "devices here: " + seen);
}

Result<void> Device::create_device(bool presents) {
    const float priority = 1.0f;
    const VkDeviceQueueCreateInfo queue{.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO,
                                        .queueFamilyIndex = queue_family_,
                                        .queueCount = 1,
                                        .pQueuePriorities = &priority};
    VkPhysicalDeviceVulkan13Features features13{
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES,
        .synchronization2 = VK_TRUE,
        .dynamicRendering = VK_TRUE,
        .maintenance4 = VK_TRUE};
    VkPhysicalDeviceVulkan11Features features11{
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_1_FEATURES,
        .pNext = &features13,
        .shaderDrawParameters = info_.has_multi_draw};
    VkPhysicalDeviceVulkan12Features features12{
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES,
        .pNext = &features11,
        .drawIndirectCount = info_.has_multi_draw,
        .shaderBufferInt64Atomics = info_.has_int64_atomics,
        .scalarBlockLayout = VK_TRUE};
    VkPhysicalDeviceFeatures2 features{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2,
                                       .pNext = &features12};
    // Out-of-range reads of a wrong shader must not take the process down while developing.
    features.features.robustBufferAccess = validating_;
    features.features.geometryShader = info_.has_geometry_shader;
    features.features.shaderInt64 = info_.has_int64_atomics;
    features.features.multiDrawIndirect = info_.has_multi_draw;
    features.features.drawIndirectFirstInstance = info_.has_multi_draw;
    features.features.pipelineStatisticsQuery = info_.has_statistics;
    std::vector<const char*> extensions = {VK_KHR_PUSH_DESCRIPTOR_EXTENSION_NAME};
    if (presents) extensions.push_back(VK_KHR_SWAPCHAIN_EXTENSION_NAME);
    const VkDeviceCreateInfo create{
        .sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO,
        .pNext = &features,
        .queueCreateInfoCount = 1,
        .pQueueCreateInfos = &queue,
        .enabledExtensionCount = static_cast<std::uint32_t>(extensions.size()),
        .ppEnabledExtensionNames = extensions.data()};
    KINO_VK_TRY(vkCreateDevice(physical_, &create, nullptr, &device_), "creating the device");
    volkLoadDevice(device_);
    vkGetDeviceQueue(device_, queue_family_, 0, &queue_);

    VkSamplerCreateInfo sampler{.sType = VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO,
                                .addressModeU = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE,
                                .addressModeV = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE,
                                .addressModeW = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE};
    KINO_VK_TRY(vkCreateSampler(device_, &sampler, nullptr, &nearest_), "creating a sampler");
    sampler.magFilter = sampler.minFilter = VK_FILTER_LINEAR;
    KINO_VK_TRY(vkCreateSampler(device_, &sampler, nullptr, &linear_), "creating a sampler");
    const VkPipelineCacheCreateInfo cache{.sType = VK_STRUCTURE_TYPE_PIPELINE_CACHE_CREATE_INFO};
    KINO_VK_TRY(vkCreatePipelineCache(device_, &cache, nullptr, &pipeline_cache_),
                "creating the pipeline cache");
    const VkCommandPoolCreateInfo pool{.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                       .flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT,
                                       .queueFamilyIndex = queue_family_};
    KINO_VK_TRY(vkCreateCommandPool(device_, &pool, nullptr, &pool_), "creating a command pool");
    const VkCommandBufferAllocateInfo allocate{
        .sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
        .commandPool = pool_,
        .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
        .commandBufferCount = 1};
    KINO_VK_TRY(vkAllocateCommandBuffers(device_, &allocate, &commands_),
                "allocating a command buffer");
    const VkFenceCreateInfo fence{.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
    KINO_VK_TRY(vkCreateFence(device_, &fence, nullptr, &fence_), "creating a fence");
    return {};
}

Device::~Device() {
    if (device_ != VK_NULL_HANDLE) {
        vkDeviceWaitIdle(device_);
        // Every buffer and image counts itself out; a leak is a programmer's error.
        KINO_CHECK_EQ(memory_.current, 0);
        vkDestroyFence(device_, fence_, nullptr);
        vkDestroyCommandPool(device_, pool_, nullptr);
        vkDestroyPipelineCache(device_, pipeline_cache_, nullptr);
        vkDestroySampler(device_, nearest_, nullptr);
        vkDestroySampler(device_, linear_, nullptr);
        vkDestroyDevice(device_, nullptr);
    }
    if (messenger_ != VK_NULL_HANDLE) {
        vkDestroyDebugUtilsMessengerEXT(instance_, messenger_, nullptr);
    }
    if (instance_ != VK_NULL_HANDLE) vkDestroyInstance(instance_, nullptr);
}

Result<VkDeviceMemory> Device::allocate(const VkMemoryRequirements& needs, MemoryUse use,
                                        const std::string& name, bool& host_visible) {
    constexpr VkMemoryPropertyFlags kLocal = VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT;
    constexpr VkMemoryPropertyFlags kMapped =
        VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
    constexpr VkMemoryPropertyFlags kCached = VK_MEMORY_PROPERTY_HOST_CACHED_BIT;
    // Best first. Coherent memory only: then nobody has to think of flushes.
    static constexpr std::array<std::array<VkMemoryPropertyFlags, 3>, 3> kPreferences = {{
        {kLocal, kLocal, 0},                    // device
        {kLocal | kMapped, kMapped, kMapped},   // upload
        {kMapped | kCached, kMapped, kMapped},  // readback
    }};
    for (const VkMemoryPropertyFlags flags : kPreferences[static_cast<std::size_t>(use)]) {
        for (std::uint32_t type = 0; type < memory_types_.memoryTypeCount; ++type) {
            const VkMemoryPropertyFlags has = memory_types_.memoryTypes[type].propertyFlags;
            if ((needs.memoryTypeBits & (1u << type)) == 0 || (has & flags) != flags) continue;
            const VkMemoryAllocateInfo info{.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
                                            .allocationSize = needs.size,
                                            .memoryTypeIndex = type};
            VkDeviceMemory memory = VK_NULL_HANDLE;
            const VkResult result = vkAllocateMemory(device_, &info, nullptr, &memory);
            if (result == VK_ERROR_OUT_OF_DEVICE_MEMORY) continue;  // the next heap may have room
            KINO_VK_TRY(result, fmt::format("allocating {} bytes for {}", needs.size, name));
            ++allocations_;
            memory_.current += static_cast<std::int64_t>(needs.size);
            memory_.peak = std::max(memory_.peak, memory_.current);
            host_visible = (has & VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT) != 0;
            return memory;
        }
    }
    return fail(fmt::format("no memory for {} bytes of {}", needs.size, name), "Vulkan");
}

void Device::release(VkDeviceMemory memory, VkDeviceSize bytes) {
    vkFreeMemory(device_, memory, nullptr);
    memory_.current -= static_cast<std::int64_t>(bytes);
}

Result<TimeNs> Device::submit_and_wait(const std::function<void(VkCommandBuffer)>& record) {
    const VkCommandBufferBeginInfo begin{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
                                         .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT};
    KINO_VK_TRY(vkBeginCommandBuffer(commands_, &begin), "recording");
    record(commands_);
    KINO_VK_TRY(vkEndCommandBuffer(commands_), "recording");
    const VkCommandBufferSubmitInfo buffer{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO,
                                           .commandBuffer = commands_};
    const VkSubmitInfo2 submit{.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO_2,
                               .commandBufferInfoCount = 1,
                               .pCommandBufferInfos = &buffer};
    const TimeNs start = now_ns();
    KINO_VK_TRY(vkQueueSubmit2(queue_, 1, &submit, fence_), "submitting");
    KINO_VK_TRY(vkWaitForFences(device_, 1, &fence_, VK_TRUE, UINT64_MAX), "waiting");
    const TimeNs elapsed = now_ns() - start;
    KINO_VK_TRY(vkResetFences(device_, 1, &fence_), "resetting a fence");
    return elapsed;
}

void Device::wait_idle() const {
    vkDeviceWaitIdle(device_);
}

Result<std::vector<DeviceInfo>> list_devices() {
    if (volkInitialize() != VK_SUCCESS) {
        return fail("no Vulkan loader on this machine", "Vulkan", "install libvulkan1");
    }
    const VkApplicationInfo app{.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO,
                                .apiVersion = VK_API_VERSION_1_3};
    const VkInstanceCreateInfo create{.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO,
                                      .pApplicationInfo = &app};
    VkInstance instance = VK_NULL_HANDLE;
    KINO_VK_TRY(vkCreateInstance(&create, nullptr, &instance), "creating the instance");
    volkLoadInstance(instance);
    auto devices = physical_devices(instance);
    std::vector<DeviceInfo> infos;
    if (devices) {
        for (VkPhysicalDevice physical : *devices) infos.push_back(describe(physical));
    }
    vkDestroyInstance(instance, nullptr);
    if (!devices) return fail(devices.error());
    return infos;
}

}  // namespace kino::gpu
