#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "tests/sensor/device/fake_kinect/packet_stream.h"

namespace kino::fake {

using Clock = std::chrono::steady_clock;

/// The eight bytes that begin a control transfer (USB 2.0, section 9.3).
struct Setup {
    std::uint8_t type = 0;
    std::uint8_t request = 0;
    std::uint16_t value = 0;
    std::uint16_t index = 0;
    std::uint16_t length = 0;
    [[nodiscard]] bool in() const { return (type & 0x80) != 0; }
};

/// What a device says to a control transfer: bytes, or a negative errno (-EPIPE: a stall).
struct Answer {
    int status = 0;
    std::vector<std::uint8_t> bytes;
};
[[nodiscard]] Answer stalled();

/// Who a device says it is.
struct Identity {
    std::uint16_t vendor = 0x045e;
    std::uint16_t product = 0;
    std::uint16_t release = 0;  ///< bcdDevice
    int speed = 3;              ///< of Linux's enum usb_device_speed: 2 full, 3 high
    std::string maker, name, serial;
    /// Isochronous IN endpoints of the only interface.
    std::vector<std::uint8_t> iso_endpoints;
};

/// One device on the bus. Its functions are called by the thread of its UsbIpPort.
class UsbFunction {
  public:
    virtual ~UsbFunction() = default;
    [[nodiscard]] virtual const Identity& identity() const = 0;
    /// A vendor's control request; `out` is what the host sent with it.
    virtual Answer vendor_request(const Setup& setup, std::span<const std::uint8_t> out) = 0;
    /// The next packet of an isochronous endpoint, or none as of `now`.
    virtual std::optional<WirePacket> next_packet(int endpoint, Clock::time_point now) = 0;
    /// When next_packet of the endpoint may have something; the far future if only a request can
    /// change that.
    [[nodiscard]] virtual Clock::time_point wake_at(int endpoint) const = 0;
};

/// The answer to a standard request, from the identity alone.
[[nodiscard]] Answer standard_request(const Identity& identity, const Setup& setup);

}  // namespace kino::fake
