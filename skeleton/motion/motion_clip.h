#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "base/body.h"
#include "base/error.h"
#include "base/pose.h"

namespace kino {

/// The bodies of one depth frame and where the camera was.
struct MotionMoment {
    BodyFrame bodies;  ///< depth-camera space
    Pose world_from_depth = world_from_camera_axes();
};

/// What a motion file is made of.
struct MotionClip {
    /// Frames per second of BVH, GLB and C3D; 0: one over the median distance of the moments.
    double rate_hz = 0;
    std::vector<MotionMoment> moments;  ///< times rise strictly
};

enum class MotionFormat : std::uint8_t { bvh, glb, csv, c3d };

/// A person of a clip and the number of moments that hold them.
struct MotionPerson {
    std::uint32_t id = 0;
    std::size_t moments = 0;
    friend bool operator==(const MotionPerson&, const MotionPerson&) = default;
};

/// What was written, and what constant bone lengths and lost joints cost.
struct MotionSummary {
    MotionFormat format = MotionFormat::bvh;
    std::uint32_t person = 0;
    std::size_t moments = 0;        ///< of the clip, from the person's first to the last
    std::size_t frames = 0;         ///< in the file
    double rate_hz = 0;             ///< of the file; of CSV, which is not resampled, the median
    double duration_s = 0;          ///< first to last moment
    std::size_t joints_lost = 0;    ///< of moments * 20
    std::vector<Joint> never_seen;  ///< in the joints' order
    std::size_t bytes = 0;
    /// BVH and GLB only, else 0: the bone that ends in each joint, metres (median; 0 for the root).
    std::array<double, kJointCount> bone_m{};
    /// BVH and GLB only, else 0: joints of the file against those given, where they were seen, mm.
    double mean_error_mm = 0;
    double max_error_mm = 0;
};

/// Most moments first, equals by id. Id 0 is nobody.
[[nodiscard]] std::vector<MotionPerson> people_in(const MotionClip& clip);

/// By the extension, case ignored: .bvh, .glb, .csv or .c3d.
[[nodiscard]] Result<MotionFormat> motion_format(const std::filesystem::path& path);

/// Writes one person's motion in the format of the extension, world space, y up; `person` 0 is the
/// first of people_in(). The rules are in docs/motion-export.md. A file that cannot be written
/// whole leaves what was there before. Errors: an unknown extension or person; no moments; times
/// that do not rise; a rate that is negative, not finite or above 1000; an invalid pose; a person
/// twice in a moment or whose trunk is never seen; more frames than the format holds.
[[nodiscard]] Result<MotionSummary> write_motion(const std::filesystem::path& path,
                                                 const MotionClip& clip, std::uint32_t person = 0);

}  // namespace kino
