#pragma once

#include <memory>

#include "sensor/kinect1/camera_mode.h"
#include "sensor/kinect1/frame_clock.h"
#include "sensor/kinect1/loss_gate.h"
#include "sensor/kinect1/packet_assembler.h"

namespace kino::kinect1 {

/// One running endpoint of the camera: packets in, frames out to an intake. Made running; the
/// destructor stops it, after which nothing more is put.
class CameraStream : private usb::PacketSink {
  public:
    /// `gate`, `clock`, `commands`, `camera` and `intake` outlive it.
    [[nodiscard]] static usb::Outcome<std::unique_ptr<CameraStream>> start(
        CameraMode mode, usb::Handle& camera, CameraCommands& commands, FrameClock& clock,
        LossGate& gate, FrameIntake& intake);
    ~CameraStream() override;
    CameraStream(const CameraStream&) = delete;
    CameraStream& operator=(const CameraStream&) = delete;

    [[nodiscard]] CameraMode mode() const { return mode_; }

  private:
    CameraStream(CameraMode mode, CameraCommands& commands, FrameClock& clock, LossGate& gate,
                 FrameIntake& intake);
    void packets(std::span<const usb::Packet> batch, TimeNs arrival_host) override;
    void ended(const usb::Fault& why) override;
    void deliver(const AssembledFrame& frame);

    CameraMode mode_;
    CameraCommands& commands_;
    FrameClock& clock_;
    LossGate& gate_;
    FrameIntake& intake_;
    PacketAssembler assembler_;
    std::int64_t next_sequence_ = 0;
    std::unique_ptr<usb::IsoStream> transfers_;
};

}  // namespace kino::kinect1
