#pragma once

#include <array>
#include <glm/vec3.hpp>
#include <map>
#include <string>
#include <vector>

#include "skeleton/motion/motion_clip.h"
#include "skeleton/synthetic/motion.h"

namespace kino::test {

constexpr std::uint32_t kPerson = 7;

/// World places of the joints, one array a frame.
using Places = std::vector<std::array<glm::dvec3, kJointCount>>;

/// A person's motion seen by a tilted camera, all joints tracked, 30 Hz from a late host time.
[[nodiscard]] MotionClip synthetic_clip(Motion motion, int frames = 300);

/// Every bone in a random direction in every frame; the same lengths throughout.
[[nodiscard]] MotionClip random_clip(std::uint64_t seed, int frames);

/// A clip at 30 Hz of one person at the given places; identity pose but for the axes.
[[nodiscard]] MotionClip clip_of(const Places& places);

/// The joints of the clip's first body of each moment, world space.
[[nodiscard]] Places world_places(const MotionClip& clip);

/// Directions kept, each bone as long as its median: what a file of constant bones should hold.
[[nodiscard]] Places normalized(const Places& places);

/// Standing at ease: the synthetic person's joints.
[[nodiscard]] std::array<glm::dvec3, kJointCount> standing();

/// Writes to a folder that goes away and returns the file's bytes; the summary too if wanted.
[[nodiscard]] std::string written(const MotionClip& clip, const std::string& name,
                                  MotionSummary* summary = nullptr);

/// Largest distance of joints found by name, in the units of `places` after scaling.
[[nodiscard]] double largest_error_m(const std::map<std::string, glm::dvec3>& found, double unit_m,
                                     const std::array<glm::dvec3, kJointCount>& places);

}  // namespace kino::test
