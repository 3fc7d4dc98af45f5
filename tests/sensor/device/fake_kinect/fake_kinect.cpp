#include "tests/sensor/device/fake_kinect/fake_kinect.h"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <utility>

namespace kino::fake {
int devices_on_bus(std::uint16_t product) {
    const std::string wanted = fmt::format("{:04x}", product);
    int count = 0;
    std::error_code ignored;
    for (const auto& entry : std::filesystem::directory_iterator("/sys/bus/usb/devices", ignored)) {
        std::ifstream file(entry.path() / "idProduct");
        std::string found;
        // The interface's folder says that the device has been configured, too.
        const auto name = entry.path().filename().string();
        if (file >> found && found == wanted &&
            std::filesystem::exists(entry.path() / (name + ":1.0"), ignored)) {
            ++count;
        }
    }
    return count;
}

Result<std::unique_ptr<Kinect>> Kinect::plug(std::shared_ptr<const Feed> feed,
                                             KinectOptions options) {
    std::unique_ptr<Kinect> kinect(new Kinect);
    kinect->feed_ = std::move(feed);
    kinect->camera_ = std::make_unique<Camera>(kinect->feed_, options.camera);
    kinect->motor_ = std::make_unique<Motor>();
    if (options.with_motor) {
        KINO_ASSIGN(kinect->motor_port_, UsbIpPort::plug(*kinect->motor_));
    }
    KINO_ASSIGN(kinect->camera_port_, UsbIpPort::plug(*kinect->camera_, options.cut_after));
    return kinect;
}

void Kinect::unplug() {
    if (motor_port_) motor_port_->unplug();
    camera_port_->unplug();
}

}  // namespace kino::fake
