#include "skeleton/tracking/jointed_model.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace kino {
namespace {

using glm::mat3;
using glm::vec3;

// Sizes of an average person, metres, in the frames of pelvis and chest (left, up, forward).
constexpr float kSpineUp = 0.1285f, kSpineForward = 0.008f, kChestUp = 0.3305f, kChestBack = 0.020f;
constexpr float kShoulderOut = 0.1656f, kShoulderDown = 0.035f, kShoulderForward = 0.005f;
constexpr float kHipOut = 0.1107f, kHipDown = 0.050f, kHipBack = 0.010f;
constexpr float kNeck = 0.194f, kSkullUp = -0.004f, kSkullForward = 0.018f;
constexpr std::array<float, 6> kLimb = {0.226f, 0.2245f, 0.090f, 0.420f, 0.3805f, 0.145f};
constexpr float kTrunkOut = 0.052f, kWaistOut = 0.043f, kBottomOut = 0.057f;  // of the flesh
constexpr float kFingers = 1.7f;  // tip of the hand, in lengths of the hand
constexpr float kToes = 1.15f, kHeel = -0.2f;

constexpr std::array<BoneShape, kBoneCount> kBones = [] {
    const auto joint = [](Joint j, int side = 0) {
        return static_cast<std::uint8_t>(static_cast<int>(j) + 4 * side);
    };
    const auto node = [](int n, int side) { return static_cast<std::uint8_t>(n + side); };
    std::array<BoneShape, kBoneCount> bones{};
    bones[0] = {kHeadNode, kHeadNode, Girth::head, 0.098f, 0.098f};
    bones[1] = {joint(Joint::shoulder_center), joint(Joint::head), Girth::head, 0.064f, 0.058f};
    for (int s = 0; s < 2; ++s) {
        bones[static_cast<std::size_t>(2 + 2 * s)] = {
            node(kChestTopNode, s), node(kChestLowNode, s), Girth::chest, 0.090f, 0.110f};
        bones[static_cast<std::size_t>(3 + 2 * s)] = {
            node(kBellyTopNode, s), node(kBellyLowNode, s), Girth::belly, 0.110f, 0.120f};
        const auto b = static_cast<std::size_t>(6 + 3 * s);
        bones[b] = {joint(Joint::shoulder_left, s), joint(Joint::elbow_left, s), Girth::upper_arm,
                    0.068f, 0.052f};
        bones[b + 1] = {joint(Joint::elbow_left, s), joint(Joint::wrist_left, s), Girth::forearm,
                        0.050f, 0.033f};
        bones[b + 2] = {joint(Joint::wrist_left, s), node(kFingersNode, s), Girth::forearm, 0.031f,
                        0.028f};
        bones[b + 6] = {joint(Joint::hip_left, s), joint(Joint::knee_left, s), Girth::thigh, 0.122f,
                        0.083f};
        bones[b + 7] = {joint(Joint::knee_left, s), joint(Joint::ankle_left, s), Girth::shin,
                        0.066f, 0.048f};
        bones[b + 8] = {node(kHeelNode, s), node(kToesNode, s), Girth::shin, 0.043f, 0.032f};
    }
    return bones;
}();

Length limb_length(int s) {
    constexpr std::array<Length, 6> kOf = {Length::upper_arm, Length::forearm, Length::hand,
                                           Length::thigh,     Length::shin,    Length::foot};
    const int i = s - 1;
    return kOf[static_cast<std::size_t>(i % 3 + (i >= 6 ? 3 : 0))];
}

vec3 axis(int k) {
    vec3 e(0);
    e[k] = 1;
    return e;
}

void turn_about(NodeJacobian& j, int first, const vec3& arm) {
    for (int k = 0; k < 3; ++k) j.add(first + k, glm::cross(axis(k), arm));
}

int shape_unknown(Length l) {
    return kShapeUnknown + static_cast<int>(l);
}

}  // namespace

const BoneShape& bone_shape(Bone bone) {
    return kBones[static_cast<std::size_t>(bone)];
}

vec3 unit_or(const vec3& v, const vec3& otherwise) {
    const float l2 = glm::dot(v, v);
    return l2 > 1e-12f && std::isfinite(l2) ? v / std::sqrt(l2) : otherwise;
}

mat3 rotation_of(const vec3& turn) {
    const float angle = glm::length(turn);
    if (angle < 1e-9f) return mat3(1);
    const vec3 k = turn / angle;
    const float c = std::cos(angle), s = std::sin(angle);
    mat3 r;
    for (int i = 0; i < 3; ++i) {
        const vec3 e = axis(i);
        r[i] = e * c + glm::cross(k, e) * s + k * (k[i] * (1 - c));
    }
    return r;
}

vec3 turn_of(const mat3& r) {
    const vec3 skew = 0.5f * vec3(r[1][2] - r[2][1], r[2][0] - r[0][2], r[0][1] - r[1][0]);
    const float s = glm::length(skew);
    const float c = 0.5f * (r[0][0] + r[1][1] + r[2][2] - 1);
    if (s < 1e-7f) return skew;
    return skew * (std::atan2(s, c) / s);
}

mat3 shortest_arc(const vec3& a, const vec3& b, const vec3& fallback) {
    const vec3 v = glm::cross(a, b);
    const float c = glm::dot(a, b), s = glm::length(v);
    if (s < 1e-6f) return c > 0 ? mat3(1) : rotation_of(fallback * 3.14159265f);
    return rotation_of(v * (std::atan2(s, c) / s));
}

mat3 frame_of(const vec3& up, const vec3& left) {
    const vec3 u = unit_or(up, vec3(0, -1, 0));
    vec3 l = left - u * glm::dot(left, u);
    l = unit_or(l, unit_or(glm::cross(u, vec3(0, 0, -1)), vec3(1, 0, 0)));
    return {l, u, glm::cross(l, u)};
}

float JointedModel::radius_m(Bone bone, float t) const {
    const BoneShape& b = bone_shape(bone);
    return (b.radius_from_m + (b.radius_to_m - b.radius_from_m) * t) * shape[b.girth];
}

void JointedModel::place() {
    const auto at = [this](Joint j) -> vec3& { return node[static_cast<std::size_t>(j)]; };
    const float torso = shape[Length::torso];
    at(Joint::hip_center) = pose.hips_m;
    at(Joint::spine) =
        pose.hips_m + (pose.pelvis[1] * kSpineUp + pose.pelvis[2] * kSpineForward) * torso;
    at(Joint::shoulder_center) =
        at(Joint::spine) + (pose.chest[1] * kChestUp - pose.chest[2] * kChestBack) * torso;
    const vec3 neck = pose[Segment::neck] * shape[Length::neck];
    at(Joint::head) = at(Joint::shoulder_center) + neck * kNeck;
    node[kHeadNode] =
        at(Joint::shoulder_center) + neck * (kNeck + kSkullUp) + pose.chest[2] * kSkullForward;
    for (int side = 0; side < 2; ++side) {
        const float s = side == 0 ? 1.0f : -1.0f;
        const float wide = shape[Length::shoulders] * s, hip = shape[Length::hips] * s;
        const auto joint = [side](Joint left) {
            return static_cast<std::size_t>(left) + 4 * static_cast<std::size_t>(side);
        };
        const auto extra = [side](Node n) {
            return static_cast<std::size_t>(n) + static_cast<std::size_t>(side);
        };
        const mat3 &c = pose.chest, &p = pose.pelvis;
        node[joint(Joint::shoulder_left)] = at(Joint::shoulder_center) +
                                            c[0] * (kShoulderOut * wide) - c[1] * kShoulderDown +
                                            c[2] * kShoulderForward;
        node[joint(Joint::hip_left)] =
            at(Joint::hip_center) + p[0] * (kHipOut * hip) - p[1] * kHipDown - p[2] * kHipBack;
        node[extra(kChestTopNode)] =
            at(Joint::shoulder_center) + c[0] * (kTrunkOut * wide) - c[1] * 0.055f + c[2] * 0.004f;
        node[extra(kChestLowNode)] =
            at(Joint::spine) + c[0] * (kTrunkOut * wide) + c[1] * 0.04f + c[2] * 0.04f;
        node[extra(kBellyTopNode)] =
            at(Joint::spine) + p[0] * (kWaistOut * wide) + p[1] * 0.02f + p[2] * 0.025f;
        node[extra(kBellyLowNode)] =
            at(Joint::hip_center) + p[0] * (kBottomOut * hip) - p[1] * 0.05f - p[2] * 0.004f;
        for (int limb = 0; limb < 2; ++limb) {
            std::size_t from = joint(limb == 0 ? Joint::shoulder_left : Joint::hip_left);
            for (int k = 0; k < 3; ++k) {
                const int segment = 1 + 6 * limb + 3 * side + k;
                const vec3 bone =
                    pose.direction[static_cast<std::size_t>(segment)] *
                    (kLimb[static_cast<std::size_t>(3 * limb + k)] * shape[limb_length(segment)]);
                node[from + 1] = node[from] + bone;
                if (k == 2) {
                    if (limb == 0) {
                        node[extra(kFingersNode)] = node[from] + bone * kFingers;
                    } else {
                        node[extra(kToesNode)] = node[from] + bone * kToes;
                        node[extra(kHeelNode)] = node[from] + bone * kHeel;
                    }
                }
                ++from;
            }
        }
    }
}

void JointedModel::linearize() {
    place();
    for (std::size_t s = 0; s < kSegmentCount; ++s) {
        const vec3& u = pose.direction[s];
        const vec3 a = std::abs(u.x) < std::abs(u.y) ? vec3(1, 0, 0) : vec3(0, 1, 0);
        tangent[2 * s] = glm::normalize(a - u * glm::dot(a, u));
        tangent[2 * s + 1] = glm::cross(u, tangent[2 * s]);
    }
    const auto jac = [this](Joint j) -> NodeJacobian& {
        return jacobian[static_cast<std::size_t>(j)];
    };
    const vec3 hips = joint(Joint::hip_center), spine = joint(Joint::spine);
    const vec3 neck = joint(Joint::shoulder_center);
    const auto root = [&](NodeJacobian& j) {
        j.count = 0;
        for (int k = 0; k < 3; ++k) j.add(k, axis(k));
    };
    const vec3 torso_low = pose.pelvis[1] * kSpineUp + pose.pelvis[2] * kSpineForward;
    const vec3 torso_high = pose.chest[1] * kChestUp - pose.chest[2] * kChestBack;
    // A node of the chest turns with it about the spine and with the pelvis as the spine does.
    const auto of_chest = [&](NodeJacobian& j, const vec3& at, const vec3& torso) {
        root(j);
        turn_about(j, kPelvisUnknown, spine - hips);
        turn_about(j, kChestUnknown, at - spine);
        j.add(shape_unknown(Length::torso), torso);
    };
    const auto of_pelvis = [&](NodeJacobian& j, const vec3& at) {
        root(j);
        turn_about(j, kPelvisUnknown, at - hips);
    };
    root(jac(Joint::hip_center));
    of_pelvis(jac(Joint::spine), spine);
    jac(Joint::spine).add(shape_unknown(Length::torso), torso_low);
    of_chest(jac(Joint::shoulder_center), neck, torso_low + torso_high);
    const auto along = [&](NodeJacobian& j, int segment, float metres, Length length) {
        const auto s = static_cast<std::size_t>(segment);
        const float bone = metres * shape[length];
        j.add(kDirectionUnknown + 2 * segment, tangent[2 * s] * bone);
        j.add(kDirectionUnknown + 2 * segment + 1, tangent[2 * s + 1] * bone);
        j.add(shape_unknown(length), pose.direction[s] * metres);
    };
    jac(Joint::head) = jac(Joint::shoulder_center);
    along(jac(Joint::head), 0, kNeck, Length::neck);
    of_chest(jacobian[kHeadNode], neck + pose.chest[2] * kSkullForward, torso_low + torso_high);
    along(jacobian[kHeadNode], 0, kNeck + kSkullUp, Length::neck);
    for (int side = 0; side < 2; ++side) {
        const float s = side == 0 ? 1.0f : -1.0f;
        const auto joint_index = [side](Joint left) {
            return static_cast<std::size_t>(left) + 4 * static_cast<std::size_t>(side);
        };
        const auto extra = [side](Node n) {
            return static_cast<std::size_t>(n) + static_cast<std::size_t>(side);
        };
        const vec3 cl = pose.chest[0] * s, pl = pose.pelvis[0] * s;
        const std::size_t shoulder = joint_index(Joint::shoulder_left);
        of_chest(jacobian[shoulder], node[shoulder], torso_low + torso_high);
        jacobian[shoulder].add(shape_unknown(Length::shoulders), cl * kShoulderOut);
        const std::size_t top = extra(kChestTopNode), low = extra(kChestLowNode);
        of_chest(jacobian[top], node[top], torso_low + torso_high);
        jacobian[top].add(shape_unknown(Length::shoulders), cl * kTrunkOut);
        of_chest(jacobian[low], node[low], torso_low);
        jacobian[low].add(shape_unknown(Length::shoulders), cl * kTrunkOut);
        const std::size_t hip = joint_index(Joint::hip_left);
        of_pelvis(jacobian[hip], node[hip]);
        jacobian[hip].add(shape_unknown(Length::hips), pl * kHipOut);
        const std::size_t btop = extra(kBellyTopNode), blow = extra(kBellyLowNode);
        of_pelvis(jacobian[btop], node[btop]);
        jacobian[btop].add(shape_unknown(Length::torso), torso_low);
        jacobian[btop].add(shape_unknown(Length::shoulders), pl * kWaistOut);
        of_pelvis(jacobian[blow], node[blow]);
        jacobian[blow].add(shape_unknown(Length::hips), pl * kBottomOut);
        for (int limb = 0; limb < 2; ++limb) {
            std::size_t from = limb == 0 ? shoulder : hip;
            for (int k = 0; k < 3; ++k) {
                const int segment = 1 + 6 * limb + 3 * side + k;
                const float metres = kLimb[static_cast<std::size_t>(3 * limb + k)];
                const Length length = limb_length(segment);
                const auto end = [&](std::size_t to, float factor) {
                    jacobian[to] = jacobian[from];
                    along(jacobian[to], segment, metres * factor, length);
                };
                end(from + 1, 1);
                if (k == 2 && limb == 0) end(extra(kFingersNode), kFingers);
                if (k == 2 && limb == 1) {
                    end(extra(kToesNode), kToes);
                    end(extra(kHeelNode), kHeel);
                }
                ++from;
            }
        }
    }
}

void JointedModel::move(std::span<const float> step) {
    pose.hips_m += vec3(step[0], step[1], step[2]);
    const auto turned = [&](const mat3& r, int first) {
        const auto f = static_cast<std::size_t>(first);
        const mat3 t = rotation_of({step[f], step[f + 1], step[f + 2]}) * r;
        return frame_of(t[1], t[0]);
    };
    pose.pelvis = turned(pose.pelvis, kPelvisUnknown);
    pose.chest = turned(pose.chest, kChestUnknown);
    for (std::size_t s = 0; s < kSegmentCount; ++s) {
        const std::size_t i = kDirectionUnknown + 2 * s;
        pose.direction[s] =
            unit_or(pose.direction[s] + tangent[2 * s] * step[i] + tangent[2 * s + 1] * step[i + 1],
                    pose.direction[s]);
    }
    for (std::size_t k = 0; k < kShapeCount; ++k) shape.factor[k] += step[kShapeUnknown + k];
    place();
}

JointedPose resting_pose(const vec3& hips_m, const vec3& up, const vec3& forward) {
    JointedPose pose;
    pose.hips_m = hips_m;
    const mat3 frame = frame_of(up, glm::cross(up, forward));
    pose.pelvis = pose.chest = frame;
    pose[Segment::neck] = glm::normalize(frame * vec3(0, 1, 0.1f));
    for (int side = 0; side < 2; ++side) {
        const float s = side == 0 ? 1.0f : -1.0f;
        const auto set = [&](Segment left, const vec3& local) {
            pose[segment_of(left, side)] = glm::normalize(frame * local);
        };
        set(Segment::upper_arm_left, {s * 0.17f, -1, -0.05f});
        set(Segment::forearm_left, {s * 0.06f, -1, 0.2f});
        set(Segment::hand_left, {0, -1, 0.2f});
        set(Segment::thigh_left, {s * 0.03f, -1, 0.03f});
        set(Segment::shin_left, {s * 0.03f, -1, -0.05f});
        set(Segment::foot_left, {s * 0.2f, -0.36f, 0.93f});
    }
    return pose;
}

}  // namespace kino
