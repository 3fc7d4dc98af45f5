#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <map>
#include <string>
#include <system_error>
#include <utility>

#include "sensor/live/hotplug.h"
#include "sensor/live/wake_descriptor.h"

namespace kino {
namespace {

namespace fs = std::filesystem;

/// The first line of a small file; empty if it cannot be read.
std::string line_of(const fs::path& file) {
    std::ifstream in(file);
    std::string line;
    std::getline(in, line);
    return line;
}

/// By name and device number: the same port may hold another device at the next look.
using Present = std::map<std::string, HotplugEvent>;

void describe_usb(const fs::path& folder, HotplugEvent& event) {
    event.vendor = line_of(folder / "idVendor");
    event.product = line_of(folder / "idProduct");
    event.serial = line_of(folder / "serial");
}

Present look(const fs::path& sys) {
    Present present;
    std::error_code error;
    for (fs::directory_iterator it(sys / "bus/usb/devices", error), end; !error && it != end;
         it.increment(error)) {
        HotplugEvent event{.subsystem = "usb"};
        describe_usb(it->path(), event);
        // Interfaces stand in the same folder and have no vendor.
        if (event.vendor.empty()) continue;
        const int bus = std::atoi(line_of(it->path() / "busnum").c_str());
        const int device = std::atoi(line_of(it->path() / "devnum").c_str());
        event.node = fmt::format("/dev/bus/usb/{:03}/{:03}", bus, device);
        present.emplace(it->path().string() + "#" + event.node, std::move(event));
    }
    for (fs::directory_iterator it(sys / "class/video4linux", error), end; !error && it != end;
         it.increment(error)) {
        HotplugEvent event{.subsystem = "video4linux"};
        const std::string name = it->path().filename().string();
        event.node = "/dev/" + name;
        describe_usb(it->path() / "device/..", event);
        present.emplace(it->path().string() + "#" + line_of(it->path() / "dev"), std::move(event));
    }
    return present;
}

class PollingWatch final : public HotplugWatch {
  public:
    PollingWatch(fs::path sys, TimeNs period)
        : sys_(std::move(sys)), period_(period), present_(look(sys_)) {}

    std::vector<HotplugEvent> wait(TimeNs timeout) override {
        const TimeNs until = now_ns() + std::max<TimeNs>(0, timeout);
        while (true) {
            auto events = changes();
            const TimeNs left = until - now_ns();
            if (!events.empty() || left <= 0) return events;
            if (wake_.wait(std::min(period_, left))) return {};
        }
    }
    void interrupt() override { wake_.signal(); }

  private:
    std::vector<HotplugEvent> changes() {
        std::vector<HotplugEvent> events;
        Present now = look(sys_);
        for (const auto& [key, event] : present_) {
            if (now.contains(key)) continue;
            events.push_back(event);
            events.back().change = HotplugEvent::Change::removed;
        }
        for (const auto& [key, event] : now) {
            if (!present_.contains(key)) events.push_back(event);
        }
        present_ = std::move(now);
        return events;
    }

    const fs::path sys_;
    const TimeNs period_;
    WakeDescriptor wake_;
    Present present_;
};

}  // namespace

std::unique_ptr<HotplugWatch> make_polling_watch(fs::path sys, TimeNs period) {
    return std::make_unique<PollingWatch>(std::move(sys), period);
}

}  // namespace kino
