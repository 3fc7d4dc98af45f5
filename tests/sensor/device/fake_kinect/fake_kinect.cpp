#include "tests/sensor/device/fake_kinect/fake_kinect.h"

#include <fmt/format.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>
#include <utility>

namespace kino::fake {
namespace {

bool wait_for_devices(std::uint16_t product, int count) {
    for (int tries = 0; tries < 500; ++tries) {
        if (devices_on_bus(product) == count) return true;
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    return false;
}

}  // namespace

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
    const std::uint16_t motor_product = kinect->motor_->identity().product;
    const int cameras = devices_on_bus(options.camera.product);
    const int motors = devices_on_bus(motor_product);
    if (options.with_motor) {
        KINO_ASSIGN(kinect->motor_port_, UsbIpPort::plug(*kinect->motor_));
    }
    KINO_ASSIGN(kinect->camera_port_, UsbIpPort::plug(*kinect->camera_, options.cut_after));
    if (!wait_for_devices(options.camera.product, cameras + 1) ||
        (options.with_motor && !wait_for_devices(motor_product, motors + 1))) {
        return fail("the kernel does not show the fake Kinect");
    }
    return kinect;
}

void Kinect::unplug() {
    if (motor_port_) motor_port_->unplug();
    camera_port_->unplug();
}

}  // namespace kino::fake
