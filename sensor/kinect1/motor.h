#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include "sensor/kinect1/usb.h"

namespace kino::kinect1 {

struct MotorState {
    /// Specific force in depth camera axes, m/s^2: level and at rest (0, -9.8, 0).
    std::array<double, 3> acceleration_m_s2{};
    std::optional<double> tilt_deg;  ///< upwards, against gravity; none while the motor runs
};
/// The ten bytes of request 0x32 (libfreenect tilt.c): [2..7] three big-endian counts of 1/819 g,
/// [8] twice the angle, -128 while moving, [9] 0 stopped, 1 at its limit, 4 moving. The chip's
/// axes are taken to be left, up and forwards, as the Kinect SDK describes them.
[[nodiscard]] std::optional<MotorState> parse_motor_state(std::span<const std::uint8_t> bytes);

/// Base of a Kinect model 1414: tilt, LED and accelerometer. Thread-safe; every call waits at most
/// a quarter of a second.
class Motor {
  public:
    static constexpr double kMaxTiltDeg = 31;
    /// Menu of LED states, in the order of their numbers here.
    static constexpr std::array<const char*, 6> kLedNames = {
        "off", "green", "red", "yellow", "blinking green", "blinking red and yellow"};

    explicit Motor(std::unique_ptr<usb::Handle> handle) : handle_(std::move(handle)) {}

    [[nodiscard]] usb::Outcome<MotorState> state();
    /// Against gravity, upwards, within kMaxTiltDeg; the motor moves in half degrees at best.
    [[nodiscard]] usb::Outcome<void> tilt(double degrees);
    [[nodiscard]] usb::Outcome<void> led(int state);

  private:
    std::unique_ptr<usb::Handle> handle_;
};

}  // namespace kino::kinect1
