#pragma once

#include <functional>
#include <optional>
#include <string>

#include "base/body.h"
#include "base/error.h"
#include "base/image.h"
#include "calibration/rig.h"
#include "skeleton/actors/actor_sequence.h"

namespace kino::test {

/// One frame of a take, with what really is there.
struct TakeFrame {
    TimeNs time = 0;
    Image<float> depth_m;
    Image<std::uint8_t> part;   ///< BodyPart, kNotBody elsewhere
    Image<std::uint8_t> actor;  ///< 1, 2, ...: ids of `truth`
    BodyFrame truth;
};

struct Take {
    std::string name;
    Image<RayXy> rays;
    int frames = 0;
    std::function<void(int, TakeFrame&)> render;
};

/// The 1.75 m person of skeleton/synthetic: "dance", ...
[[nodiscard]] Result<Take> synthetic_take(const std::string& motion, int width, bool noise);

/// Varied people; their truth knows every joint.
[[nodiscard]] Result<Take> actor_take(const ActorTake& options);

}  // namespace kino::test
