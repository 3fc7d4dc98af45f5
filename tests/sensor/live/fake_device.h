#pragma once

#include <atomic>
#include <condition_variable>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "sensor/live/device.h"
#include "sensor/live/hotplug.h"

namespace kino::test {

/// A bus with devices that do what the test says: depth, colour and infrared, the controls "tilt"
/// and "led". Plugging and pulling out reach the watches as well. Thread-safe.
class FakeBus {
  public:
    FakeBus();
    ~FakeBus();

    [[nodiscard]] DeviceDriver driver();
    [[nodiscard]] std::unique_ptr<HotplugWatch> watch();
    /// Watches made from now on stay silent: only looking finds a device.
    void make_watches_deaf() { deaf_ = true; }

    void plug(const std::string& serial);
    /// Returns when the device has said that it is lost, if it is open and a stream runs.
    void unplug(const std::string& serial);

    /// Gives the frame to the device's intake; false if the unit is not open or the stream does
    /// not run.
    bool put(const std::string& serial, StreamKind kind, StreamFrame frame);

    /// Called within start() and Controls::set(), before they do anything.
    void on_start(std::function<void(StreamId)> hook);
    void on_set(std::function<void()> hook);
    /// start() of that kind fails from now on.
    void refuse(StreamKind kind, bool refused);

    [[nodiscard]] int open_devices() const { return open_devices_; }
    [[nodiscard]] int openings() const { return openings_; }
    [[nodiscard]] int watches() const { return watches_; }
    [[nodiscard]] bool running(const std::string& serial, StreamKind kind) const;
    /// Value of a control of the unit as opened now or last; each opening starts at 0.
    [[nodiscard]] double setting(const std::string& serial, const std::string& id) const;

    /// "tilt 5": every successful set() since forget_settings(), of all units.
    [[nodiscard]] std::vector<std::string> settings_made() const;
    void forget_settings();

  private:
    struct Core;
    class Device;
    class Watch;
    [[nodiscard]] Result<std::unique_ptr<LiveDevice>> open(const std::string& address);
    [[nodiscard]] std::shared_ptr<Core> core(const std::string& serial) const;
    void tell(HotplugEvent::Change change, const std::string& serial);

    mutable std::mutex mutex_;
    std::map<std::string, bool> plugged_;
    std::map<std::string, std::shared_ptr<Core>> cores_;  ///< of the last opening
    std::vector<Watch*> listening_;
    std::function<void(StreamId)> on_start_;
    std::function<void()> on_set_;
    std::vector<StreamKind> refused_;
    mutable std::mutex log_mutex_;
    std::vector<std::string> settings_made_;
    std::atomic<bool> deaf_{false};
    std::atomic<int> open_devices_{0};
    std::atomic<int> openings_{0};
    std::atomic<int> watches_{0};
};

/// Frames of 2 x 2 pixels; device time is host time less `device_zero`.
[[nodiscard]] StreamFrame fake_frame(StreamKind kind, std::int64_t sequence, TimeNs host_time,
                                     TimeNs device_zero = 0);
[[nodiscard]] FrameHeader header_of(const StreamFrame& frame);

}  // namespace kino::test
