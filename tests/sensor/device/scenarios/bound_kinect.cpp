#include "tests/sensor/device/scenarios/bound_kinect.h"

#include <utility>

#include "tests/sensor/device/scenarios/modules.h"

namespace kino::guest {

std::unique_ptr<BoundKinect> bind_to_kernel(const Report& report, bool depth_mode,
                                            const fake::KinectOptions& options) {
    auto bound = std::make_unique<BoundKinect>();
    const auto in = insert_module("gspca_kinect", depth_mode ? "depth_mode=1" : "");
    if (!in) {
        report.failure(in.error().to_string());
        return nullptr;
    }
    bound->feed = fake::noise_feed(23);
    auto kinect = fake::Kinect::plug(bound->feed, options);
    if (!kinect) {
        report.failure(kinect.error().to_string());
        return nullptr;
    }
    bound->kinect = std::move(*kinect);
    bound->node = wait_for_video_node("gspca");
    if (bound->node.empty()) {
        report.failure("the kernel's driver made no node");
        return nullptr;
    }
    return bound;
}

}  // namespace kino::guest
