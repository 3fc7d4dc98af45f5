#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "fake_camera.h"
#include "sensor/kinect1/usb.h"

namespace kino::test {

/// A Kinect v1 in memory behind usb::Bus: what it sends is sent when the test says so, on the
/// test's thread; every call can be made to fail; it can be unplugged and plugged in. Thread-safe.
class FakeKinect : public usb::Bus, public std::enable_shared_from_this<FakeKinect> {
  public:
    struct Unit {
        std::uint16_t camera_product = 0x02ae;
        std::uint16_t release = 0x010b;
        std::string camera_serial = "A00364A07684047A";
        bool has_camera = true;
        bool has_motor = true;
        std::optional<std::string> audio_serial = "A00364A07684047A";
    };
    [[nodiscard]] static std::shared_ptr<FakeKinect> make(Unit unit);
    [[nodiscard]] static std::shared_ptr<FakeKinect> make() { return make(Unit{}); }

    usb::Outcome<std::vector<usb::DeviceId>> list(std::uint16_t vendor) override;
    usb::Outcome<std::unique_ptr<usb::Handle>> open(const usb::DeviceId& device) override;

    FakeCamera camera;
    std::atomic<int> motor_angle_halves{0};
    std::atomic<int> motor_status{0};
    std::atomic<int> led{-1};
    std::array<std::int16_t, 3> counts{0, 819, 0};

    /// What a call fails with from now on; none: it works.
    struct Failures {
        std::optional<usb::Failure> list, open_camera, open_motor, claim, alternate, stream, motor;
    };
    void set_failures(const Failures& failures);

    /// Packets in batches of 16 to the endpoint's stream; false if none is running. Unplugs where
    /// unplug_after() says.
    bool send(std::uint8_t endpoint, const std::vector<Bytes>& packets);
    /// One complete frame. Frames of an endpoint are a period apart in device time.
    bool send_frame(kinect1::CameraMode mode, std::span<const std::uint8_t> frame);
    [[nodiscard]] bool running(std::uint8_t endpoint) const;
    [[nodiscard]] int alternate_setting() const { return alternate_; }

    void unplug();
    /// After that many more bytes of packets.
    void unplug_after(std::int64_t bytes);
    void plug_in();
    /// The stream of the endpoint ends like this.
    void end_stream(std::uint8_t endpoint, usb::Failure why);
    [[nodiscard]] int open_handles() const { return open_handles_; }

  private:
    class CameraHandle;
    class MotorHandle;
    class Stream;
    struct Endpoint {
        usb::PacketSink* sink = nullptr;
        bool ended = false;
        std::uint8_t sequence = 250;
        std::uint32_t ticks = 4'290'000'000u;  // wraps soon
    };
    explicit FakeKinect(Unit unit) : unit_(std::move(unit)) {}
    [[nodiscard]] Endpoint& endpoint(std::uint8_t address) { return endpoints_[address & 1u]; }
    void end_all(usb::Failure why);

    Unit unit_;
    std::atomic<bool> plugged_{true};
    std::atomic<int> address_{5};
    std::atomic<int> open_handles_{0};
    std::atomic<int> alternate_{0};
    mutable std::mutex failures_mutex_;
    Failures failures_;
    [[nodiscard]] Failures failures() const;

    mutable std::recursive_mutex mutex_;  // held while a sink is called
    std::array<Endpoint, 2> endpoints_;
    std::int64_t bytes_left_ = -1;
};

}  // namespace kino::test
