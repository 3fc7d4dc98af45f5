#pragma once

#include <atomic>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "base/error.h"
#include "tests/sensor/device/fake_kinect/usb_function.h"

namespace kino::fake {

/// Puts a UsbFunction on the kernel's virtual bus: the server side of USB/IP (Linux,
/// Documentation/usb/usbip_protocol.rst) on a socket pair whose other end vhci_hcd holds.
class UsbIpPort {
  public:
    /// Plugs it in and waits until the kernel has configured it. Fails without vhci_hcd or the
    /// right to use it. `cut_after`: unplugged by itself once so many bytes have gone to the host,
    /// be it in the middle of a reply; 0: never. The function outlives the port.
    [[nodiscard]] static Result<std::unique_ptr<UsbIpPort>> plug(UsbFunction& function,
                                                                 std::uint64_t cut_after = 0);
    ~UsbIpPort();  ///< unplugs
    UsbIpPort(const UsbIpPort&) = delete;
    UsbIpPort& operator=(const UsbIpPort&) = delete;

    /// The device has left the bus, by itself or by unplug().
    [[nodiscard]] bool gone() const { return gone_; }
    void unplug();  ///< on return the kernel shows it no more; idempotent

  private:
    struct Request {
        std::uint32_t number = 0;
        std::uint32_t endpoint = 0;
        std::uint32_t length = 0;
        std::vector<std::uint32_t> packet_lengths;
    };

    UsbIpPort(UsbFunction& function, int socket, int port, std::uint64_t cut_after);
    void serve();
    bool read_request();
    bool submit(const std::vector<std::uint32_t>& header, const Setup& setup);
    bool unlink(const std::vector<std::uint32_t>& header);
    /// Completes waiting transfers with what the function has as of now.
    bool pump();
    bool complete(const Request& request, std::vector<WirePacket> packets);
    bool read_all(void* to, std::size_t size);
    bool write_all(const std::vector<std::uint8_t>& bytes);
    [[nodiscard]] int milliseconds_to_wait() const;
    bool wait_until_configured();
    void wait_until_forgotten() const;

    UsbFunction& function_;
    int socket_ = -1;
    int wake_[2] = {-1, -1};
    int port_ = -1;
    std::string device_;  ///< the kernel's name for it, "1-2"
    std::uint64_t cut_after_ = 0;
    std::uint64_t written_ = 0;
    std::map<std::uint32_t, std::deque<Request>> waiting_;  ///< by endpoint number
    std::atomic<bool> gone_ = false;
    std::thread thread_;
};

}  // namespace kino::fake
