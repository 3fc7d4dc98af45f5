#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "base/time.h"

namespace kino {

/// A video node as sysfs and udev know it, without opening it.
struct VideoNode {
    std::string path;         ///< "/dev/video0"
    std::string name;         ///< what the driver calls it
    std::string serial;       ///< of the USB device; empty if it has none
    std::string udev_serial;  ///< udev's ID_SERIAL (maker, model and serial), empty without udev
    std::string bus_path;     ///< the port: udev's ID_PATH, else the sysfs name ("1-2:1.0")
    /// Which node of its unit: USB interface and index, "1.0.0"; just the index off USB.
    std::string part;
};

/// What poll found. Exactly one of: an errno, the stop, events, nothing in time.
struct PollResult {
    int error = 0;  ///< a positive errno
    short events = 0;
    bool stopped = false;
};

struct MapResult {
    void* data = nullptr;
    int error = 0;  ///< a positive errno
};

/// The few system calls that V4L2 needs, so that a fake can stand in for the kernel. Calls return
/// a value >= 0, or the negative errno. Thread-safe.
class VideoSystem {
  public:
    virtual ~VideoSystem() = default;
    VideoSystem() = default;
    VideoSystem(const VideoSystem&) = delete;
    VideoSystem& operator=(const VideoSystem&) = delete;

    /// The video nodes there are now, by number.
    [[nodiscard]] virtual std::vector<VideoNode> nodes() = 0;
    /// The node a path leads to (/dev/v4l/by-id/... are links); the path itself if to none.
    [[nodiscard]] virtual std::string resolve(const std::string& path) = 0;
    virtual int open(const std::string& path) = 0;  ///< for reading and writing, non-blocking
    virtual int close(int descriptor) = 0;
    virtual int ioctl(int descriptor, unsigned long request, void* argument) = 0;
    virtual MapResult map(int descriptor, std::size_t length, std::int64_t offset) = 0;
    virtual int unmap(void* data, std::size_t length) = 0;
    /// Something to end a poll with; close() it.
    virtual int make_event() = 0;
    virtual void set_event(int event) = 0;
    /// Waits until the node is readable or in error, the event is set, or `timeout` has passed.
    /// A negative descriptor waits for the event only.
    virtual PollResult poll(int descriptor, int event, TimeNs timeout) = 0;
    /// The host's monotonic clock (now_ns()).
    [[nodiscard]] virtual TimeNs now() = 0;
};

/// The kernel this process runs on.
[[nodiscard]] std::shared_ptr<VideoSystem> real_video_system();

}  // namespace kino
