#include "sensor/kinect1/kinect1_device.h"

#include <fmt/format.h>

#include <utility>

#include "sensor/kinect1/factory_rig.h"

namespace kino::kinect1 {

Kinect1Device::Kinect1Device(Kinect1Parts parts)
    : address_(std::move(parts.address)),
      camera_(std::move(parts.camera)),
      commands_(*camera_),
      motor_(std::move(parts.motor)),
      no_motor_(std::move(parts.no_motor)),
      controls_(commands_, motor_.get(), no_motor_, "kinect1:" + address_.serial) {
    info_.uri = "kinect1:" + to_text(address_);
    info_.name = fmt::format("Kinect v1, model {}", parts.model);
    info_.serial = address_.serial;
    info_.note = no_motor_;
    describe_streams();
}

void Kinect1Device::describe_streams() {
    for (const CameraMode mode : {address_.depth, address_.color, CameraMode::infrared}) {
        const ModeTraits& t = traits(mode);
        info_.streams.push_back({{0, t.kind}, t.width, t.height, t.nominal_hz, t.format});
    }
    if (motor_) {
        info_.streams.push_back(
            {{0, StreamKind::motion}, 0, 0, MotionPoll::kHz, "accelerometer and tilt"});
    }
}

Result<std::unique_ptr<LiveDevice>> Kinect1Device::create(Kinect1Parts parts) {
    std::unique_ptr<Kinect1Device> device(new Kinect1Device(std::move(parts)));
    auto factory = read_factory_data(device->commands_);
    if (!factory) return tl::unexpected(usb::to_error(factory.error(), device->info_.uri));
    device->factory_ = std::move(*factory);
    return device;
}

Kinect1Device::~Kinect1Device() = default;

Result<RigParameters> Kinect1Device::calibration() const {
    return factory_rig(factory_, address_.color, address_.serial);
}

Result<void> Kinect1Device::start(StreamId id, FrameIntake& intake) {
    if (id.device == 0) {
        switch (id.kind) {
            case StreamKind::depth:
                return start_camera(address_.depth, intake);
            case StreamKind::color:
                return start_camera(address_.color, intake);
            case StreamKind::infrared:
                return start_camera(CameraMode::infrared, intake);
            case StreamKind::motion:
                if (!motor_) return fail("no motion: " + no_motor_, info_.uri);
                if (!motion_) motion_ = std::make_unique<MotionPoll>(*motor_, gate_, intake);
                return {};
            case StreamKind::bodies:
                break;
        }
    }
    return fail(fmt::format("a Kinect v1 has no stream {} {}", id.device, stream_name(id.kind)),
                info_.uri);
}

Result<void> Kinect1Device::start_camera(CameraMode mode, FrameIntake& intake) {
    const StreamKind kind = traits(mode).kind;
    std::unique_ptr<CameraStream>& place = kind == StreamKind::depth ? depth_ : video_;
    if (place) {
        const StreamKind running = traits(place->mode()).kind;
        if (running == kind) return {};
        return fail(fmt::format("{} and {} cannot run at the same time: they share one connection "
                                "of the sensor",
                                stream_name(running), stream_name(kind)),
                    info_.uri, fmt::format("stop {} first", stream_name(running)));
    }
    auto stream = CameraStream::start(mode, *camera_, commands_, clock_, gate_, intake);
    if (!stream) {
        Error error = usb::to_error(stream.error(), info_.uri);
        error.what = fmt::format("{} does not start: {}", stream_name(kind), error.what);
        return tl::unexpected(std::move(error));
    }
    place = std::move(*stream);
    return {};
}

void Kinect1Device::stop(StreamId id) {
    if (id.device != 0) return;
    if (id.kind == StreamKind::motion) motion_.reset();
    if (id.kind == StreamKind::depth) depth_.reset();
    if (video_ && traits(video_->mode()).kind == id.kind) video_.reset();
}

}  // namespace kino::kinect1
