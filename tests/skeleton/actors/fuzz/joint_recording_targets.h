#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "base/check.h"
#include "skeleton/actors/actor_pose.h"
#include "skeleton/actors/recorded_motion.h"

/// What the parser promises for any bytes at all: no crash, and whatever it accepts moves a body
/// without a number that is not finite.
namespace kino::fuzz {

inline void joint_recording(std::span<const std::uint8_t> bytes) {
    static const ActorBody body = make_actor_body({});
    const auto recording =
        parse_joint_recording({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, "fuzz");
    if (!recording) {
        KINO_CHECK(!recording.error().what.empty());
        return;
    }
    KINO_CHECK(!recording->frames.empty());
    const auto motion = recorded_motion(*recording, true);
    KINO_CHECK(motion->frames() > 0);
    for (int i = 0; i < std::min(motion->frames(), 3); ++i) {
        const PosedBones bones = pose_bones(body, motion->pose(i));
        for (const glm::dvec3& p : bones.joint_m) KINO_CHECK(std::isfinite(p.x + p.y + p.z));
    }
}

}  // namespace kino::fuzz
