#include "sensor/kinect1/kinect1_units.h"

#include <algorithm>
#include <array>

namespace kino::kinect1 {
namespace {

constexpr std::uint16_t kMotor = 0x02b0;
constexpr std::uint16_t kCamera = 0x02ae;
constexpr std::uint16_t kCameraForWindows = 0x02bf;
constexpr std::array<std::uint16_t, 4> kAudio = {0x02ad, 0x02bb, 0x02be, 0x02c3};
constexpr std::uint16_t kRelease1414 = 0x010b;

bool is_camera(const usb::DeviceId& id) {
    return id.product == kCamera || id.product == kCameraForWindows;
}

bool says_nothing(const std::string& serial) {
    return serial.find_first_not_of('0') == std::string::npos;
}

}  // namespace

bool Unit::is_1414() const {
    return camera && camera->product == kCamera && camera->release == kRelease1414;
}

std::string Unit::model() const {
    if (camera && camera->product == kCameraForWindows) return "for Windows";
    return is_1414() || !camera ? "1414" : "1473";
}

std::vector<Unit> group_units(const std::vector<usb::DeviceId>& devices) {
    std::vector<Unit> units;
    for (const usb::DeviceId& id : devices) {
        if (!is_camera(id)) continue;
        Unit unit;
        unit.camera = id;
        if (!says_nothing(id.serial)) unit.serial = id.serial;
        units.push_back(std::move(unit));
    }
    // Without a hub between, as on a virtual bus, parts pair in the order of their ports.
    for (const usb::DeviceId& id : devices) {
        if (id.product != kMotor && std::ranges::find(kAudio, id.product) == kAudio.end()) continue;
        const bool is_motor = id.product == kMotor;
        const auto home = std::ranges::find_if(units, [&](const Unit& unit) {
            return unit.camera && unit.camera->parent == id.parent &&
                   !(is_motor ? unit.motor : unit.audio);
        });
        if (home != units.end()) {
            (is_motor ? home->motor : home->audio) = id;
            if (!is_motor && home->serial.empty() && !says_nothing(id.serial)) {
                home->serial = id.serial;
            }
        } else if (is_motor) {
            Unit unit;
            unit.motor = id;
            units.push_back(std::move(unit));
        }
    }
    return units;
}

}  // namespace kino::kinect1
