#pragma once

#include <array>
#include <cstdint>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <span>

#include "base/body.h"

namespace kino {

/// Lengths that differ from person to person; both sides share them.
enum class Length : std::uint8_t {
    torso,      ///< hip centre to shoulder centre
    shoulders,  ///< across
    hips,       ///< across
    neck,       ///< shoulder centre to head
    upper_arm,
    forearm,
    hand,
    thigh,
    shin,
    foot,
};
constexpr int kLengthCount = 10;

/// Thickness that differs from person to person, clothes included.
enum class Girth : std::uint8_t { head, chest, belly, upper_arm, forearm, thigh, shin };
constexpr int kGirthCount = 7;
constexpr int kShapeCount = kLengthCount + kGirthCount;

/// Factors to the sizes of a 1.75 m person: lengths, then girths.
struct BodyShape {
    std::array<float, kShapeCount> factor = [] {
        std::array<float, kShapeCount> ones{};
        ones.fill(1.0f);
        return ones;
    }();
    [[nodiscard]] float operator[](Length l) const { return factor[static_cast<std::size_t>(l)]; }
    [[nodiscard]] float operator[](Girth g) const {
        return factor[kLengthCount + static_cast<std::size_t>(g)];
    }
};

/// Bones with a direction of their own: the head's and those of the limbs.
enum class Segment : std::uint8_t {
    neck,
    upper_arm_left,
    forearm_left,
    hand_left,
    upper_arm_right,
    forearm_right,
    hand_right,
    thigh_left,
    shin_left,
    foot_left,
    thigh_right,
    shin_right,
    foot_right,
};
constexpr int kSegmentCount = 13;
constexpr Segment segment_of(Segment left, int side) {
    return static_cast<Segment>(static_cast<int>(left) + 3 * side);
}

/// Depth-camera space, metres. Columns of rotations: the person's left, up, forward.
struct JointedPose {
    glm::vec3 hips_m{0, 0, 2};
    glm::mat3 pelvis{1}, chest{1};
    std::array<glm::vec3, kSegmentCount> direction;  ///< unit, away from the body
    [[nodiscard]] glm::vec3& operator[](Segment s) {
        return direction[static_cast<std::size_t>(s)];
    }
    [[nodiscard]] const glm::vec3& operator[](Segment s) const {
        return direction[static_cast<std::size_t>(s)];
    }
};

/// Unknowns of a fit: hips 3, turns of pelvis and chest 3 each (about the camera's axes), two
/// tangents for each direction, then the shape's factors.
constexpr int kPelvisUnknown = 3, kChestUnknown = 6, kDirectionUnknown = 9;
constexpr int kPoseUnknowns = kDirectionUnknown + 2 * kSegmentCount;
constexpr int kShapeUnknown = kPoseUnknowns;
constexpr int kUnknowns = kPoseUnknowns + kShapeCount;

/// What flesh is attached to.
enum class Bone : std::uint8_t {
    head,
    neck,
    chest_left,
    belly_left,
    chest_right,
    belly_right,
    upper_arm_left,
    forearm_left,
    hand_left,
    upper_arm_right,
    forearm_right,
    hand_right,
    thigh_left,
    shin_left,
    foot_left,
    thigh_right,
    shin_right,
    foot_right,
};
constexpr int kBoneCount = 18;

/// Points of the model: the joints, and where bones end that do not end in joints.
enum Node : std::uint8_t {
    kHeadNode = kJointCount,  ///< middle of the skull
    kChestTopNode,            ///< left, right
    kChestLowNode = kChestTopNode + 2,
    kBellyTopNode = kChestLowNode + 2,
    kBellyLowNode = kBellyTopNode + 2,
    kFingersNode = kBellyLowNode + 2,
    kToesNode = kFingersNode + 2,
    kHeelNode = kToesNode + 2,
    kNodeCount = kHeelNode + 2,
};

struct BoneShape {
    std::uint8_t from, to;  ///< nodes; the same: a ball
    Girth girth;
    float radius_from_m, radius_to_m;
};
[[nodiscard]] const BoneShape& bone_shape(Bone bone);

/// d node / d unknowns.
struct NodeJacobian {
    static constexpr int kMax = 22;
    int count = 0;
    std::array<std::uint8_t, kMax> unknown;
    std::array<glm::vec3, kMax> derivative;
    void add(int index, const glm::vec3& d) {
        unknown[static_cast<std::size_t>(count)] = static_cast<std::uint8_t>(index);
        derivative[static_cast<std::size_t>(count++)] = d;
    }
};

/// The body as a tree of rigid pelvis and chest and of straight bones with directions of their own:
/// bone lengths hold whatever the pose is.
struct JointedModel {
    BodyShape shape;
    JointedPose pose;
    std::array<glm::vec3, kNodeCount> node;
    std::array<glm::vec3, 2 * kSegmentCount> tangent;  ///< two for each direction
    std::array<NodeJacobian, kNodeCount> jacobian;     ///< valid after linearize()

    /// Nodes from pose and shape.
    void place();
    /// Nodes, tangents and jacobians.
    void linearize();
    /// Moves along `step` (kUnknowns numbers, as linearize() left the tangents), then place().
    void move(std::span<const float> step);

    [[nodiscard]] glm::vec3 joint(Joint j) const { return node[static_cast<std::size_t>(j)]; }
    [[nodiscard]] float radius_m(Bone bone, float t) const;
};

/// Standing, arms hanging, upright along `up`, facing `forward` (made orthogonal to it).
[[nodiscard]] JointedPose resting_pose(const glm::vec3& hips_m, const glm::vec3& up,
                                       const glm::vec3& forward);

/// exp of a turn, axis times radians.
[[nodiscard]] glm::mat3 rotation_of(const glm::vec3& turn);
/// The shortest turn from unit a to unit b; half a turn about `fallback` where they are opposite.
[[nodiscard]] glm::mat3 shortest_arc(const glm::vec3& a, const glm::vec3& b,
                                     const glm::vec3& fallback);
/// Nearest rotation with this up; the forward axis keeps its side.
[[nodiscard]] glm::mat3 frame_of(const glm::vec3& up, const glm::vec3& left);
/// Axis times radians of a rotation below half a turn.
[[nodiscard]] glm::vec3 turn_of(const glm::mat3& rotation);
/// `v`, or `otherwise` where it has no direction, with length one.
[[nodiscard]] glm::vec3 unit_or(const glm::vec3& v, const glm::vec3& otherwise);

}  // namespace kino
