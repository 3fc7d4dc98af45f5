#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "base/time.h"

namespace kino {

struct HotplugEvent {
    enum class Change : std::uint8_t { added, removed };
    Change change = Change::added;
    std::string subsystem;  ///< "usb" or "video4linux"
    std::string vendor;     ///< four hexadecimal digits, "045e"; empty if not known
    std::string product;    ///< as vendor
    std::string serial;     ///< empty if not known
    std::string node;       ///< "/dev/bus/usb/001/004", "/dev/video0"; empty if there is none
    friend bool operator==(const HotplugEvent&, const HotplugEvent&) = default;
};

/// Says what is plugged in and pulled out from its making on. A hint, no promise: whoever waits
/// for a device looks for it from time to time as well.
class HotplugWatch {
  public:
    virtual ~HotplugWatch() = default;
    HotplugWatch() = default;
    HotplugWatch(const HotplugWatch&) = delete;
    HotplugWatch& operator=(const HotplugWatch&) = delete;

    /// Events since the last call, waiting up to `timeout` for the first; empty if none came or
    /// interrupt() was called. One thread at a time.
    [[nodiscard]] virtual std::vector<HotplugEvent> wait(TimeNs timeout) = 0;
    /// From any thread: ends the wait() under way, or else the next one, at once.
    virtual void interrupt() = 0;
};

/// By libudev: the udev daemon's events where it runs (permissions are then already set), else
/// the kernel's own, else by looking at /sys twice a second. Never null.
[[nodiscard]] std::unique_ptr<HotplugWatch> make_hotplug_watch();

/// Looks at <sys>/bus/usb/devices and <sys>/class/video4linux every `period` and says what has
/// changed.
[[nodiscard]] std::unique_ptr<HotplugWatch> make_polling_watch(std::filesystem::path sys = "/sys",
                                                               TimeNs period = kNsPerSecond / 2);

}  // namespace kino
