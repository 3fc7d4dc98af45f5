#include <libudev.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <string>

#include "sensor/live/hotplug.h"
#include "sensor/live/wake_descriptor.h"

namespace kino {
namespace {

struct Unref {
    void operator()(udev* p) const { udev_unref(p); }
    void operator()(udev_monitor* p) const { udev_monitor_unref(p); }
    void operator()(udev_device* p) const { udev_device_unref(p); }
};
template <class T>
using Handle = std::unique_ptr<T, Unref>;

std::string text(const char* s) {
    return s ? s : "";
}

std::string four_digits(const std::string& hex) {
    return hex.empty() || hex.size() >= 4 ? hex : std::string(4 - hex.size(), '0') + hex;
}

/// "45e/2ae/10b", which the kernel sends even with a device that has already gone.
void split_product(const std::string& product, HotplugEvent& event) {
    const std::size_t first = product.find('/');
    if (first == std::string::npos) return;
    const std::size_t second = product.find('/', first + 1);
    event.vendor = four_digits(product.substr(0, first));
    event.product = four_digits(product.substr(first + 1, second - first - 1));
}

HotplugEvent describe(udev_device* device, bool added) {
    HotplugEvent event;
    event.change = added ? HotplugEvent::Change::added : HotplugEvent::Change::removed;
    event.subsystem = text(udev_device_get_subsystem(device));
    event.node = text(udev_device_get_devnode(device));
    split_product(text(udev_device_get_property_value(device, "PRODUCT")), event);
    event.serial = text(udev_device_get_property_value(device, "ID_SERIAL_SHORT"));
    udev_device* usb = event.subsystem == "usb" ? device
                                                : udev_device_get_parent_with_subsystem_devtype(
                                                      device, "usb", "usb_device");
    if (!usb) return event;
    const auto fill = [&](std::string& field, const char* attribute) {
        if (field.empty()) field = text(udev_device_get_sysattr_value(usb, attribute));
    };
    fill(event.vendor, "idVendor");
    fill(event.product, "idProduct");
    fill(event.serial, "serial");
    return event;
}

class UdevWatch final : public HotplugWatch {
  public:
    /// False: no udev, or no netlink socket for this process.
    bool open() {
        udev_.reset(udev_new());
        if (!udev_) return false;
        // Where no daemon runs its group stays silent for ever.
        const bool daemon = access("/run/udev/control", F_OK) == 0;
        monitor_.reset(udev_monitor_new_from_netlink(udev_.get(), daemon ? "udev" : "kernel"));
        udev_monitor* const m = monitor_.get();
        return m && udev_monitor_filter_add_match_subsystem_devtype(m, "usb", "usb_device") >= 0 &&
               udev_monitor_filter_add_match_subsystem_devtype(m, "video4linux", nullptr) >= 0 &&
               udev_monitor_enable_receiving(m) >= 0;
    }

    std::vector<HotplugEvent> wait(TimeNs timeout) override {
        const TimeNs until = now_ns() + std::max<TimeNs>(0, timeout);
        while (true) {
            const bool interrupted =
                wake_.wait(until - now_ns(), udev_monitor_get_fd(monitor_.get()));
            auto events = received();
            // What the filter swallows wakes as well.
            if (interrupted || !events.empty() || now_ns() >= until) return events;
        }
    }
    void interrupt() override { wake_.signal(); }

  private:
    std::vector<HotplugEvent> received() {
        std::vector<HotplugEvent> events;
        while (const Handle<udev_device> device{udev_monitor_receive_device(monitor_.get())}) {
            const std::string action = text(udev_device_get_action(device.get()));
            const bool added = action == "add";
            if (added || action == "remove") events.push_back(describe(device.get(), added));
        }
        return events;
    }

    Handle<udev> udev_;
    Handle<udev_monitor> monitor_;
    WakeDescriptor wake_;
};

}  // namespace

std::unique_ptr<HotplugWatch> make_hotplug_watch() {
    auto watch = std::make_unique<UdevWatch>();
    if (watch->open()) return watch;
    return make_polling_watch();
}

}  // namespace kino
