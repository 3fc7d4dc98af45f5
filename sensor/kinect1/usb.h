#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <tl/expected.hpp>
#include <vector>

#include "base/error.h"
#include "base/time.h"

namespace kino::usb {

/// What a USB call can come back with. `io` stands for everything without a name of its own.
enum class Failure : std::uint8_t {
    no_device,      ///< unplugged
    no_permission,  ///< the device node is closed to this user
    busy,           ///< another program, or a kernel driver that would not let go
    not_found,      ///< no such interface or endpoint, or nothing at that address any more
    timeout,
    stall,        ///< the device refused the request
    overflow,     ///< the device sent more than was asked for
    interrupted,  ///< by a signal; worth another try
    no_memory,    ///< often the kernel's limit for transfers under way (usbfs_memory_mb)
    unsupported,
    io
};

struct Fault {
    Failure kind = Failure::io;
    std::string what;  ///< what was tried and how it failed, one sentence without a full stop
};
template <class T>
using Outcome = tl::expected<T, Fault>;

/// "stalled", "timed out": for the end of a sentence.
[[nodiscard]] const char* describe(Failure failure);
[[nodiscard]] inline tl::unexpected<Fault> fault(Failure kind, std::string what) {
    return tl::unexpected<Fault>(Fault{kind, std::move(what)});
}
/// With a hint where the user can do something: closed devices name the udev rule.
[[nodiscard]] Error to_error(const Fault& fault, const std::string& where);

struct DeviceId {
    std::uint16_t vendor = 0;
    std::uint16_t product = 0;
    std::uint16_t release = 0;  ///< bcdDevice
    std::string port;           ///< where it is plugged in: "1-4.2"
    std::string parent;         ///< the hub it is plugged into: "1-4"
    int address = 0;            ///< on its bus; a new one every time it is plugged in
    std::string serial;         ///< empty if it has none or it cannot be read
    int interfaces = 0;         ///< of the active configuration
};

/// A vendor request: all of them here go to the device with index 0 unless stated.
struct Request {
    std::uint8_t request = 0;
    std::uint16_t value = 0;
    std::uint16_t index = 0;
};

/// One isochronous packet as it arrived; empty where the device had nothing to send.
struct Packet {
    std::span<const std::uint8_t> bytes;
    bool ok = true;  ///< false: the host controller reports an error in it
};

/// Called from a thread of the bus; must not wait and must not stop the stream it belongs to.
class PacketSink {
  public:
    virtual ~PacketSink() = default;
    /// In the order of arrival; the bytes are gone afterwards.
    virtual void packets(std::span<const Packet> batch, TimeNs arrival_host) = 0;
    /// The stream has ended by itself and nothing follows; said at most once.
    virtual void ended(const Fault& why) = 0;
};

/// A running isochronous stream. The destructor stops it; afterwards the sink is not called. It
/// returns within a second whatever became of the device.
class IsoStream {
  public:
    virtual ~IsoStream() = default;
};

struct IsoParameters {
    std::uint8_t endpoint = 0;
    int packet_bytes = 0;
    /// 16 packets of 125 us are 2 ms of waiting at most; 32 of those in flight bridge 64 ms in
    /// which the program does not get the processor.
    int packets_per_transfer = 16;
    int transfers = 32;
};

/// An opened device. Control transfers may come from any thread; the rest belongs to one. Streams
/// must be gone before it is.
class Handle {
  public:
    virtual ~Handle() = default;  ///< gives interfaces, and the kernel its driver, back
    /// Takes a kernel driver off the interface first.
    [[nodiscard]] virtual Outcome<void> claim(int interface) = 0;
    [[nodiscard]] virtual Outcome<void> set_alternate(int interface, int setting) = 0;
    /// Vendor request 0x40 with a finite timeout; all bytes went out or it is a fault.
    [[nodiscard]] virtual Outcome<void> control_out(const Request& request,
                                                    std::span<const std::uint8_t> bytes,
                                                    std::chrono::milliseconds timeout) = 0;
    /// Vendor request 0xC0 with a finite timeout; gives the number of bytes that came, maybe 0.
    [[nodiscard]] virtual Outcome<std::size_t> control_in(const Request& request,
                                                          std::span<std::uint8_t> bytes,
                                                          std::chrono::milliseconds timeout) = 0;
    /// `sink` outlives the stream.
    [[nodiscard]] virtual Outcome<std::unique_ptr<IsoStream>> stream(
        const IsoParameters& parameters, PacketSink& sink) = 0;
};

/// All of USB. Thread-safe.
class Bus {
  public:
    virtual ~Bus() = default;
    /// The vendor's devices, by port. Serials are read where the system gives them without opening
    /// the device, else by opening it.
    [[nodiscard]] virtual Outcome<std::vector<DeviceId>> list(std::uint16_t vendor) = 0;
    [[nodiscard]] virtual Outcome<std::unique_ptr<Handle>> open(const DeviceId& device) = 0;
};

/// The one over libusb, with its own event thread while a device is open. One for the program.
[[nodiscard]] std::shared_ptr<Bus> libusb_bus();

}  // namespace kino::usb
