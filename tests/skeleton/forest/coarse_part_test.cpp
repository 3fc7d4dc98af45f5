#include "skeleton/forest/coarse_part.h"

#include <gtest/gtest.h>

#include <glm/common.hpp>
#include <set>
#include <string>

#include "skeleton/synthetic/body_model.h"

namespace kino {
namespace {

TEST(CoarsePart, NamesAreDistinctAndMirrorNamesMirror) {
    std::set<std::string_view> names;
    for (int i = 0; i < kCoarsePartCount; ++i) {
        const auto part = static_cast<CoarsePart>(i);
        names.insert(coarse_part_name(part));
        EXPECT_EQ(mirrored(mirrored(part)), part);
        std::string name(coarse_part_name(part));
        if (const auto at = name.rfind("_left"); at != std::string::npos)
            name.replace(at, 5, "_right");
        else if (const auto r = name.rfind("_right"); r != std::string::npos)
            name.replace(r, 6, "_left");
        EXPECT_EQ(coarse_part_name(mirrored(part)), name);
    }
    EXPECT_EQ(names.size(), static_cast<std::size_t>(kCoarsePartCount));
}

TEST(CoarsePart, PretrainedLabelsOfASideStayOnIt) {
    std::set<CoarsePart> reached;
    const Forest forest = pcl_forest({ForestTree{{ForestNode{{}, 0, -1, 0}}}});
    for (int p = 0; p < kPclPartCount; ++p) {
        const auto pcl = static_cast<PclPart>(p);
        const CoarsePart part = coarse_part_of(pcl);
        reached.insert(part);
        EXPECT_NE(coarse_parts_of(pcl) & coarse_set(part), 0);
        const std::string& name = forest.labels.at(static_cast<std::size_t>(p));
        for (int c = 0; c < kCoarsePartCount; ++c) {
            const auto coarse = static_cast<CoarsePart>(c);
            if ((coarse_parts_of(pcl) & coarse_set(coarse)) == 0) continue;
            if (mirrored(coarse) == coarse) continue;
            const bool left = coarse_part_name(coarse).ends_with("_left");
            EXPECT_EQ(name.starts_with(left ? "left_" : "right_"), true) << name;
        }
    }
    EXPECT_EQ(reached.size(), static_cast<std::size_t>(kCoarsePartCount));
}

TEST(CoarsePart, FleshIsPartedAtTheJoints) {
    const PosedBody body = pose_body(standing_pose());
    const auto at = [&](Joint flesh, Joint a, Joint b, double w) {
        return coarse_part_at(flesh, glm::mix(body[a], body[b], w) + glm::dvec3(0, 0, 0.04),
                              body.joint_m);
    };
    using enum Joint;
    EXPECT_EQ(at(elbow_left, shoulder_left, elbow_left, 0.6), CoarsePart::upper_arm_left);
    EXPECT_EQ(at(elbow_left, elbow_left, wrist_left, 0.4), CoarsePart::lower_arm_left);
    EXPECT_EQ(at(wrist_left, elbow_left, wrist_left, 0.9), CoarsePart::lower_arm_left);
    EXPECT_EQ(at(hand_right, elbow_right, wrist_right, 0.9), CoarsePart::hand_right);
    EXPECT_EQ(at(knee_right, hip_right, knee_right, 0.6), CoarsePart::upper_leg_right);
    EXPECT_EQ(at(knee_right, knee_right, ankle_right, 0.2), CoarsePart::lower_leg_right);
    EXPECT_EQ(at(ankle_left, knee_left, ankle_left, 0.5), CoarsePart::lower_leg_left);
    EXPECT_EQ(at(foot_left, ankle_left, foot_left, 0.9), CoarsePart::foot_left);
    EXPECT_EQ(at(head, head, spine, 0), CoarsePart::head);
    EXPECT_EQ(at(shoulder_center, shoulder_center, head, 0.5), CoarsePart::torso);
    EXPECT_EQ(at(hip_center, hip_center, hip_left, 0.9), CoarsePart::torso);
}

}  // namespace
}  // namespace kino
