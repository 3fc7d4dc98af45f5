#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace kino {

/// The bones that move the actor's mesh. Those of the right side follow those of the left in the
/// same order, kActorBonesOfSide later. A "low" half of a limb has its joint's head in common with
/// the "high" one and only twists against it.
enum class ActorBone : std::uint8_t {
    pelvis,
    waist,
    chest,
    neck,
    head,
    clavicle,
    upper_arm_high,
    upper_arm_low,
    forearm_high,
    forearm_low,
    hand,
    fingers,
    finger_tips,
    thumb,
    thigh_high,
    thigh_low,
    shin_high,
    shin_low,
    foot,
    toes,
};
constexpr std::size_t kActorBonesOfSide = 15;
constexpr std::size_t kActorBoneCount = 35;

/// Index of a bone of a side: 0 the person's left, 1 the right; bones of the middle have no side.
[[nodiscard]] constexpr std::size_t bone_index(ActorBone bone, int side = 0) {
    const auto i = static_cast<std::size_t>(bone);
    return i < static_cast<std::size_t>(ActorBone::clavicle)
               ? i
               : i + kActorBonesOfSide * static_cast<std::size_t>(side);
}

/// Parents come before their children; the pelvis is its own.
constexpr std::array<std::uint8_t, kActorBoneCount> kActorBoneParent = [] {
    std::array<std::uint8_t, kActorBoneCount> parent{0, 0, 1, 2, 3};
    constexpr std::uint8_t kOfLeft[kActorBonesOfSide] = {2,  5, 6,  6,  8,  8,  10, 11,
                                                         10, 0, 14, 14, 16, 16, 18};
    for (std::size_t side = 0; side < 2; ++side) {
        for (std::size_t i = 0; i < kActorBonesOfSide; ++i) {
            const std::uint8_t up = kOfLeft[i];
            parent[5 + kActorBonesOfSide * side + i] =
                static_cast<std::uint8_t>(up < 5 ? up : up + kActorBonesOfSide * side);
        }
    }
    return parent;
}();

}  // namespace kino
