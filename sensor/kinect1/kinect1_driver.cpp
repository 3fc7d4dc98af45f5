#include "sensor/kinect1/kinect1_driver.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "sensor/kinect1/kinect1_device.h"
#include "sensor/kinect1/kinect1_units.h"
#include "sensor/live/live_source.h"

namespace kino {
namespace {

using namespace kinect1;

constexpr std::uint16_t kMicrosoft = 0x045e;
constexpr const char* kNoPower =
    "only its motor answers: the sensor's own power supply is not plugged in";

std::string no_motor_reason(const Unit& unit) {
    if (unit.is_1414()) return "tilt, light and accelerometer do not answer";
    return fmt::format(
        "tilt, light and accelerometer of model {} work only with a firmware for its audio part "
        "that cannot be shipped",
        unit.model());
}

usb::Outcome<std::vector<Unit>> find_units(usb::Bus& bus) {
    auto devices = bus.list(kMicrosoft);
    if (!devices) return tl::unexpected(std::move(devices).error());
    return group_units(*devices);
}

std::vector<DeviceEntry> list_units(usb::Bus& bus) {
    std::vector<DeviceEntry> out;
    const auto units = find_units(bus);
    if (!units) return out;
    for (const Unit& unit : *units) {
        DeviceEntry entry{
            "kinect1:" + unit.serial, "Kinect v1, model " + unit.model(), unit.serial, {}};
        if (!unit.camera) {
            entry.problem = kNoPower;
        } else if (const auto handle = bus.open(*unit.camera); !handle) {
            const Error error = usb::to_error(handle.error(), {});
            entry.problem = error.to_string();
        }
        out.push_back(std::move(entry));
    }
    return out;
}

Result<Unit> choose(const std::vector<Unit>& units, const std::string& serial,
                    const std::string& uri) {
    const auto match = std::ranges::find_if(units, [&](const Unit& unit) {
        return unit.camera && (serial.empty() || unit.serial == serial);
    });
    if (match != units.end()) return *match;
    std::string present;
    for (const Unit& unit : units) {
        if (!unit.camera) return fail("this Kinect cannot be used", uri, kNoPower);
        present += (present.empty() ? "" : ", ") +
                   (unit.serial.empty() ? "one without a serial" : unit.serial);
    }
    if (present.empty()) {
        return fail("no Kinect v1 is plugged in", uri, "check its cable and its own power supply");
    }
    return fail("that Kinect v1 is not plugged in", uri, "present: " + present);
}

usb::Outcome<std::unique_ptr<usb::Handle>> open_claimed(usb::Bus& bus, const usb::DeviceId& id,
                                                        bool alternate) {
    auto handle = bus.open(id);
    if (!handle) return handle;
    if (auto claimed = (*handle)->claim(0); !claimed) return tl::unexpected(claimed.error());
    if (alternate) {
        if (auto set = (*handle)->set_alternate(0, 1); !set) return tl::unexpected(set.error());
    }
    return handle;
}

Result<std::unique_ptr<LiveDevice>> open_unit(usb::Bus& bus, const std::string& text) {
    const std::string uri = "kinect1:" + text;
    KINO_ASSIGN(Address address, parse_address(text));
    const auto units = find_units(bus);
    if (!units) return tl::unexpected(usb::to_error(units.error(), uri));
    KINO_ASSIGN(const Unit unit, choose(*units, address.serial, uri));
    address.serial = unit.serial;

    // The camera of a Kinect for Windows sends in its second setting only.
    const bool for_windows = unit.model() == "for Windows";
    auto camera = open_claimed(bus, *unit.camera, for_windows);
    if (!camera) return tl::unexpected(usb::to_error(camera.error(), uri));
    Kinect1Parts parts;
    parts.camera = std::move(*camera);
    parts.no_motor = no_motor_reason(unit);
    if (unit.is_1414() && unit.motor) {
        // Pictures are worth having without a motor.
        auto motor = open_claimed(bus, *unit.motor, false);
        if (motor) {
            parts.motor = std::make_unique<Motor>(std::move(*motor));
            parts.no_motor.clear();
        } else {
            parts.no_motor += ": " + usb::to_error(motor.error(), {}).to_string();
        }
    }
    parts.model = unit.model();
    parts.address = address;
    return Kinect1Device::create(std::move(parts));
}

}  // namespace

DeviceDriver kinect1_driver(std::shared_ptr<usb::Bus> bus) {
    if (!bus) bus = usb::libusb_bus();
    DeviceDriver driver;
    driver.scheme = "kinect1";
    driver.name = "Kinect v1 by libusb";
    driver.uri_pattern = "kinect1:[serial][?color=bayer|bayer-high|yuv&depth=11|10]";
    driver.list = [bus] { return list_units(*bus); };
    driver.open = [bus](const std::string& address) { return open_unit(*bus, address); };
    return driver;
}

SourceOpener kinect1_opener() {
    return live_opener(kinect1_driver());
}

}  // namespace kino
