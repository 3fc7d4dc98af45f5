#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include "base/error.h"
#include "skeleton/forest/forest.h"
#include "skeleton/forest/part_labeller.h"

namespace kino {

/// The parts that PCL's people trees tell apart, in their numbering. Left and right are the
/// person's own.
enum class PclPart : std::uint8_t {
    left_foot,
    left_leg,
    left_knee,
    left_thigh,
    right_foot,
    right_leg,
    right_knee,
    right_thigh,
    right_hips,
    left_hips,
    neck,
    right_arm,
    right_elbow,
    right_forearm,
    right_hand,
    left_arm,
    left_elbow,
    left_forearm,
    left_hand,
    face_left_bottom,
    face_right_bottom,
    face_left_top,
    face_right_top,
    right_chest,
    left_chest,
};
constexpr int kPclPartCount = 25;
/// The focal length that PCL's own code runs its trees with, px.
constexpr double kPclFocalPx = 1000;

/// One tree of PCL's text format (Point Cloud Library, gpu/people): the depth D, then 2^D - 1 lines
/// "du1 dv1 du2 dv2 threshold" of a complete tree (children of n at 2n + 1 and 2n + 2), then 2^D
/// labels, all decimal and apart by white space. Offsets are mm (px = offset * focal / depth),
/// within +-8191; D is 1..20. Subtrees with one label become one leaf; leaf indices are labels.
[[nodiscard]] Result<ForestTree> parse_pcl_tree(std::string_view text, const std::string& where);

/// The trees of unpacked files as a forest whose leaves vote for one label each.
[[nodiscard]] Result<Forest> read_pcl_forest(std::span<const std::filesystem::path> trees);

/// Where two labels have equally many trees, PCL counts the trees of the pixels around (3x3, within
/// 50 mm) as well and takes the lowest of the most frequent; so does this. `labels` are a PCL
/// forest's for `body`, all of whose pixels must be listed. Allocates.
void settle_pcl_ties(const BodyDepth& body, PartLabels& labels);

/// A forest of trees whose leaf indices are PclPart values.
[[nodiscard]] Forest pcl_forest(std::vector<ForestTree> trees);

}  // namespace kino
