#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "base/error.h"
#include "sensor/source.h"

namespace kino {

/// Where a device's own threads lay down what arrives. Thread-safe; never waits for a reader.
class FrameIntake {
  public:
    virtual ~FrameIntake() = default;
    /// A frame that is complete, or has its damaged rows marked.
    virtual void put(StreamId id, StreamFrame frame) = 0;
    /// The device has gone. Said at most once for a LiveDevice; nothing is put after it.
    virtual void lost(std::string why) = 0;
};

/// One opened device, as long as it stays plugged in. LiveSource opens the next one when the same
/// unit comes back. Everything but the destructor belongs to one thread; frames come from others.
class LiveDevice {
  public:
    virtual ~LiveDevice() = default;  ///< stops all streams; returns even if the device is gone
    LiveDevice() = default;
    LiveDevice(const LiveDevice&) = delete;
    LiveDevice& operator=(const LiveDevice&) = delete;

    [[nodiscard]] virtual const SourceInfo& info() const = 0;
    [[nodiscard]] virtual Result<RigParameters> calibration() const = 0;
    /// Frames of the stream arrive at `intake`, which outlives the stream, from now on.
    virtual Result<void> start(StreamId id, FrameIntake& intake) = 0;
    /// On return nothing more of the stream is put. Without effect if it does not run.
    virtual void stop(StreamId id) = 0;
    [[nodiscard]] virtual Controls* controls() { return nullptr; }
    /// What DeviceDriver::open must be given to find this unit again, wherever it is plugged in.
    [[nodiscard]] virtual std::string address() const = 0;
};

/// What could be opened, or why not.
struct DeviceEntry {
    std::string uri;      ///< "kinect1:A00364A07684047A"
    std::string name;     ///< for a person
    std::string serial;   ///< empty if the device has none
    std::string problem;  ///< empty, or why it cannot be opened and what to do about it
};

/// One kind of device.
struct DeviceDriver {
    std::string scheme;       ///< "kinect1"
    std::string name;         ///< "Kinect v1 by libusb"
    std::string uri_pattern;  ///< for help texts: "kinect1:[serial]"
    std::function<std::vector<DeviceEntry>()> list;
    /// `address` is what follows "scheme:"; empty for the first device there is. The error of a
    /// device that is there but closed to this user names the udev rule.
    std::function<Result<std::unique_ptr<LiveDevice>>(const std::string& address)> open;
};

}  // namespace kino
