#pragma once

#include <filesystem>
#include <vector>

#include "sensor/v4l2/video_system.h"

namespace kino {

/// Where the kernel and udev keep what they know.
struct VideoNodePlaces {
    std::filesystem::path sys_class = "/sys/class/video4linux";
    std::filesystem::path udev_data = "/run/udev/data";
    std::filesystem::path dev = "/dev";
};

/// The video nodes of this machine by number. Serials of zeros only (Kinect for Windows cameras
/// have such) count as none. What cannot be read is left empty; there is no error.
[[nodiscard]] std::vector<VideoNode> list_video_nodes(const VideoNodePlaces& places = {});

}  // namespace kino
