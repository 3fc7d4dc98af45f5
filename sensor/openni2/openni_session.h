#pragma once

#include <array>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "sensor/live/device.h"
#include "sensor/live/device_clock.h"
#include "sensor/openni2/openni_library.h"

namespace kino {

/// How a device is to be opened: what may follow its name as "?registration=on&sync=off".
struct OpenniOptions {
    bool registration = false;  ///< the device maps depth onto the colour picture
    bool sync = true;           ///< depth and colour are exposed and delivered together
};

/// One sensor of an open device.
struct OpenniStream {
    StreamKind kind = StreamKind::depth;
    openni::Stream* handle = nullptr;
    openni::VideoMode mode{};
    bool mirrored = false;      ///< although it was told not to
    double horizontal_fov = 0;  ///< radians; 0 if not stated
    double vertical_fov = 0;
    FrameIntake* intake = nullptr;  ///< null: not running
    std::int64_t last_index = -1;
};

/// An open device and the thread that reads it. Shared, so that a call into the library that never
/// comes back (an unplugged device's close is known for that) can be left alone with it.
class OpenniSession : public std::enable_shared_from_this<OpenniSession> {
  public:
    OpenniSession(OpenniLibrary& library, std::string uri, OpenniOptions options);

    /// Opens the device, makes its streams and sets them up: mirroring and cropping off, the mode
    /// nearest to 640x480 at 30 Hz, registration as asked for.
    Result<void> open();
    /// Ends the reading thread and closes. At most a few seconds.
    void close();

    Result<void> start(StreamKind kind, FrameIntake& intake);
    void stop(StreamKind kind);

    [[nodiscard]] const std::vector<OpenniStream>& streams() const { return streams_; }
    [[nodiscard]] const OpenniStream* find(StreamKind kind) const;
    [[nodiscard]] const openni::DeviceInfo& device() const { return device_info_; }
    [[nodiscard]] const std::string& serial() const { return serial_; }
    [[nodiscard]] const OpenniOptions& options() const { return options_; }
    [[nodiscard]] bool synced() const { return synced_; }
    [[nodiscard]] OpenniLibrary& library() const { return library_; }
    [[nodiscard]] bool gone() const;

  private:
    Result<void> open_now();
    Result<void> add_stream(int sensor, StreamKind kind);
    Result<void> start_now(OpenniStream& stream);
    void halt_reading(std::unique_lock<std::mutex>& lock);
    void go_on_reading();
    void close_now();
    void read_loop();
    void read(OpenniStream& stream);
    void device_gone(const std::string& why);
    [[nodiscard]] std::string describe(const std::string& what) const;

    OpenniLibrary& library_;
    const std::string uri_;
    const OpenniOptions options_;
    openni::Device* device_ = nullptr;
    openni::DeviceInfo device_info_{};
    std::string serial_;
    std::vector<OpenniStream> streams_;
    std::int64_t watch_ = 0;

    /// Guards which streams run; `reading_` says that the reading thread waits inside the library
    /// with a list of them.
    std::mutex mutex_;
    std::condition_variable changed_;
    bool reading_ = false;
    int visitors_ = 0;  ///< threads that want the reading one to stay out of the library
    bool quit_ = false;
    bool synced_ = false;
    bool reader_ended_ = true;
    DeviceClock clock_{1e6, 64};

    /// Guards the hand-over of frames against the news that the device has gone. Taken last, and
    /// by the library's own threads.
    mutable std::mutex hand_over_;
    FrameIntake* any_intake_ = nullptr;
    bool gone_ = false;
};

}  // namespace kino
