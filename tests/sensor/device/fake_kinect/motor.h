#pragma once

#include <array>
#include <mutex>
#include <string>

#include "tests/sensor/device/fake_kinect/usb_function.h"

namespace kino::fake {

/// Motor, lamp and accelerometer of model 1414. The motor arrives at once.
class Motor : public UsbFunction {
  public:
    explicit Motor(std::string serial = {});

    const Identity& identity() const override { return identity_; }
    Answer vendor_request(const Setup& setup, std::span<const std::uint8_t> out) override;
    std::optional<WirePacket> next_packet(int, Clock::time_point) override { return std::nullopt; }
    Clock::time_point wake_at(int) const override { return Clock::time_point::max(); }

    // From any thread.
    [[nodiscard]] int lamp() const;         ///< as last set; -1: never
    [[nodiscard]] double tilt_deg() const;  ///< as last set, 0 at first
    /// What the accelerometer reads, in its 819 counts per g.
    static constexpr std::array<int, 3> kAcceleration = {-20, 815, 40};

  private:
    Identity identity_;
    mutable std::mutex mutex_;
    int lamp_ = -1;
    int half_degrees_ = 0;
};

}  // namespace kino::fake
