#include "tests/sensor/device/scenarios/capture.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <linux/videodev2.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace kino::guest {
namespace {

constexpr int kSecondsForFrame = 10;

int repeat_ioctl(int fd, unsigned long request, void* argument) {
    int status = 0;
    do {
        status = ioctl(fd, request, argument);
    } while (status < 0 && errno == EINTR);
    return status;
}

tl::unexpected<Error> errno_fail(const char* call) {
    return fail(std::strerror(errno), call);
}

v4l2_buffer empty_buffer(std::uint32_t index = 0) {
    v4l2_buffer buffer{};
    buffer.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    buffer.memory = V4L2_MEMORY_MMAP;
    buffer.index = index;
    return buffer;
}

}  // namespace

Result<std::unique_ptr<Capture>> Capture::start(const std::string& node, std::uint32_t fourcc,
                                                int width, int height) {
    std::unique_ptr<Capture> capture(new Capture);
    capture->node_ = node;
    capture->fd_ = open(node.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
    if (capture->fd_ < 0) return errno_fail("open");
    KINO_TRY(capture->start_streaming(fourcc, width, height));
    return capture;
}

Result<void> Capture::start_streaming(std::uint32_t fourcc, int width, int height) {
    v4l2_format format{};
    format.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    format.fmt.pix.width = static_cast<std::uint32_t>(width);
    format.fmt.pix.height = static_cast<std::uint32_t>(height);
    format.fmt.pix.pixelformat = fourcc;
    format.fmt.pix.field = V4L2_FIELD_NONE;
    if (repeat_ioctl(fd_, VIDIOC_S_FMT, &format) < 0) return errno_fail("VIDIOC_S_FMT");
    const v4l2_pix_format& got = format.fmt.pix;
    if (got.pixelformat != fourcc || got.width != static_cast<std::uint32_t>(width) ||
        got.height != static_cast<std::uint32_t>(height)) {
        return fail(
            fmt::format("another format: {:08x} {}x{}", got.pixelformat, got.width, got.height),
            "VIDIOC_S_FMT");
    }
    frame_bytes_ = got.sizeimage;
    row_bytes_ = got.bytesperline;

    v4l2_requestbuffers request{};
    request.count = 4;
    request.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    request.memory = V4L2_MEMORY_MMAP;
    if (repeat_ioctl(fd_, VIDIOC_REQBUFS, &request) < 0) return errno_fail("VIDIOC_REQBUFS");
    for (std::uint32_t i = 0; i < request.count; ++i) {
        v4l2_buffer buffer = empty_buffer(i);
        if (repeat_ioctl(fd_, VIDIOC_QUERYBUF, &buffer) < 0) return errno_fail("VIDIOC_QUERYBUF");
        void* begin = mmap(nullptr, buffer.length, PROT_READ, MAP_SHARED, fd_, buffer.m.offset);
        if (begin == MAP_FAILED) return errno_fail("mmap");
        buffers_.push_back({.begin = begin, .size = buffer.length});
        if (repeat_ioctl(fd_, VIDIOC_QBUF, &buffer) < 0) return errno_fail("VIDIOC_QBUF");
    }
    int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    if (repeat_ioctl(fd_, VIDIOC_STREAMON, &type) < 0) return errno_fail("VIDIOC_STREAMON");
    return {};
}

Capture::~Capture() {
    for (const Buffer& buffer : buffers_) munmap(buffer.begin, buffer.size);
    close(fd_);
}

Result<CapturedFrame> Capture::next() {
    // By rounds, not by the clock: the whole guest may have been held up.
    for (int round = 0; round < kSecondsForFrame * 10; ++round) {
        pollfd ready{.fd = fd_, .events = POLLIN, .revents = 0};
        if (poll(&ready, 1, 100) < 0 && errno != EINTR) return errno_fail("poll");
        if (ready.revents == 0) continue;
        v4l2_buffer buffer = empty_buffer();
        if (repeat_ioctl(fd_, VIDIOC_DQBUF, &buffer) < 0) {
            if (errno == EAGAIN) continue;
            return errno_fail("VIDIOC_DQBUF");
        }
        const auto* begin = static_cast<const std::uint8_t*>(buffers_[buffer.index].begin);
        CapturedFrame frame{.bytes = {begin, begin + buffer.bytesused},
                            .sequence = buffer.sequence,
                            .marked_bad = (buffer.flags & V4L2_BUF_FLAG_ERROR) != 0,
                            .full_size = buffer.bytesused == frame_bytes_};
        if (repeat_ioctl(fd_, VIDIOC_QBUF, &buffer) < 0 && errno != ENODEV) {
            return errno_fail("VIDIOC_QBUF");
        }
        return frame;
    }
    return fail("timeout", node_);
}

std::vector<std::uint32_t> formats_of(const std::string& node) {
    std::vector<std::uint32_t> formats;
    const int fd = open(node.c_str(), O_RDWR | O_CLOEXEC);
    if (fd < 0) return formats;
    v4l2_fmtdesc format{};
    format.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    for (; repeat_ioctl(fd, VIDIOC_ENUM_FMT, &format) == 0; ++format.index) {
        formats.push_back(format.pixelformat);
    }
    close(fd);
    return formats;
}

Result<void> set_control(const std::string& node, const std::string& name, int value) {
    const int fd = open(node.c_str(), O_RDWR | O_CLOEXEC);
    if (fd < 0) return errno_fail("open");
    v4l2_query_ext_ctrl query{};
    query.id = V4L2_CTRL_FLAG_NEXT_CTRL;
    Result<void> result = fail("no such control", name);
    for (; repeat_ioctl(fd, VIDIOC_QUERY_EXT_CTRL, &query) == 0;
         query.id |= V4L2_CTRL_FLAG_NEXT_CTRL) {
        if (name != query.name) continue;
        v4l2_control control{.id = query.id, .value = value};
        if (repeat_ioctl(fd, VIDIOC_S_CTRL, &control) == 0) {
            result = {};
        } else {
            result = errno_fail("VIDIOC_S_CTRL");
        }
        break;
    }
    close(fd);
    return result;
}

}  // namespace kino::guest
