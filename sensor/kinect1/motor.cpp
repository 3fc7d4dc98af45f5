#include "sensor/kinect1/motor.h"

#include <algorithm>
#include <cmath>

#include "base/check.h"

namespace kino::kinect1 {
namespace {

using usb::Failure;
using usb::Outcome;

constexpr std::uint8_t kLedRequest = 0x06;
constexpr std::uint8_t kTiltRequest = 0x31;
constexpr std::uint8_t kStateRequest = 0x32;
constexpr std::size_t kStateBytes = 10;
constexpr std::chrono::milliseconds kTimeout{250};
constexpr double kGravity = 9.80665;
constexpr double kCountsPerG = 819;
constexpr std::uint8_t kMoving = 4;
constexpr int kNoAngle = -128;
// 5 blinks green as well.
constexpr std::array<std::uint16_t, 6> kLedValues = {0, 1, 2, 3, 4, 6};

}  // namespace

std::optional<MotorState> parse_motor_state(std::span<const std::uint8_t> bytes) {
    if (bytes.size() != kStateBytes) return std::nullopt;
    const auto axis = [bytes](std::size_t at) {
        const auto counts = static_cast<std::int16_t>(bytes[at] << 8 | bytes[at + 1]);
        return counts / kCountsPerG * kGravity;
    };
    MotorState state;
    state.acceleration_m_s2 = {-axis(2), -axis(4), axis(6)};
    const auto angle = static_cast<std::int8_t>(bytes[8]);
    if (angle != kNoAngle && bytes[9] != kMoving) state.tilt_deg = angle / 2.0;
    return state;
}

Outcome<MotorState> Motor::state() {
    std::array<std::uint8_t, kStateBytes> bytes{};
    const auto got = handle_->control_in({.request = kStateRequest}, bytes, kTimeout);
    if (!got) {
        return usb::fault(got.error().kind,
                          "reading the accelerometer failed: " + got.error().what);
    }
    const auto state = parse_motor_state(std::span(bytes).first(std::min(*got, bytes.size())));
    if (!state) return usb::fault(Failure::io, "the accelerometer's answer came back too short");
    return *state;
}

Outcome<void> Motor::tilt(double degrees) {
    KINO_CHECK(std::abs(degrees) <= kMaxTiltDeg);
    const auto value = static_cast<std::int16_t>(std::lround(2 * degrees));
    auto sent = handle_->control_out(
        {.request = kTiltRequest, .value = static_cast<std::uint16_t>(value)}, {}, kTimeout);
    if (!sent) return usb::fault(sent.error().kind, "tilting failed: " + sent.error().what);
    return {};
}

Outcome<void> Motor::led(int state) {
    const std::uint16_t value = kLedValues.at(static_cast<std::size_t>(state));
    auto sent = handle_->control_out({.request = kLedRequest, .value = value}, {}, kTimeout);
    if (!sent)
        return usb::fault(sent.error().kind, "switching the LED failed: " + sent.error().what);
    return {};
}

}  // namespace kino::kinect1
