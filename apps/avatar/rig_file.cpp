#include "apps/avatar/rig_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/matrix.hpp>
#include <map>

#include "apps/avatar/bone_names.h"
#include "apps/avatar/turns.h"
#include "base/check.h"
#include "viz/surface/mesh_shapes.h"

namespace kino {
namespace {

/// Rigs of other heights are brought to this one.
constexpr double kUsualHeightM = 1.75;
constexpr double kLeastHeightM = 1.2, kMostHeightM = 2.2;

/// The bones of a file and where its vertices get them from.
struct FileSkeleton {
    std::vector<FileBone> bones;
    std::vector<int> bone_of_node;  ///< the node's own bone, or the nearest above; -1: none
    std::vector<glm::dmat4> model_from_node;
    bool bind_pose = true;  ///< rest is what inverse bind matrices say; false: where nodes are
    /// About how the file itself stands the bind pose up: what its first joint does at rest.
    glm::dmat3 model_from_bind{1};
};

FileSkeleton skeleton_of(const GltfModel& model) {
    FileSkeleton out;
    out.model_from_node = model_from_nodes(model, nullptr, 0);
    out.bone_of_node.assign(model.nodes.size(), -1);
    std::vector<glm::dmat4> model_from_bone(model.nodes.size(), glm::dmat4(0.0));
    for (const GltfSkin& skin : model.skins) {
        for (std::size_t j = 0; j < skin.joints.size(); ++j) {
            const auto node = static_cast<std::size_t>(skin.nodes[j]);
            if (out.bone_of_node[node] >= 0) continue;
            out.bone_of_node[node] = static_cast<int>(out.bones.size());
            out.bones.push_back({model.nodes[node].name, static_cast<int>(node), {}});
            const glm::dmat4 bind(skin.joints[j].joint_from_bind);
            if (out.bones.size() == 1) {
                out.model_from_bind = glm::dmat3(out.model_from_node[node] * bind);
            }
            model_from_bone[node] = std::abs(glm::determinant(bind)) > 1e-30
                                        ? glm::inverse(bind)
                                        : out.model_from_node[node];
        }
    }
    // Meshes that hang on bones without a skin are where their nodes are, so all must be.
    for (const GltfNode& node : model.nodes) {
        if (!node.meshes.empty() && node.skin < 0) out.bind_pose = false;
    }
    for (FileBone& bone : out.bones) {
        const auto node = static_cast<std::size_t>(bone.parent);
        bone.at = glm::dvec3((out.bind_pose ? model_from_bone : out.model_from_node)[node][3]);
        bone.parent = -1;
        for (int up = model.nodes[node].parent; up >= 0;
             up = model.nodes[static_cast<std::size_t>(up)].parent) {
            if (out.bone_of_node[static_cast<std::size_t>(up)] < 0) continue;
            bone.parent = out.bone_of_node[static_cast<std::size_t>(up)];
            break;
        }
    }
    // Nodes come parents first.
    for (std::size_t i = 0; i < model.nodes.size(); ++i) {
        if (out.bone_of_node[i] < 0 && model.nodes[i].parent >= 0) {
            out.bone_of_node[i] = out.bone_of_node[static_cast<std::size_t>(model.nodes[i].parent)];
        }
    }
    return out;
}

/// The turn that makes the rig stand up and face +z: to the nearest axes, if it nearly does.
glm::dquat upright_from_file(const FileSkeleton& file,
                             const std::array<int, kJointCount>& of_joint) {
    const auto at = [&](Joint j) {
        return file.bones[static_cast<std::size_t>(of_joint[static_cast<std::size_t>(j)])].at;
    };
    const glm::dvec3 left = at(Joint::hip_left) - at(Joint::hip_right) + at(Joint::shoulder_left) -
                            at(Joint::shoulder_right);
    const glm::dvec3 up = at(Joint::shoulder_left) + at(Joint::shoulder_right) -
                          at(Joint::knee_left) - at(Joint::knee_right);
    const glm::dquat turn =
        glm::conjugate(frame_of(unit_or(up, {0, 1, 0}), unit_or(left, {1, 0, 0})));
    glm::dquat best = turn;
    double nearest = 0.4;
    for (int axis = 0; axis < 6; ++axis) {
        for (int other = 0; other < 6; ++other) {
            if (axis / 2 == other / 2) continue;
            glm::dvec3 y(0);
            glm::dvec3 x(0);
            y[axis / 2] = axis % 2 == 0 ? 1 : -1;
            x[other / 2] = other % 2 == 0 ? 1 : -1;
            const glm::dquat snapped = glm::conjugate(frame_of(y, x));
            const double off = angle_of(snapped * glm::conjugate(turn));
            if (off < nearest) {
                nearest = off;
                best = snapped;
            }
        }
    }
    return best;
}

bool hangs_below(const std::vector<FileBone>& bones, int bone, int ancestor) {
    while (bone >= 0 && bone != ancestor) bone = bones[static_cast<std::size_t>(bone)].parent;
    return bone == ancestor;
}

/// Feet of rigs for inverse kinematics hang on the root; here they follow the leg, and so on.
void mend_parents(FileSkeleton& file, const std::array<int, kJointCount>& of_joint,
                  std::vector<std::string>& notes) {
    for (std::size_t j = 1; j < kJointCount; ++j) {
        const int bone = of_joint[j];
        if (bone < 0) continue;
        Joint above = kJointParent[j];
        while (of_joint[static_cast<std::size_t>(above)] < 0) {
            above = kJointParent[static_cast<std::size_t>(above)];
        }
        // Shoulders hang on the chest, not on the neck.
        if (above == Joint::shoulder_center) above = Joint::spine;
        const int wanted = of_joint[static_cast<std::size_t>(above)];
        if (hangs_below(file.bones, bone, wanted)) continue;
        if (hangs_below(file.bones, wanted, bone)) continue;
        notes.push_back(fmt::format("bone {} now follows {}",
                                    file.bones[static_cast<std::size_t>(bone)].name,
                                    file.bones[static_cast<std::size_t>(wanted)].name));
        file.bones[static_cast<std::size_t>(bone)].parent = wanted;
    }
}

/// Vertices of everything with one material.
struct Gathered {
    MeshAsset mesh;
    std::vector<std::uint16_t> unused;
};

void append_mesh(const GltfModel& model, const FileSkeleton& file, std::size_t node_index,
                 const MeshAsset& from, const glm::dmat4& object_from_model, bool textured,
                 MeshAsset& to, std::size_t& unbound) {
    const GltfNode& node = model.nodes[node_index];
    const GltfSkin* skin = node.skin < 0 || !from.skinned()
                               ? nullptr
                               : &model.skins[static_cast<std::size_t>(node.skin)];
    std::vector<glm::dmat4> posed;
    if (skin != nullptr && !file.bind_pose) {
        for (const glm::mat4& m : pose_of(*skin, file.model_from_node)) posed.emplace_back(m);
    }
    const auto first = static_cast<std::uint32_t>(to.positions.size());
    const int own_bone = file.bone_of_node[node_index];
    if (skin == nullptr && own_bone < 0) ++unbound;
    bool mirrored = false;
    for (std::size_t v = 0; v < from.positions.size(); ++v) {
        glm::dmat4 m(1.0);
        std::array<std::uint16_t, 4> joints{};
        glm::vec4 weights(1, 0, 0, 0);
        if (skin == nullptr) {
            m = file.model_from_node[node_index];
            joints[0] = static_cast<std::uint16_t>(std::max(own_bone, 0));
        } else {
            weights = from.weights[v];
            if (!posed.empty()) m = glm::dmat4(0.0);
            for (int k = 0; k < 4; ++k) {
                const std::uint16_t j = from.joints[v][static_cast<std::size_t>(k)];
                if (!posed.empty()) m += static_cast<double>(weights[k]) * posed[j];
                joints[static_cast<std::size_t>(k)] = static_cast<std::uint16_t>(
                    std::max(file.bone_of_node[static_cast<std::size_t>(skin->nodes[j])], 0));
            }
        }
        m = object_from_model * m;
        const glm::dmat3 turn(m);
        const glm::dmat3 t = glm::transpose(turn);
        const double sign = glm::determinant(turn) < 0 ? -1 : 1;
        mirrored = sign < 0;
        const glm::dvec3 n(from.normals[v]);
        const glm::dvec3 normal =
            sign *
            glm::dmat3(glm::cross(t[1], t[2]), glm::cross(t[2], t[0]), glm::cross(t[0], t[1])) * n;
        to.positions.emplace_back(glm::dvec3(m * glm::dvec4(glm::dvec3(from.positions[v]), 1.0)));
        to.normals.emplace_back(unit_or(normal * 1e6, {0, 1, 0}));
        if (textured) to.uvs.push_back(from.uvs.empty() ? glm::vec2(0) : from.uvs[v]);
        to.joints.push_back(joints);
        to.weights.push_back(weights);
    }
    for (std::size_t i = 0; i + 2 < from.indices.size(); i += 3) {
        to.indices.push_back(first + from.indices[i]);
        to.indices.push_back(first + from.indices[i + (mirrored ? 2 : 1)]);
        to.indices.push_back(first + from.indices[i + (mirrored ? 1 : 2)]);
    }
}

/// Bones with parents first: the new number of each.
std::vector<int> parents_first(const std::vector<FileBone>& bones) {
    std::vector<int> order;
    std::vector<int> number(bones.size(), -1);
    bool more = true;
    while (more) {
        more = false;
        for (std::size_t b = 0; b < bones.size(); ++b) {
            if (number[b] >= 0) continue;
            if (bones[b].parent >= 0 && number[static_cast<std::size_t>(bones[b].parent)] < 0)
                continue;
            number[b] = static_cast<int>(order.size());
            order.push_back(static_cast<int>(b));
            more = true;
        }
    }
    KINO_CHECK(order.size() == bones.size());
    return number;
}

}  // namespace

Result<AvatarRig> rig_of_model(const GltfModel& model, const std::string& where) {
    if (model.skins.empty()) {
        return fail("the file has no skin", where,
                    "a rigged character has bones that meshes follow");
    }
    AvatarRig rig;
    rig.notes = model.notes;
    FileSkeleton file = skeleton_of(model);
    if (file.bones.empty() || file.bones.size() > 4096) {
        return fail(fmt::format("{} bones", file.bones.size()), where, "1 to 4096 can be used");
    }
    for (const FileBone& bone : file.bones) {
        if (!(glm::dot(bone.at, bone.at) < 1e12)) {
            return fail("bone " + bone.name + " is nowhere", where, "its matrix is not a place");
        }
    }
    std::vector<FileBone> standing = file.bones;
    if (file.bind_pose) {
        for (FileBone& bone : standing) bone.at = file.model_from_bind * bone.at;
    }
    KINO_ASSIGN(const auto of_bone, recognize_bones(standing, where, rig.notes));
    const glm::dquat upright = upright_from_file(file, of_bone);
    if (angle_of(upright) > 1e-3) rig.notes.push_back("turned to stand upright and face +z");
    mend_parents(file, of_bone, rig.notes);

    std::map<int, MeshAsset> meshes;
    std::size_t unbound = 0;
    const glm::dmat4 turn = glm::mat4_cast(upright);
    for (std::size_t i = 0; i < model.nodes.size(); ++i) {
        for (const int m : model.nodes[i].meshes) {
            const GltfMesh& mesh = model.meshes[static_cast<std::size_t>(m)];
            const bool textured =
                mesh.material >= 0 &&
                model.materials[static_cast<std::size_t>(mesh.material)].texture != nullptr;
            append_mesh(model, file, i, *mesh.asset, turn, textured, meshes[mesh.material],
                        unbound);
        }
    }
    if (unbound > 0) {
        rig.notes.push_back(
            fmt::format("{} meshes hang on no bone: they follow the hips", unbound));
    }
    glm::dvec3 low(1e300);
    glm::dvec3 high(-1e300);
    for (const auto& [material, mesh] : meshes) {
        for (const glm::vec3& p : mesh.positions) {
            low = glm::min(low, glm::dvec3(p));
            high = glm::max(high, glm::dvec3(p));
        }
    }
    const double height = high.y - low.y;
    if (!(height > 1e-6) || !(height < 1e6)) {
        return fail("the meshes have no height", where, "metres, as glTF has it");
    }
    double scale = 1;
    if (height < kLeastHeightM || height > kMostHeightM) {
        scale = kUsualHeightM / height;
        rig.notes.push_back(fmt::format("{:.3g} m high: brought to {} m", height, kUsualHeightM));
    }
    const glm::dvec3 hips = upright * file.bones[static_cast<std::size_t>(of_bone[0])].at;
    const glm::dvec3 shift(-hips.x, -low.y, -hips.z);
    const auto placed = [&](const glm::dvec3& p) { return scale * (p + shift); };

    const std::vector<int> number = parents_first(file.bones);
    rig.joints.resize(file.bones.size());
    for (std::size_t b = 0; b < file.bones.size(); ++b) {
        const FileBone& bone = file.bones[b];
        const glm::dvec3 at = placed(upright * bone.at);
        const glm::dvec3 above =
            bone.parent < 0
                ? glm::dvec3(0)
                : placed(upright * file.bones[static_cast<std::size_t>(bone.parent)].at);
        MeshJoint& joint = rig.joints[static_cast<std::size_t>(number[b])];
        joint.name = bone.name;
        joint.parent = bone.parent < 0 ? -1 : number[static_cast<std::size_t>(bone.parent)];
        joint.parent_from_joint = glm::translate(glm::mat4(1), glm::vec3(at - above));
        joint.joint_from_bind = glm::translate(glm::mat4(1), glm::vec3(-at));
    }
    for (std::size_t j = 0; j < kJointCount; ++j) {
        rig.of_joint[j] = of_bone[j] < 0 ? -1 : number[static_cast<std::size_t>(of_bone[j])];
    }
    rig.materials = model.materials;
    if (rig.materials.size() > kMaxMaterials - 1) {
        rig.notes.push_back(fmt::format("{} materials: only the first {} are used",
                                        rig.materials.size(), kMaxMaterials - 1));
        rig.materials.resize(kMaxMaterials - 1);
    }
    for (auto& [material, mesh] : meshes) {
        for (glm::vec3& p : mesh.positions) p = placed(glm::dvec3(p));
        for (auto& joints : mesh.joints) {
            for (std::uint16_t& j : joints) j = static_cast<std::uint16_t>(number[j]);
        }
        mesh.name =
            material < 0 ? "plain" : model.materials[static_cast<std::size_t>(material)].name;
        set_bounding_sphere(mesh);
        if (const std::string broken = broken_invariant(mesh); !broken.empty()) {
            return fail("the mesh cannot be used: " + broken, where);
        }
        const std::uint32_t index = material < 0 ? 0 : static_cast<std::uint32_t>(material) + 1;
        rig.parts.push_back({std::make_shared<const MeshAsset>(std::move(mesh)),
                             index > rig.materials.size() ? 0 : index});
    }
    return rig;
}

}  // namespace kino
