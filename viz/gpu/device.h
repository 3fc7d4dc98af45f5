#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/time.h"
#include "viz/gpu/vulkan.h"

namespace kino::gpu {

struct DeviceOptions {
    /// Part of a device's name, or "discrete", "integrated", "cpu"; empty: best of that order.
    std::string device;
    bool validation = false;
    /// Instance extensions a window system asks for.
    std::vector<std::string> instance_extensions;
    bool presents = false;  ///< also enables the swapchain extension
};

struct DeviceInfo {
    std::string name;
    std::string driver;  ///< "Mesa 22.3.6 (LLVM 15.0.6)"
    bool is_cpu = false;
    bool has_int64_atomics = false;
    bool has_geometry_shader = false;
    /// Many draws by one indirect call, told apart by firstInstance and gl_DrawID, their count
    /// read from a buffer.
    bool has_multi_draw = false;
    bool has_statistics = false;          ///< pipeline statistics queries
    VkDeviceSize storage_alignment = 16;  ///< of storage-buffer offsets, bytes
    VkDeviceSize max_texels = 65536;      ///< of a buffer read as texels
};

/// What memory must be able to do, in order of preference (device.cpp has the lists).
enum class MemoryUse : std::uint8_t {
    device,   ///< targets and scratch: device-local
    upload,   ///< written by the host every frame, mapped for good
    readback  ///< read by the host, mapped for good, cached if possible
};

struct MemoryBytes {
    std::int64_t current = 0;
    std::int64_t peak = 0;
};

/// One Vulkan 1.3 device with one queue. Owns the instance; outlives everything made from it.
/// Used by one thread at a time, except the validation counter.
class Device {
  public:
    /// Fails with a clear error where no Vulkan driver or no fitting device is there.
    [[nodiscard]] static Result<std::unique_ptr<Device>> create(const DeviceOptions& options);
    ~Device();
    Device(const Device&) = delete;
    Device& operator=(const Device&) = delete;

    [[nodiscard]] const DeviceInfo& info() const { return info_; }
    [[nodiscard]] VkInstance instance() const { return instance_; }
    [[nodiscard]] VkPhysicalDevice physical() const { return physical_; }
    [[nodiscard]] VkDevice handle() const { return device_; }
    [[nodiscard]] VkQueue queue() const { return queue_; }
    [[nodiscard]] std::uint32_t queue_family() const { return queue_family_; }
    [[nodiscard]] VkSampler nearest_sampler() const { return nearest_; }
    [[nodiscard]] VkSampler linear_sampler() const { return linear_; }
    [[nodiscard]] VkPipelineCache pipeline_cache() const { return pipeline_cache_; }

    /// Warnings and errors of the validation layer since creation; 0 where it is off.
    [[nodiscard]] int validation_messages() const { return validation_messages_.load(); }
    [[nodiscard]] bool validating() const { return validating_; }

    /// Live bytes of buffers and images made from this device.
    [[nodiscard]] MemoryBytes memory() const { return memory_; }
    /// How often memory was allocated since creation.
    [[nodiscard]] std::int64_t allocations() const { return allocations_; }

    /// Used by resources; a failed allocation is an error, not the end.
    [[nodiscard]] Result<VkDeviceMemory> allocate(const VkMemoryRequirements& needs, MemoryUse use,
                                                  const std::string& name, bool& host_visible);
    void release(VkDeviceMemory memory, VkDeviceSize bytes);

    /// Records with `record`, submits and waits. Returns the host time from submit to fence.
    [[nodiscard]] Result<TimeNs> submit_and_wait(
        const std::function<void(VkCommandBuffer)>& record);

    void wait_idle() const;

    /// Bumped by the debug messenger.
    void count_validation_message() { validation_messages_.fetch_add(1); }

  private:
    Device() = default;
    Result<void> create_instance(const DeviceOptions& options);
    Result<void> choose_physical(const std::string& wanted);
    Result<void> create_device(bool presents);

    DeviceInfo info_;
    VkInstance instance_ = VK_NULL_HANDLE;
    VkDebugUtilsMessengerEXT messenger_ = VK_NULL_HANDLE;
    VkPhysicalDevice physical_ = VK_NULL_HANDLE;
    VkDevice device_ = VK_NULL_HANDLE;
    VkQueue queue_ = VK_NULL_HANDLE;
    std::uint32_t queue_family_ = 0;
    VkSampler nearest_ = VK_NULL_HANDLE;
    VkSampler linear_ = VK_NULL_HANDLE;
    VkPipelineCache pipeline_cache_ = VK_NULL_HANDLE;
    VkCommandPool pool_ = VK_NULL_HANDLE;
    VkCommandBuffer commands_ = VK_NULL_HANDLE;
    VkFence fence_ = VK_NULL_HANDLE;
    VkPhysicalDeviceMemoryProperties memory_types_{};
    MemoryBytes memory_;
    std::int64_t allocations_ = 0;
    std::atomic<int> validation_messages_ = 0;
    bool validating_ = false;
};

/// Names and kinds of all Vulkan devices on this machine, best first.
[[nodiscard]] Result<std::vector<DeviceInfo>> list_devices();

}  // namespace kino::gpu
