#pragma once

#include <array>
#include <filesystem>
#include <glm/vec3.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "base/body.h"
#include "base/error.h"

namespace kino {

/// Somebody's joints over time, as a tracker or a motion capture system saw them: y up, metres,
/// right-handed.
struct JointRecording {
    double rate_hz = 30;
    std::vector<std::array<glm::dvec3, kJointCount>> frames;
};

/// Text: a line "kinoscope joints,1,RATE", then a line for each frame with x, y and z of the 20
/// joints in the order of base/body.h, whole millimetres, separated by commas. Lines that start
/// with # are skipped. Refuses anything else, numbers beyond 20 m, rates outside 1..1000 Hz, files
/// without frames and files beyond 200,000 frames; names the line.
[[nodiscard]] Result<JointRecording> parse_joint_recording(std::string_view text,
                                                           const std::string& where);
[[nodiscard]] Result<JointRecording> read_joint_recording(const std::filesystem::path& path);

}  // namespace kino
