#pragma once

#include <memory>
#include <string>

#include "sensor/kinect1/camera_stream.h"
#include "sensor/kinect1/factory_data.h"
#include "sensor/kinect1/kinect1_address.h"
#include "sensor/kinect1/kinect1_controls.h"
#include "sensor/kinect1/motion_poll.h"
#include "sensor/live/device.h"

namespace kino::kinect1 {

/// What a Kinect1Device is made of: its USB devices, opened and claimed.
struct Kinect1Parts {
    std::unique_ptr<usb::Handle> camera;
    std::unique_ptr<Motor> motor;  ///< may be null
    std::string no_motor;          ///< why, for a person
    std::string model;             ///< "1414"
    Address address;               ///< with the unit's own serial, if it has one
};

/// One Kinect v1 as long as it stays plugged in: depth, colour, infrared and, with a motor, motion.
/// Colour and infrared come through one endpoint: the second one's start fails and says so.
class Kinect1Device : public LiveDevice {
  public:
    /// Reads the factory calibration; what is missing of it is said in the rig's note. Fails only
    /// if the sensor has gone.
    [[nodiscard]] static Result<std::unique_ptr<LiveDevice>> create(Kinect1Parts parts);
    ~Kinect1Device() override;

    [[nodiscard]] const SourceInfo& info() const override { return info_; }
    [[nodiscard]] Result<RigParameters> calibration() const override;
    Result<void> start(StreamId id, FrameIntake& intake) override;
    void stop(StreamId id) override;
    [[nodiscard]] Controls* controls() override { return &controls_; }
    [[nodiscard]] std::string address() const override { return to_text(address_); }

  private:
    explicit Kinect1Device(Kinect1Parts parts);
    [[nodiscard]] Result<void> start_camera(CameraMode mode, FrameIntake& intake);
    void describe_streams();

    Address address_;
    SourceInfo info_;
    std::unique_ptr<usb::Handle> camera_;
    CameraCommands commands_;
    std::unique_ptr<Motor> motor_;
    std::string no_motor_;
    Kinect1Controls controls_;
    FactoryData factory_;
    FrameClock clock_;
    LossGate gate_;
    // Last, so that they stop first.
    std::unique_ptr<CameraStream> depth_;
    std::unique_ptr<CameraStream> video_;
    std::unique_ptr<MotionPoll> motion_;
};

}  // namespace kino::kinect1
