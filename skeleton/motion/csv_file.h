#pragma once

#include <string>

#include "skeleton/motion/joint_track.h"

namespace kino::motion_export {

struct CsvText {
    std::string text;
    std::size_t frames = 0;  ///< moments with rows
};

/// One row for each joint of each moment the person is in, as given: nothing is resampled. Numbers
/// are the shortest that read back to the same bits.
[[nodiscard]] CsvText csv_text(const MotionClip& clip, const JointTrack& track);

}  // namespace kino::motion_export
