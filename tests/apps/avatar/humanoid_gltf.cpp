#include "humanoid_gltf.h"

#include <array>
#include <cstring>
#include <map>
#include <nlohmann/json.hpp>
#include <vector>

#include "viz/surface/assets/gltf_loader.h"

namespace kino::test {
namespace {

using Json = nlohmann::json;

struct MadeBone {
    std::string name;  ///< plain, "left hand"
    std::string parent;
    glm::dvec3 at;
};

std::vector<MadeBone> made_bones() {
    std::vector<MadeBone> bones = {{"hips", "", {0, 0.95, 0}},
                                   {"spine", "hips", {0, 1.08, 0}},
                                   {"chest", "spine", {0, 1.22, 0}},
                                   {"neck", "chest", {0, 1.42, 0}},
                                   {"head", "neck", {0, 1.60, 0.01}}};
    for (const auto& [side, x] : {std::pair{"left ", 1.0}, std::pair{"right ", -1.0}}) {
        const std::string s(side);
        const auto add = [&](const char* name, const std::string& parent, glm::dvec3 at) {
            bones.push_back({s + name, parent, {x * at.x, at.y, at.z}});
        };
        add("collar", "chest", {0.04, 1.39, 0});
        add("upper arm", s + "collar", {0.18, 1.39, 0});
        add("lower arm", s + "upper arm", {0.46, 1.39, 0});
        add("hand", s + "lower arm", {0.71, 1.39, 0});
        add("finger", s + "hand", {0.80, 1.39, 0});
        add("upper leg", "hips", {0.09, 0.90, 0});
        add("lower leg", s + "upper leg", {0.10, 0.48, 0.01});
        add("foot", s + "lower leg", {0.11, 0.08, -0.01});
        add("toes", s + "foot", {0.12, 0.03, 0.12});
    }
    return bones;
}

std::string called(const std::string& plain, BoneNames style) {
    const bool left = plain.starts_with("left ");
    const bool right = plain.starts_with("right ");
    const std::string part = left ? plain.substr(5) : (right ? plain.substr(6) : plain);
    using Names = std::map<std::string, std::string>;
    switch (style) {
        case BoneNames::mixamo: {
            static const Names names = {
                {"hips", "Hips"},          {"spine", "Spine"},       {"chest", "Spine1"},
                {"neck", "Neck"},          {"head", "Head"},         {"collar", "Shoulder"},
                {"upper arm", "Arm"},      {"lower arm", "ForeArm"}, {"hand", "Hand"},
                {"finger", "HandMiddle1"}, {"upper leg", "UpLeg"},   {"lower leg", "Leg"},
                {"foot", "Foot"},          {"toes", "ToeBase"}};
            return "mixamorig:" + std::string(left ? "Left" : (right ? "Right" : "")) +
                   names.at(part);
        }
        case BoneNames::vrm: {
            static const Names names = {
                {"hips", "Hips"},          {"spine", "Spine"},        {"chest", "UpperChest"},
                {"neck", "Neck"},          {"head", "Head"},          {"collar", "Shoulder"},
                {"upper arm", "UpperArm"}, {"lower arm", "LowerArm"}, {"hand", "Hand"},
                {"finger", "Middle1"},     {"upper leg", "UpperLeg"}, {"lower leg", "LowerLeg"},
                {"foot", "Foot"},          {"toes", "ToeBase"}};
            return "J_Bip_" + std::string(left ? "L_" : (right ? "R_" : "C_")) + names.at(part);
        }
        case BoneNames::blender: {
            static const Names names = {
                {"hips", "hips"},           {"spine", "spine"},       {"chest", "chest"},
                {"neck", "neck"},           {"head", "head"},         {"collar", "shoulder"},
                {"upper arm", "upper_arm"}, {"lower arm", "forearm"}, {"hand", "hand"},
                {"finger", "f_middle.01"},  {"upper leg", "thigh"},   {"lower leg", "shin"},
                {"foot", "foot"},           {"toes", "toe"}};
            return "DEF-" + names.at(part) + (left ? ".L" : (right ? ".R" : ""));
        }
        case BoneNames::makehuman: {
            static const Names names = {{"hips", "root"},
                                        {"spine", "spine04"},
                                        {"chest", "spine02"},
                                        {"neck", "neck01"},
                                        {"head", "head"},
                                        {"collar", "clavicle"},
                                        {"upper arm", "upperarm01"},
                                        {"lower arm", "lowerarm01"},
                                        {"hand", "wrist"},
                                        {"finger", "finger3-1"},
                                        {"upper leg", "upperleg01"},
                                        {"lower leg", "lowerleg01"},
                                        {"foot", "foot"},
                                        {"toes", "toe1-1"}};
            return names.at(part) + (left ? ".L" : (right ? ".R" : ""));
        }
        case BoneNames::unreal: {
            static const Names names = {
                {"hips", "pelvis"},        {"spine", "spine_01"},     {"chest", "spine_02"},
                {"neck", "neck_01"},       {"head", "head"},          {"collar", "clavicle"},
                {"upper arm", "upperarm"}, {"lower arm", "lowerarm"}, {"hand", "hand"},
                {"finger", "middle_01"},   {"upper leg", "thigh"},    {"lower leg", "calf"},
                {"foot", "foot"},          {"toes", "ball"}};
            return names.at(part) + (left ? "_l" : (right ? "_r" : ""));
        }
        case BoneNames::none:
            break;
    }
    return "";
}

std::string base64(const std::vector<std::uint8_t>& bytes) {
    static const char* const kDigits =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        std::uint32_t word = 0;
        for (std::size_t k = 0; k < 3; ++k)
            word = word << 8 | (i + k < bytes.size() ? bytes[i + k] : 0);
        for (std::size_t k = 0; k < 4; ++k) {
            text += i + k > bytes.size() ? '=' : kDigits[word >> (18 - 6 * k) & 63];
        }
    }
    return text;
}

/// Writes accessors one after the other.
class Writer {
  public:
    template <class T>
    int add(const std::vector<T>& values, const char* type, std::size_t parts, int component) {
        while (bytes_.size() % 4 != 0) bytes_.push_back(0);
        const std::size_t at = bytes_.size();
        bytes_.resize(at + values.size() * sizeof(T));
        std::memcpy(bytes_.data() + at, values.data(), values.size() * sizeof(T));
        json["bufferViews"].push_back(
            {{"buffer", 0}, {"byteOffset", at}, {"byteLength", values.size() * sizeof(T)}});
        json["accessors"].push_back({{"bufferView", json["bufferViews"].size() - 1},
                                     {"componentType", component},
                                     {"count", values.size() / parts},
                                     {"type", type}});
        return static_cast<int>(json["accessors"].size()) - 1;
    }
    std::string text() {
        json["buffers"] = {{{"byteLength", bytes_.size()},
                            {"uri", "data:application/octet-stream;base64," + base64(bytes_)}}};
        return json.dump();
    }
    Json json = {{"asset", {{"version", "2.0"}}}};

  private:
    std::vector<std::uint8_t> bytes_;
};

constexpr int kFloats = 5126, kShorts = 5123;

}  // namespace

std::string HumanoidFile::json() const {
    Writer out;
    std::vector<MadeBone> bones = made_bones();
    std::erase_if(bones, [&](const MadeBone& b) { return missing.contains(b.name); });
    const auto index_of_bone = [&](std::string name) {
        while (!name.empty()) {
            for (std::size_t b = 0; b < bones.size(); ++b) {
                if (bones[b].name == name) return static_cast<int>(b);
            }
            // A missing one's children hang on its parent.
            for (const MadeBone& bone : made_bones()) {
                if (bone.name == name) {
                    name = bone.parent;
                    break;
                }
            }
        }
        return -1;
    };
    const double turn = faces_back ? -1 : 1;
    const auto placed = [&](const glm::dvec3& p) {
        const glm::dvec3 q = unit * glm::dvec3(turn * p.x, p.y, turn * p.z);
        return z_up ? glm::dvec3(q.x, -q.z, q.y) : q;
    };
    Json& nodes = out.json["nodes"];
    std::vector<float> inverse_bind;
    Json joint_list = Json::array();
    for (std::size_t b = 0; b < bones.size(); ++b) {
        const int parent = index_of_bone(bones[b].parent);
        const glm::dvec3 at = placed(bones[b].at);
        const glm::dvec3 from =
            parent < 0 ? glm::dvec3(0) : placed(bones[static_cast<std::size_t>(parent)].at);
        Json node = {{"translation", {at.x - from.x, at.y - from.y, at.z - from.z}}};
        if (const std::string name = called(bones[b].name, names); !name.empty())
            node["name"] = name;
        for (std::size_t child = 0; child < bones.size(); ++child) {
            if (index_of_bone(bones[child].parent) == static_cast<int>(b))
                node["children"].push_back(child);
        }
        nodes.push_back(node);
        joint_list.push_back(b);
        for (int c = 0; c < 4; ++c) {
            for (int r = 0; r < 4; ++r) {
                inverse_bind.push_back(c == 3 && r < 3 ? static_cast<float>(-at[r])
                                                       : (c == r ? 1.0f : 0.0f));
            }
        }
    }
    out.json["skins"] = {{{"joints", joint_list},
                          {"inverseBindMatrices", out.add(inverse_bind, "MAT4", 16, kFloats)}}};

    // A box a bone, from it to its first child.
    std::vector<float> positions;
    std::vector<std::uint16_t> indices;
    std::array<std::vector<std::uint16_t>, 2> joints;
    std::array<std::vector<float>, 2> held;
    const auto flush = [&](bool skinned) {
        Json attributes = {{"POSITION", out.add(positions, "VEC3", 3, kFloats)}};
        Json& accessor = out.json["accessors"].back();
        for (std::size_t axis = 0; axis < 3; ++axis) {
            float low = 1e9f;
            float high = -1e9f;
            for (std::size_t i = axis; i < positions.size(); i += 3) {
                low = std::min(low, positions[i]);
                high = std::max(high, positions[i]);
            }
            accessor["min"].push_back(low);
            accessor["max"].push_back(high);
        }
        if (skinned) {
            for (std::size_t set = 0; set < (weights > 4 ? 2u : 1u); ++set) {
                attributes["JOINTS_" + std::to_string(set)] =
                    out.add(joints[set], "VEC4", 4, kShorts);
                attributes["WEIGHTS_" + std::to_string(set)] =
                    out.add(held[set], "VEC4", 4, kFloats);
            }
        }
        const int index = out.add(indices, "SCALAR", 1, kShorts);
        out.json["meshes"].push_back(
            {{"primitives", {{{"attributes", attributes}, {"indices", index}}}}});
        positions.clear();
        indices.clear();
        for (std::size_t set = 0; set < 2; ++set) {
            joints[set].clear();
            held[set].clear();
        }
        return out.json["meshes"].size() - 1;
    };
    const auto box = [&](std::size_t b, const glm::dvec3& around, const glm::dvec3& half) {
        const auto first = static_cast<std::uint16_t>(positions.size() / 3);
        for (int corner = 0; corner < 8; ++corner) {
            for (int axis = 0; axis < 3; ++axis) {
                positions.push_back(static_cast<float>(
                    around[axis] + ((corner >> axis & 1) != 0 ? 1 : -1) * half[axis]));
            }
            int bone = static_cast<int>(b);
            double left = 1;
            for (int k = 0; k < 8; ++k) {
                const bool used = k < weights && bone >= 0;
                const int parent =
                    bone < 0 ? -1 : index_of_bone(bones[static_cast<std::size_t>(bone)].parent);
                const double w = !used ? 0 : (k + 1 == weights || parent < 0 ? left : 0.7 * left);
                joints[static_cast<std::size_t>(k / 4)].push_back(
                    static_cast<std::uint16_t>(used ? bone : 0));
                held[static_cast<std::size_t>(k / 4)].push_back(static_cast<float>(w));
                left -= w;
                if (used) bone = parent;
            }
        }
        for (const int i : {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                            2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5}) {
            indices.push_back(static_cast<std::uint16_t>(first + i));
        }
    };
    for (std::size_t b = 0; b < bones.size(); ++b) {
        const glm::dvec3 at = placed(bones[b].at);
        const double low = bones[b].name.ends_with("toes") ? 0.03 : 0.05;
        if (rigid) {
            box(b, glm::dvec3(0), glm::dvec3(0.5 * low * unit) / mesh_scale);
            const std::size_t mesh = flush(false);
            nodes[b]["children"].push_back(nodes.size());
            nodes.push_back(
                {{"mesh", mesh}, {"scale", {mesh_scale.x, mesh_scale.y, mesh_scale.z}}});
            // Parents must not lose what was written after them.
            continue;
        }
        box(b, at, glm::dvec3(low * unit));
    }
    if (rigid) box(0, placed(bones[0].at), glm::dvec3(0.01 * unit));
    const std::size_t mesh = flush(true);
    const std::size_t skinned_node = nodes.size();
    nodes.push_back({{"mesh", mesh}, {"skin", 0}});
    Json top = {{"children", {0}}};
    if (z_up) top["rotation"] = {-0.70710678118654752, 0, 0, 0.70710678118654752};
    const std::size_t top_node = nodes.size();
    nodes.push_back(top);
    out.json["scenes"] = {{{"nodes", {top_node, skinned_node}}}};
    out.json["scene"] = 0;
    return out.text();
}

Result<GltfModel> HumanoidFile::model() const {
    const std::string text = json();
    const auto none = [](const std::string& name, std::size_t) {
        return Result<std::vector<std::uint8_t>>(fail("no file " + name));
    };
    return parse_gltf({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()},
                      "made.gltf", none);
}

}  // namespace kino::test
