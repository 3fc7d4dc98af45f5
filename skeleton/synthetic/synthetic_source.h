#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "base/image.h"
#include "sensor/source.h"
#include "skeleton/synthetic/depth_sensor.h"
#include "skeleton/synthetic/scene.h"

namespace kino {

/// "synthetic:[motion|performance][?size=640x480|320x240][&noise=on|off]".
struct SyntheticOptions {
    Motion motion = Motion::dance;
    bool performance = false;  ///< performance.h, instead of the motion
    int width = 640;           ///< of both cameras, px
    int height = 480;
    bool noise = true;
};
/// Unknown motions, keys and values are errors that list what there is.
[[nodiscard]] Result<SyntheticOptions> parse_synthetic_uri(const std::string& uri);

/// What really is in front of the sensor at one frame.
struct SyntheticTruth {
    Image<float> depth_m;     ///< along the axis, no noise, no shadow, no limits; 0 = nothing
    Image<PartId> part;       ///< body part, furniture or room
    Image<std::uint8_t> lit;  ///< 1 where the projector reaches the surface
    BodyFrame bodies;         ///< depth-camera space
};

/// A person moving in a room, seen by a computed Kinect v1 at 30 Hz; the motions are seamless loops
/// of 300 frames. Depth is raw 11-bit disparity. Any frame depends on its index alone.
class SyntheticSource : public Source, public Timeline {
  public:
    static constexpr std::int64_t kFrames = 300;  ///< of a motion
    static constexpr double kRateHz = 30;

    /// Fails where validate(scene) does, or if a camera's width is not a multiple of 8.
    [[nodiscard]] static Result<std::unique_ptr<SyntheticSource>> create(
        SyntheticScene scene, const DepthSensorOptions& sensor = {},
        std::string uri = "synthetic:");

    [[nodiscard]] virtual const SyntheticScene& scene() const = 0;
    /// Index within the timeline.
    [[nodiscard]] virtual SyntheticTruth truth(std::int64_t index) = 0;
};

/// Makes open_source() understand "synthetic:".
void register_synthetic_source();

}  // namespace kino
