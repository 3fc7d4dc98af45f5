#pragma once

#include <memory>
#include <string>

#include "tests/sensor/device/fake_kinect/fake_kinect.h"
#include "tests/sensor/device/scenarios/report.h"

namespace kino::guest {

/// The fake with the kernel's driver bound to it.
struct BoundKinect {
    std::shared_ptr<const fake::Feed> feed;
    std::unique_ptr<fake::Kinect> kinect;
    std::string node;  ///< "/dev/video0"
};

/// Inserts gspca_kinect anew, in the mode that gives depth or the one that gives pictures, and
/// plugs in a fake of the noise feed. Null, and reported, if that fails.
[[nodiscard]] std::unique_ptr<BoundKinect> bind_to_kernel(const Report& report, bool depth_mode,
                                                          const fake::KinectOptions& options);

}  // namespace kino::guest
