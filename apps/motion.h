#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "apps/pipeline/body_stage.h"
#include "base/error.h"
#include "skeleton/motion/motion_clip.h"

namespace kino {

struct MotionRequest {
    std::filesystem::path file;  ///< .bvh, .glb, .csv or .c3d
    std::uint32_t person = 0;    ///< 0: the one in most frames
    double rate_hz = 0;          ///< of BVH, GLB and C3D; 0: that of the recording
    /// BodyMode::off: the recorded ones, or found in the depth where none were recorded.
    BodyOptions bodies;
    std::int64_t from = 0;
    std::optional<std::int64_t> count;  ///< frames; empty: all
    bool replace = false;
};

struct MotionOutcome {
    MotionSummary summary;
    bool tracked = false;  ///< found in the depth
    std::size_t people = 0;
};

/// Called with frames done and in all; false ends it.
using MotionWatch = std::function<bool(std::int64_t done, std::int64_t total)>;

/// Writes the motion of one person of a recording. Fails where nobody is in it, for devices, for a
/// file that is there and not to be replaced, and as write_motion() and BodyStage::create() do.
[[nodiscard]] Result<MotionOutcome> export_motion(const std::string& uri,
                                                  const MotionRequest& request,
                                                  const MotionWatch& watch);

}  // namespace kino
