#include "sensor/kinect1/camera_stream.h"

#include <utility>

#include "sensor/kinect1/frame_maker.h"

namespace kino::kinect1 {

CameraStream::CameraStream(CameraMode mode, CameraCommands& commands, FrameClock& clock,
                           LossGate& gate, FrameIntake& intake)
    : mode_(mode),
      commands_(commands),
      clock_(clock),
      gate_(gate),
      intake_(intake),
      assembler_(packet_layout(mode), [this](const AssembledFrame& frame) { deliver(frame); }) {}

usb::Outcome<std::unique_ptr<CameraStream>> CameraStream::start(CameraMode mode,
                                                                usb::Handle& camera,
                                                                CameraCommands& commands,
                                                                FrameClock& clock, LossGate& gate,
                                                                FrameIntake& intake) {
    std::unique_ptr<CameraStream> stream(new CameraStream(mode, commands, clock, gate, intake));
    const usb::IsoParameters parameters{.endpoint = traits(mode).endpoint,
                                        .packet_bytes = traits(mode).packet_bytes};
    auto transfers = camera.stream(parameters, *stream);
    if (!transfers) return tl::unexpected(std::move(transfers).error());
    stream->transfers_ = std::move(*transfers);
    if (auto on = switch_on(commands, mode); !on) return tl::unexpected(std::move(on).error());
    return stream;
}

CameraStream::~CameraStream() {
    if (!transfers_) return;
    if (!gate_.lost()) switch_off(commands_, mode_);
    transfers_.reset();
}

void CameraStream::packets(std::span<const usb::Packet> batch, TimeNs arrival_host) {
    for (const usb::Packet& packet : batch) {
        // What the controller calls broken leaves a gap in the sequence, which says all.
        if (packet.ok) assembler_.feed(packet.bytes, arrival_host);
    }
}

void CameraStream::ended(const usb::Fault& why) {
    gate_.lose(intake_, why.what);
}

void CameraStream::deliver(const AssembledFrame& frame) {
    const ModeTraits& mode = traits(mode_);
    const int endpoint = mode.kind == StreamKind::depth ? 0 : 1;
    const auto moment = clock_.at(endpoint, frame.ticks, frame.arrival_host);
    next_sequence_ += frame.lost_before;
    const FrameHeader header{moment.device_time, moment.host_time, next_sequence_++,
                             frame.lost_before};
    gate_.put(intake_, {0, mode.kind}, make_frame(mode_, frame, header));
}

}  // namespace kino::kinect1
