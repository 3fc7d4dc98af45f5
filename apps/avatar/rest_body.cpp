#include "apps/avatar/rest_body.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>

#include "apps/avatar/turns.h"

namespace kino {
namespace {

Joint rest_parent(Joint joint) {
    return kJointParent[index_of(joint)];
}

Joint on_side(Joint left, int side) {
    return static_cast<Joint>(static_cast<int>(left) + 4 * side);
}

/// The segment that a mapped rig joint turns with.
Joint driven_by(Joint joint) {
    switch (joint) {
        case Joint::spine:
            return Joint::shoulder_center;
        case Joint::shoulder_center:
            return Joint::head;
        case Joint::head:
        case Joint::hip_center:
        case Joint::hand_left:
        case Joint::hand_right:
        case Joint::foot_left:
        case Joint::foot_right:
            return joint;
        default:
            return static_cast<Joint>(static_cast<int>(joint) + 1);
    }
}

void fill_missing(const AvatarRig& rig, RestBody& rest) {
    const auto has = [&](Joint j) { return rig.of_joint[index_of(j)] >= 0; };
    const auto at = [&](Joint j) -> glm::dvec3& { return rest.joint_m[index_of(j)]; };
    if (!has(Joint::shoulder_center)) {
        at(Joint::shoulder_center) =
            0.5 * (at(Joint::shoulder_left) + at(Joint::shoulder_right)) + glm::dvec3(0, 0.03, 0);
    }
    if (!has(Joint::spine)) {
        at(Joint::spine) = glm::mix(at(Joint::hip_center), at(Joint::shoulder_center), 0.28);
    }
    if (!has(Joint::head)) {
        at(Joint::head) = at(Joint::shoulder_center) + glm::dvec3(0, 0.11 * rest.height_m, 0);
    }
    for (int side = 0; side < 2; ++side) {
        const Joint wrist = on_side(Joint::wrist_left, side);
        const Joint elbow = on_side(Joint::elbow_left, side);
        const Joint hand = on_side(Joint::hand_left, side);
        const Joint ankle = on_side(Joint::ankle_left, side);
        const Joint knee = on_side(Joint::knee_left, side);
        const Joint foot = on_side(Joint::foot_left, side);
        if (!has(wrist))
            at(wrist) = at(elbow) + (at(elbow) - at(on_side(Joint::shoulder_left, side)));
        if (!has(hand)) at(hand) = glm::mix(at(elbow), at(wrist), 1.34);
        if (!has(ankle)) {
            at(ankle) = glm::dvec3(at(knee).x, 0.05 * rest.height_m, at(knee).z);
        }
        if (!has(foot)) {
            at(foot) =
                glm::dvec3(at(ankle).x, 0.4 * at(ankle).y, at(ankle).z + 0.075 * rest.height_m);
        }
    }
}

/// Whether `joint` is `ancestor` or hangs on it.
bool hangs_on(const AvatarRig& rig, int joint, int ancestor) {
    while (joint >= 0 && joint != ancestor) {
        joint = rig.joints[static_cast<std::size_t>(joint)].parent;
    }
    return joint == ancestor && ancestor >= 0;
}

/// Shares of a segment's joints: those on the way to the next body joint in turn, others by where
/// they lie along the bone.
void set_shares(const AvatarRig& rig, RestBody& rest, Joint segment) {
    const bool chest = segment == Joint::shoulder_center;
    const int end = rig.of_joint[index_of(segment)];
    std::vector<int> way;
    for (std::size_t r = 0; r < rig.joints.size(); ++r) {
        if (rest.drives[r].segment != segment) continue;
        if (hangs_on(rig, end, static_cast<int>(r))) {
            way.push_back(static_cast<int>(r));
            continue;
        }
        const glm::dvec3 from = rest.joint_m[index_of(rest_parent(segment))];
        const double along = glm::dot(rest.drives[r].rest_m - from, rest.axis[index_of(segment)]) /
                             std::max(rest.length_m[index_of(segment)], 1e-6);
        rest.drives[r].share = chest ? 1 : std::clamp(along, 0.0, 1.0);
    }
    for (std::size_t i = 0; i < way.size(); ++i) {
        const double n = static_cast<double>(way.size());
        rest.drives[static_cast<std::size_t>(way[i])].share =
            (static_cast<double>(i) + (chest ? 1.0 : 0.5)) / n;
    }
}

/// Heels and toes by the vertices that the feet hold.
void find_soles(const AvatarRig& rig, RestBody& rest) {
    for (int side = 0; side < 2; ++side) {
        const auto s = static_cast<std::size_t>(side);
        const Joint foot = on_side(Joint::foot_left, side);
        const glm::dvec3 ankle = rest.joint_m[index_of(on_side(Joint::ankle_left, side))];
        const glm::dvec3 end = rest.joint_m[index_of(foot)];
        double back = ankle.z;
        double front = end.z;
        double low = 1e9;
        for (const AvatarPart& part : rig.parts) {
            const MeshAsset& mesh = *part.mesh;
            for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
                double held = 0;
                for (int k = 0; k < 4; ++k) {
                    if (rest.drives[mesh.joints[v][static_cast<std::size_t>(k)]].segment == foot) {
                        held += mesh.weights[v][k];
                    }
                }
                if (held < 0.9) continue;
                back = std::min(back, static_cast<double>(mesh.positions[v].z));
                front = std::max(front, static_cast<double>(mesh.positions[v].z));
                low = std::min(low, static_cast<double>(mesh.positions[v].y));
            }
        }
        if (low > 1e8) low = 0;
        rest.heel_m[s] = {ankle.x, low, back};
        // The tip curls up in most shoes.
        rest.toe_m[s] = {end.x, low, glm::mix(end.z, front, 0.5)};
    }
}

}  // namespace

std::vector<glm::dvec3> rest_positions(const AvatarRig& rig) {
    std::vector<glm::dmat4> object_from_joint;
    std::vector<glm::dvec3> positions;
    for (const MeshJoint& joint : rig.joints) {
        const glm::dmat4 own(joint.parent_from_joint);
        object_from_joint.push_back(
            joint.parent < 0 ? own
                             : object_from_joint[static_cast<std::size_t>(joint.parent)] * own);
        positions.emplace_back(object_from_joint.back()[3]);
    }
    return positions;
}

RestBody make_rest_body(const AvatarRig& rig) {
    RestBody rest;
    const std::vector<glm::dvec3> positions = rest_positions(rig);
    double top = 0;
    for (const AvatarPart& part : rig.parts) {
        for (const glm::vec3& p : part.mesh->positions)
            top = std::max(top, static_cast<double>(p.y));
    }
    rest.height_m = std::max(top, 0.1);
    for (std::size_t j = 0; j < kJointCount; ++j) {
        const int r = rig.of_joint[j];
        if (r >= 0) rest.joint_m[j] = positions[static_cast<std::size_t>(r)];
    }
    rest.has_spine = rig.of_joint[index_of(Joint::spine)] >= 0;
    fill_missing(rig, rest);
    for (std::size_t j = 1; j < kJointCount; ++j) {
        const glm::dvec3 bone = rest.joint_m[j] - rest.joint_m[index_of(kJointParent[j])];
        rest.length_m[j] = std::max(glm::length(bone), 1e-3);
        rest.axis[j] = unit_or(bone, {0, 1, 0});
    }
    rest.axis[0] = rest.axis[index_of(Joint::spine)];
    rest.length_m[0] = rest.length_m[index_of(Joint::spine)];
    for (int side = 0; side < 2; ++side) {
        const auto hinge = [&](Joint upper, Joint lower, const glm::dvec3& towards) {
            const glm::dvec3& a = rest.axis[index_of(upper)];
            const glm::dvec3& b = rest.axis[index_of(lower)];
            const glm::dvec3 bent = glm::cross(a, b);
            // Limbs modelled straight say nothing: elbows bend forwards, knees backwards.
            rest.hinge[index_of(upper)] =
                glm::length(bent) > 0.26 && glm::dot(bent, glm::cross(a, towards)) > 0
                    ? glm::normalize(bent)
                    : across(a, glm::cross(a, towards));
        };
        hinge(on_side(Joint::elbow_left, side), on_side(Joint::wrist_left, side), {0, 0, 1});
        hinge(on_side(Joint::knee_left, side), on_side(Joint::ankle_left, side), {0, 0, -1});
    }

    rest.drives.resize(rig.joints.size());
    std::vector<int> body_of(rig.joints.size(), -1);
    for (std::size_t j = 0; j < kJointCount; ++j) {
        if (rig.of_joint[j] >= 0)
            body_of[static_cast<std::size_t>(rig.of_joint[j])] = static_cast<int>(j);
    }
    for (std::size_t r = 0; r < rig.joints.size(); ++r) {
        RigDrive& drive = rest.drives[r];
        drive.rest_m = positions[r];
        const int parent = rig.joints[r].parent;
        if (body_of[r] >= 0) {
            drive.segment = driven_by(static_cast<Joint>(body_of[r]));
        } else if (parent >= 0) {
            drive.segment = rest.drives[static_cast<std::size_t>(parent)].segment;
        }
        if (body_of[r] >= 0) continue;
        // Collar bones: between the chest and one shoulder.
        for (const Joint shoulder : {Joint::shoulder_left, Joint::shoulder_right}) {
            const int other = rig.of_joint[index_of(
                shoulder == Joint::shoulder_left ? Joint::shoulder_right : Joint::shoulder_left)];
            if (hangs_on(rig, rig.of_joint[index_of(shoulder)], static_cast<int>(r)) &&
                !hangs_on(rig, other, static_cast<int>(r))) {
                drive.segment = shoulder;
            }
        }
    }
    for (const Joint segment : {Joint::shoulder_center, Joint::elbow_left, Joint::elbow_right,
                                Joint::knee_left, Joint::knee_right}) {
        set_shares(rig, rest, segment);
    }
    find_soles(rig, rest);
    return rest;
}

}  // namespace kino
