#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "base/check.h"
#include "calibration/files/camera_text.h"

/// What the readers of other programs' calibrations promise for any bytes: no crash, and what is
/// accepted is valid and survives being written and read again. Shared by the libFuzzer driver and
/// mutation_test.cpp.
namespace kino::fuzz {

inline void camera_text(std::span<const std::uint8_t> bytes) {
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    if (const auto ros = read_ros_camera_info(text, "fuzz")) {
        KINO_CHECK(validate(ros->camera, "fuzz").has_value());
        const auto again = read_ros_camera_info(ros_camera_info(*ros), "fuzz");
        KINO_CHECK(again.has_value() && again->camera == ros->camera);
    }
    if (const auto cv = read_opencv_yaml(text, "fuzz", std::pair(640, 480))) {
        KINO_CHECK(cv->cameras.size() == 1 || cv->cameras.size() == 2);
        const auto again = read_opencv_yaml(opencv_yaml(*cv), "fuzz");
        KINO_CHECK(again.has_value() && again->cameras.size() == cv->cameras.size());
        for (std::size_t i = 0; i < cv->cameras.size(); ++i) {
            KINO_CHECK(again->cameras[i].camera == cv->cameras[i].camera);
        }
    }
    if (const auto tum = read_tum_intrinsics(text, "fuzz", std::pair(640, 480))) {
        const auto written = tum_intrinsics(*tum);
        KINO_CHECK(written.has_value());
        const auto again = read_tum_intrinsics(*written, "fuzz");
        KINO_CHECK(again.has_value() && again->camera == tum->camera);
    }
}

}  // namespace kino::fuzz
