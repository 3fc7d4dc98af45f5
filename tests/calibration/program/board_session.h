#pragma once

#include <sys/wait.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <memory>
#include <string>

#include "calibration/disparity.h"
#include "sensor/session/recorder.h"
#include "tests/calibration/boards/drawn_board.h"
#include "tests/support/temp_dir.h"

namespace kino::test {

struct Ran {
    int exit_code = -1;
    std::string out;
    std::string err;
};

/// Runs kinoscope-calibrate without a display unless `before` (a wrapper, variables) gives one.
inline Ran run_calibrate(const std::string& arguments, const TempDir& folder,
                         const std::string& before = "env -u DISPLAY -u WAYLAND_DISPLAY") {
    const std::string out = folder / "stdout";
    const std::string err = folder / "stderr";
    const int status = std::system(("XDG_CONFIG_HOME=" + folder.path().string() + " " + before +
                                    " " KINO_CALIBRATE " " + arguments + " >" + out + " 2>" + err)
                                       .c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read_bytes(out), read_bytes(err)};
}

inline CameraModel board_camera() {
    return {
        .width = 320, .height = 240, .fx = 290, .fy = 291, .cx = 157.3, .cy = 121.9, .k1 = -0.08};
}

/// Where the board (chess:9x6:25) is held: every other time on another side and distance.
inline Pose held(int i) {
    const double around = 2.4 * i;
    const glm::dquat rotation =
        glm::angleAxis(0.5, glm::dvec3(std::cos(around), std::sin(around), 0)) *
        glm::angleAxis(0.1 * (i % 3), glm::dvec3(0, 0, 1));
    const glm::dvec3 place(0.06 * (i % 3 - 1), 0.045 * (i / 3 - 1), 0.36 + 0.02 * (i % 2));
    return {glm::normalize(rotation), place - rotation * glm::dvec3(0.1, 0.0625, 0)};
}
constexpr int kPlaces = 9;

inline GreyPicture picture_of(const Pose& pose, std::uint64_t seed) {
    return draw_chessboard(board_camera(), Board{}, pose, seed);
}

/// Raw disparity of the board's plane. `reading`: the depth that the device believes to see.
inline Image<std::uint16_t> disparity_of(
    const Pose& pose, const Disparity& device,
    const std::function<double(int x, int y, double z)>& reading) {
    const Image<glm::dvec2>& rays = pixel_rays(board_camera());
    const glm::dvec3 normal = pose.rotation * glm::dvec3(0, 0, 1);
    Image<std::uint16_t> out(320, 240, Disparity::kNoReading);
    for (int y = 0; y < out.height(); ++y) {
        for (int x = 0; x < out.width(); ++x) {
            const glm::dvec3 ray(rays.at(x, y), 1);
            const double z = glm::dot(normal, pose.translation) / glm::dot(normal, ray);
            if (z > 0) out.at(x, y) = device.raw(reading(x, y, z));
        }
    }
    return out;
}

struct BoardSession {
    struct Stand {
        Pose pose;
        int frames = 3;
    };
    std::vector<Stand> stands;
    Disparity device;
    std::function<double(int, int, double)> reading = [](int, int, double z) { return z; };
};

/// Infrared and raw disparity of a board that holds still for some frames in each place. False:
/// it could not be written.
inline bool write_board_session(const std::string& file, const RigParameters& rig,
                                const BoardSession& session) {
    SourceInfo info;
    info.name = "drawn";
    info.serial = rig.serial;
    info.streams = {{{0, StreamKind::depth}, 320, 240, 30, "disparity"},
                    {{0, StreamKind::infrared}, 320, 240, 30, "grey"}};
    auto recorder = Recorder::create(file, info, rig, {});
    if (!recorder) return false;
    std::int64_t index = 0;
    for (const auto& [pose, frames] : session.stands) {
        const GreyPicture grey = picture_of(pose, static_cast<std::uint64_t>(index));
        Image<std::uint16_t> brightness(320, 240);
        for (std::size_t k = 0; k < grey.size(); ++k) {
            brightness.pixels()[k] = static_cast<std::uint16_t>(grey.pixels()[k] * 4);
        }
        const Image<std::uint16_t> readings = disparity_of(pose, session.device, session.reading);
        for (int repeat = 0; repeat < frames; ++repeat, ++index) {
            FrameSet set;
            set.index = index;
            set.time = index * 33 * kNsPerMs;
            const FrameHeader header = {
                .device_time = set.time, .host_time = set.time, .sequence = index};
            const auto infrared = std::make_shared<InfraredFrame>();
            infrared->header = header;
            infrared->raw = brightness;
            set.infrared = infrared;
            const auto depth = std::make_shared<DepthFrame>();
            depth->header = header;
            depth->unit = DepthUnit::kinect_disparity11;
            depth->raw = readings;
            set.depth = depth;
            (*recorder)->put(set);
        }
    }
    return (*recorder)->close().has_value();
}

/// What such a session says of itself: a Kinect v1's defaults, the infrared camera alone.
inline RigParameters board_session_rig(const std::string& serial) {
    RigParameters rig = default_kinect1_rig(320, 240);
    rig.color.reset();
    rig.serial = serial;
    return rig;
}

}  // namespace kino::test
