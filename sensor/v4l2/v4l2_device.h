#pragma once

#include <memory>
#include <optional>
#include <string>

#include "sensor/live/device.h"
#include "sensor/v4l2/capture_loop.h"
#include "sensor/v4l2/negotiation.h"
#include "sensor/v4l2/v4l2_address.h"
#include "sensor/v4l2/v4l2_controls.h"
#include "sensor/v4l2/video_device.h"

namespace kino {

/// One video node as a device with one stream: a node streams one picture at a time. Two that
/// belong together (depth and colour) are opened as "v4l2:A+v4l2:B".
class V4l2Device final : public LiveDevice {
  public:
    /// Opens the node and agrees on a format; what was asked for in `address` wins over what the
    /// format usually is. Fails where the node cannot be opened, is no camera, or does not agree.
    [[nodiscard]] static Result<std::unique_ptr<V4l2Device>> open(
        std::shared_ptr<VideoSystem> system, const V4l2Address& address, const VideoNode& node,
        const CaptureLimits& limits = {});

    [[nodiscard]] const SourceInfo& info() const override { return info_; }
    /// Of a Kinect its defaults; of others the file in the address, else a pinhole of 60 degrees
    /// across whose note says that it is a guess. A colour or infrared camera stands in for the
    /// depth camera too, until another source brings one.
    [[nodiscard]] Result<RigParameters> calibration() const override;
    Result<void> start(StreamId id, FrameIntake& intake) override;
    void stop(StreamId id) override;
    [[nodiscard]] Controls* controls() override { return &controls_; }
    [[nodiscard]] std::string address() const override { return lasting_.to_string(); }

    [[nodiscard]] const VideoMode& mode() const { return mode_; }
    [[nodiscard]] CaptureCounts counts() const { return loop_->counts(); }

  private:
    V4l2Device(VideoDevice device, VideoCapabilities capabilities, const V4l2Address& asked,
               const VideoNode& node);
    Result<void> settle(const CaptureLimits& limits);

    VideoDevice device_;
    const VideoCapabilities capabilities_;
    const V4l2Address asked_;
    const V4l2Address lasting_;
    VideoMode mode_;
    SourceInfo info_;
    V4l2Controls controls_;
    std::optional<CaptureLoop> loop_;  ///< ends before the device closes
    bool running_ = false;
};

/// The calibration that V4l2Device::calibration() describes, before any file.
[[nodiscard]] RigParameters guessed_rig(const VideoCapabilities& capabilities,
                                        const BufferLayout& layout);

}  // namespace kino
