#pragma once

#include <memory>
#include <optional>

#include "base/error.h"
#include "tests/sensor/device/fake_kinect/camera.h"
#include "tests/sensor/device/fake_kinect/feed.h"
#include "tests/sensor/device/fake_kinect/motor.h"
#include "tests/sensor/device/fake_kinect/usbip_port.h"

namespace kino::fake {

struct KinectOptions {
    CameraOptions camera;
    bool with_motor = true;
    /// Bytes of the camera's replies after which it leaves the bus; 0: it stays.
    std::uint64_t cut_after = 0;
};

/// A whole Kinect v1, model 1414, on the guest's virtual USB bus, as its makers' protocol notes
/// describe it. It shares no line with the code under test.
class Kinect {
  public:
    /// Plugged in and seen by the kernel.
    [[nodiscard]] static Result<std::unique_ptr<Kinect>> plug(std::shared_ptr<const Feed> feed,
                                                              KinectOptions options = {});
    void unplug();
    [[nodiscard]] bool gone() const { return camera_port_->gone(); }
    [[nodiscard]] const Feed& feed() const { return *feed_; }
    [[nodiscard]] Camera& camera() { return *camera_; }
    [[nodiscard]] Motor& motor() { return *motor_; }

  private:
    Kinect() = default;
    std::shared_ptr<const Feed> feed_;
    std::unique_ptr<Camera> camera_;
    std::unique_ptr<Motor> motor_;
    std::unique_ptr<UsbIpPort> motor_port_;
    std::unique_ptr<UsbIpPort> camera_port_;
};

/// How many USB devices of that product the kernel shows right now.
[[nodiscard]] int devices_on_bus(std::uint16_t product);

}  // namespace kino::fake
