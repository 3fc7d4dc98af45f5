#include "sensor/v4l2/v4l2_device.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "sensor/rig_json.h"

namespace kino {
namespace {

constexpr double kGuessedViewDeg = 60;  ///< across; webcams have 55 to 80

CameraModel pinhole(int width, int height) {
    const double half = kGuessedViewDeg / 2 * std::numbers::pi / 180;
    const double focal_px = width / 2.0 / std::tan(half);
    return {.width = width,
            .height = height,
            .fx = focal_px,
            .fy = focal_px,
            .cx = (width - 1) / 2.0,
            .cy = (height - 1) / 2.0};
}

/// A Kinect's 640x480 colour picture is every second pixel of the middle 960 rows of 1280x1024.
CameraModel full_kinect_color(const CameraModel& half) {
    CameraModel full = half;
    full.width = 1280;
    full.height = 1024;
    full.fx = 2 * half.fx;
    full.fy = 2 * half.fy;
    full.cx = 2 * half.cx + 0.5;
    full.cy = 2 * half.cy + 0.5 + 32;
    return full;
}

/// Empty where the calibration fits the pictures.
std::string misfit(const RigParameters& rig, const BufferLayout& layout) {
    const CameraModel* camera = &rig.depth;
    if (layout.kind == StreamKind::color) camera = rig.color ? &*rig.color : nullptr;
    if (camera == nullptr) return "it has no colour camera";
    if (camera->width == layout.width && camera->height == layout.height) return {};
    return fmt::format("it is for {}x{}, the pictures are {}x{}", camera->width, camera->height,
                       layout.width, layout.height);
}

}  // namespace

RigParameters guessed_rig(const VideoCapabilities& capabilities, const BufferLayout& layout) {
    if (capabilities.is_kinect()) {
        RigParameters rig = default_kinect1_rig();
        if (layout.kind == StreamKind::color && layout.width == 1280)
            rig.color = full_kinect_color(*rig.color);
        rig.note = "Kinect v1 defaults, not this unit's own calibration";
        return rig;
    }
    RigParameters rig;
    rig.depth = pinhole(layout.width, layout.height);
    if (layout.kind == StreamKind::color) rig.color = rig.depth;
    rig.note = fmt::format("calibration is a guess: a lens of {} degrees across", kGuessedViewDeg);
    return rig;
}

Result<std::unique_ptr<V4l2Device>> V4l2Device::open(std::shared_ptr<VideoSystem> system,
                                                     const V4l2Address& address,
                                                     const VideoNode& node,
                                                     const CaptureLimits& limits) {
    KINO_ASSIGN(auto device, VideoDevice::open(std::move(system), node.path));
    KINO_ASSIGN(auto capabilities, query_capabilities(device));
    if (!capabilities.captures)
        return fail(fmt::format("{} is no camera that streams", capabilities.card), node.path);
    std::unique_ptr<V4l2Device> out(
        new V4l2Device(std::move(device), std::move(capabilities), address, node));
    KINO_TRY(out->settle(limits));
    return out;
}

V4l2Device::V4l2Device(VideoDevice device, VideoCapabilities capabilities, const V4l2Address& asked,
                       const VideoNode& node)
    : device_(std::move(device)),
      capabilities_(std::move(capabilities)),
      asked_(asked),
      lasting_(lasting_address(asked, node, device_.system().nodes())),
      controls_(device_) {
    info_.serial = node.serial;
}

Result<void> V4l2Device::settle(const CaptureLimits& limits) {
    KINO_ASSIGN(mode_, negotiate(device_, capabilities_, asked_));
    if (mode_.layout.kind == StreamKind::depth && mode_.layout.unit == DepthUnit::linear) {
        if (const auto unit = controls_.metres_per_unit()) mode_.layout.metres_per_unit = *unit;
    }
    const StreamId id{0, mode_.layout.kind};
    loop_.emplace(device_, capabilities_.multi_planar, mode_, id, limits);
    info_.uri = "v4l2:" + lasting_.to_string();
    info_.name = capabilities_.card;
    info_.streams = {{id, mode_.layout.width, mode_.layout.height, mode_.hz,
                      std::string(mode_.layout.format->name)}};
    KINO_ASSIGN(const RigParameters rig, calibration());
    info_.note = rig.note;
    return {};
}

Result<RigParameters> V4l2Device::calibration() const {
    if (asked_.calibration.empty()) {
        RigParameters rig = guessed_rig(capabilities_, mode_.layout);
        rig.serial = info_.serial;
        return rig;
    }
    KINO_ASSIGN(RigParameters rig, read_rig_file(asked_.calibration));
    if (const std::string why = misfit(rig, mode_.layout); !why.empty())
        return fail("the calibration does not fit: " + why, asked_.calibration);
    if (rig.serial.empty()) rig.serial = info_.serial;
    return rig;
}

Result<void> V4l2Device::start(StreamId id, FrameIntake& intake) {
    if (id != info_.streams.front().id)
        return fail(fmt::format("no stream {} {}", id.device, stream_name(id.kind)),
                    device_.path());
    if (running_) return fail("the stream runs already", device_.path());
    // Whoever else opened the node while nothing was streaming may have set another format.
    KINO_TRY(negotiate_again(device_, capabilities_, asked_, mode_));
    KINO_TRY(loop_->start(intake));
    running_ = true;
    return {};
}

void V4l2Device::stop(StreamId id) {
    if (id != info_.streams.front().id) return;
    loop_->stop();
    running_ = false;
}

}  // namespace kino
