#pragma once

#include <array>
#include <glm/vec3.hpp>
#include <vector>

#include "skeleton/motion/motion_clip.h"

namespace kino::motion_export {

constexpr double kFarthestJointM = 1000;  ///< beyond this a position is no reading

struct TrackFrame {
    double time_s = 0;  ///< since the track's first frame
    std::array<glm::dvec3, kJointCount> world_m{};
    std::array<bool, kJointCount> seen{};  ///< tracked or inferred; else world_m is 0 or bridged
};

/// One person's joints in world space. Frames rise strictly in time; the first and the last have at
/// least one joint that was seen.
struct JointTrack {
    std::uint32_t person = 0;
    std::vector<TrackFrame> frames;
    std::vector<std::size_t> moments;  ///< of the clip, one for each frame
    double median_step_s = 0;          ///< 0 for a single frame
};

/// False for lost, non-finite and absurdly far positions.
[[nodiscard]] bool is_seen(const JointPosition& joint);

/// Checks the clip; the errors are write_motion's.
[[nodiscard]] Result<JointTrack> track_of(const MotionClip& clip, std::uint32_t person);

[[nodiscard]] std::array<bool, kJointCount> ever_seen(const JointTrack& track);

/// The clip's rate, or the track's own; 30 for a single frame without a wish.
[[nodiscard]] double output_rate_hz(const MotionClip& clip, const JointTrack& track);

/// Gives every joint a place wherever it was ever seen: a gap is filled by the parent's place plus
/// the offset from it, linear between the offsets on both sides, held at the ends. `seen` stays as
/// it was. The root of a person without a hip centre hangs straight below the spine or the shoulder
/// centre, as far as the bones say; without those it fails. Other joints never seen stay 0.
[[nodiscard]] Result<void> bridge(JointTrack& track, const std::array<double, kJointCount>& bone_m);

enum class Gaps {
    carry,  ///< positions are interpolated everywhere; `seen` where both neighbours were
    mark    ///< not seen between frames farther apart than 0.25 s and two median steps, either
};

/// Frames at k / rate_hz from 0 to the last time, places linear between neighbours. `seen` is that
/// of a frame within a thousandth of a step, else of both neighbours. Fails above `limit` frames.
[[nodiscard]] Result<JointTrack> resample(const JointTrack& track, double rate_hz, Gaps gaps,
                                          std::size_t limit);

}  // namespace kino::motion_export
