#include "sensor/v4l2/video_device.h"

#include <fmt/format.h>
#include <linux/videodev2.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include "sensor/live/permission_hint.h"

namespace kino {
namespace {

/// So that a stream of signals, or a fake, cannot hold a call for ever.
constexpr int kMostRepeats = 100;

template <class F>
int repeat_interrupted(F&& call) {
    int result = -EINTR;
    for (int i = 0; i < kMostRepeats && result == -EINTR; ++i) result = call();
    return result;
}

const char* request_name(unsigned long request) {
    switch (request) {
        case VIDIOC_QUERYCAP:
            return "VIDIOC_QUERYCAP";
        case VIDIOC_ENUM_FMT:
            return "VIDIOC_ENUM_FMT";
        case VIDIOC_ENUM_FRAMESIZES:
            return "VIDIOC_ENUM_FRAMESIZES";
        case VIDIOC_ENUM_FRAMEINTERVALS:
            return "VIDIOC_ENUM_FRAMEINTERVALS";
        case VIDIOC_G_FMT:
            return "VIDIOC_G_FMT";
        case VIDIOC_S_FMT:
            return "VIDIOC_S_FMT";
        case VIDIOC_G_PARM:
            return "VIDIOC_G_PARM";
        case VIDIOC_S_PARM:
            return "VIDIOC_S_PARM";
        case VIDIOC_REQBUFS:
            return "VIDIOC_REQBUFS";
        case VIDIOC_QUERYBUF:
            return "VIDIOC_QUERYBUF";
        case VIDIOC_QBUF:
            return "VIDIOC_QBUF";
        case VIDIOC_DQBUF:
            return "VIDIOC_DQBUF";
        case VIDIOC_STREAMON:
            return "VIDIOC_STREAMON";
        case VIDIOC_STREAMOFF:
            return "VIDIOC_STREAMOFF";
        case VIDIOC_QUERYCTRL:
            return "VIDIOC_QUERYCTRL";
        case VIDIOC_QUERY_EXT_CTRL:
            return "VIDIOC_QUERY_EXT_CTRL";
        case VIDIOC_QUERYMENU:
            return "VIDIOC_QUERYMENU";
        case VIDIOC_G_CTRL:
            return "VIDIOC_G_CTRL";
        case VIDIOC_S_CTRL:
            return "VIDIOC_S_CTRL";
        case VIDIOC_G_EXT_CTRLS:
            return "VIDIOC_G_EXT_CTRLS";
        case VIDIOC_S_EXT_CTRLS:
            return "VIDIOC_S_EXT_CTRLS";
        default:
            return "ioctl";
    }
}

std::string hint_for(int error, const std::string& path) {
    switch (error) {
        case EACCES:
        case EPERM:
            return fmt::format(
                "{} belongs to group video: `sudo usermod -aG video $USER` and log in again, or {}",
                path, permission_hint());
        case EBUSY:
            return fmt::format("another program uses it; `fuser -v {}` names it", path);
        case ENOSPC:
            return "the USB bus has no bandwidth left: plug it into another controller, or ask for "
                   "a smaller picture";
        case ENOENT:
        case ENODEV:
        case ENXIO:
            return "plug it in; `kinoscope devices` lists what is there";
        default:
            return {};
    }
}

}  // namespace

bool means_gone(int error) {
    return error == ENODEV || error == ENXIO;
}

std::string describe(const CallFailure& failure) {
    const char* const name = strerrorname_np(failure.error);
    const char* const words = strerrordesc_np(failure.error);
    return fmt::format("{} failed: {} ({})", failure.call, words ? words : "unknown error",
                       name ? name : std::to_string(failure.error));
}

Error video_error(const CallFailure& failure, const std::string& path) {
    return {describe(failure), path, hint_for(failure.error, path)};
}

Result<VideoDevice> VideoDevice::open(std::shared_ptr<VideoSystem> system, std::string path) {
    const int descriptor = repeat_interrupted([&] { return system->open(path); });
    if (descriptor < 0) return fail(video_error({-descriptor, "open"}, path));
    return VideoDevice(std::move(system), std::move(path), descriptor);
}

VideoDevice::VideoDevice(std::shared_ptr<VideoSystem> system, std::string path, int descriptor)
    : system_(std::move(system)), path_(std::move(path)), descriptor_(descriptor) {}

VideoDevice::VideoDevice(VideoDevice&& other) noexcept
    : system_(std::move(other.system_)),
      path_(std::move(other.path_)),
      descriptor_(std::exchange(other.descriptor_, -1)) {}

VideoDevice::~VideoDevice() {
    // Linux has let go of the descriptor whatever close says: it is never repeated.
    if (descriptor_ >= 0) system_->close(descriptor_);
}

Called VideoDevice::call_raw(unsigned long request, void* argument) const {
    const int result =
        repeat_interrupted([&] { return system_->ioctl(descriptor_, request, argument); });
    if (result < 0) return tl::unexpected<CallFailure>({-result, request_name(request)});
    return {};
}

MapResult VideoDevice::map(std::size_t length, std::int64_t offset) const {
    MapResult mapped{nullptr, EINTR};
    for (int i = 0; i < kMostRepeats && mapped.error == EINTR; ++i)
        mapped = system_->map(descriptor_, length, offset);
    return mapped;
}

int VideoDevice::make_event() const {
    return repeat_interrupted([&] { return system_->make_event(); });
}

PollResult VideoDevice::poll(int event, TimeNs timeout) const {
    return system_->poll(descriptor_, event, std::max<TimeNs>(0, timeout));
}

tl::unexpected<Error> VideoDevice::fails(const CallFailure& failure) const {
    return fail(video_error(failure, path_));
}

}  // namespace kino
