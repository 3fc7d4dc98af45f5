#pragma once

#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "tests/sensor/device/fake_kinect/feed.h"
#include "tests/sensor/device/fake_kinect/usb_function.h"

namespace kino::fake {

/// What the camera has in its flash.
struct FactoryTables {
    float emitter_cm = 7.5F;
    float color_camera_cm = 2.4F;
    float reference_cm = 120.0F;
    float pixel_mm = 0.1042F;
    std::uint16_t const_shift = 200;
    std::vector<std::int32_t> registration;  ///< 29 numbers, in the order of the reply
};
[[nodiscard]] FactoryTables plausible_tables();

struct CameraOptions {
    std::string serial = "A00364A07684047A";
    std::uint16_t product = 0x02ae;
    std::uint16_t release = 0x010b;
    FactoryTables tables = plausible_tables();
    Faults faults;
    /// Frames per second at most; a slow host gets fewer, none is ever skipped.
    double depth_hz = 30;
    double video_hz = 30;
    /// Frames to send of each stream, then silence; -1: no end.
    int frames = -1;
    /// Device clock (60 MHz) when it is switched on.
    std::uint32_t first_tick = 0xffffffffu - 60'000'000u;
    /// Each how many replies the first question is answered by nothing, as the device does while it
    /// is busy; 0: never.
    int busy_every = 3;
};

enum class VideoMode : std::uint8_t { off, bayer, bayer_large, uyvy, infrared, infrared_large };

/// The camera: registers, command replies and both streams.
class Camera : public UsbFunction {
  public:
    Camera(std::shared_ptr<const Feed> feed, CameraOptions options);

    const Identity& identity() const override { return identity_; }
    Answer vendor_request(const Setup& setup, std::span<const std::uint8_t> out) override;
    std::optional<WirePacket> next_packet(int endpoint, Clock::time_point now) override;
    Clock::time_point wake_at(int endpoint) const override;

    // From any thread.
    /// What was sent on the endpoint, whole or not, oldest first; the last may be under way.
    [[nodiscard]] std::vector<SentFrame> sent(int endpoint) const;
    [[nodiscard]] std::map<std::uint16_t, std::uint16_t> registers() const;
    /// Commands that were malformed: a host that follows the protocol causes none.
    [[nodiscard]] int bad_commands() const;

  private:
    struct Stream {
        PacketStream packets;
        double hz = 30;
        bool on = false;
        int next_frame = 0;
        int stall_at = -1;
        int stall_ms = 0;
        Clock::time_point next_start{};
    };

    [[nodiscard]] Stream& stream_of(int endpoint);
    [[nodiscard]] const Stream& stream_of(int endpoint) const;
    [[nodiscard]] std::vector<std::uint8_t> frame_bytes(int endpoint, int number) const;
    [[nodiscard]] VideoMode video_mode() const;
    std::vector<std::uint8_t> obey(std::uint16_t command, std::span<const std::uint8_t> data);
    void write_register(std::uint16_t address, std::uint16_t value);
    void switch_stream(Stream& stream, bool on);

    std::shared_ptr<const Feed> feed_;
    CameraOptions options_;
    Identity identity_;
    Clock::time_point switched_on_;
    mutable std::mutex mutex_;  // of everything below, against the questions of other threads
    std::map<std::uint16_t, std::uint16_t> registers_;
    std::map<std::uint16_t, std::uint16_t> cmos_;
    std::deque<std::vector<std::uint8_t>> replies_;
    int replies_made_ = 0;
    int bad_commands_ = 0;
    Stream depth_;
    Stream video_;
};

}  // namespace kino::fake
