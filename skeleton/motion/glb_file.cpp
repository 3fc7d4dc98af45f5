#include "skeleton/motion/glb_file.h"

#include <bit>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <vector>

#include "skeleton/motion/bone_mesh.h"

namespace kino::motion_export {
namespace {

using nlohmann::json;

// Constants of the glTF 2.0 specification.
constexpr int kByte = 5121, kShort = 5123, kFloat = 5126;
constexpr int kVertices = 34962, kIndices = 34963;
constexpr std::uint32_t kGlbMagic = 0x46546C67, kVersion = 2, kJson = 0x4E4F534A, kBin = 0x004E4942;

void put_u32(std::string& out, std::uint32_t value) {
    for (int shift = 0; shift < 32; shift += 8) out += static_cast<char>(value >> shift & 0xff);
}

void put_float(std::string& out, double value) {
    put_u32(out, std::bit_cast<std::uint32_t>(static_cast<float>(value)));
}

std::uint32_t size_of(const std::string& bytes) {
    return static_cast<std::uint32_t>(bytes.size());
}

class Document {
  public:
    Document() {
        root_["asset"] = {{"version", "2.0"}, {"generator", "Kinoscope"}};
        root_["accessors"] = json::array();
        root_["bufferViews"] = json::array();
    }
    json& root() { return root_; }

    /// A view and an accessor of its own for the bytes; returns the accessor.
    std::size_t add(const std::string& bytes, int component, const char* type, std::size_t count,
                    int target = 0) {
        json view = {{"buffer", 0}, {"byteOffset", bin_.size()}, {"byteLength", bytes.size()}};
        if (target != 0) view["target"] = target;
        bin_ += bytes;
        bin_.resize((bin_.size() + 3) / 4 * 4, '\0');
        root_["bufferViews"].push_back(std::move(view));
        json& accessors = root_["accessors"];
        accessors.push_back({{"bufferView", root_["bufferViews"].size() - 1},
                             {"componentType", component},
                             {"type", type},
                             {"count", count}});
        return accessors.size() - 1;
    }
    json& accessor(std::size_t i) { return root_["accessors"][i]; }

    std::string finish() {
        root_["buffers"] = json::array({{{"byteLength", bin_.size()}}});
        std::string text = root_.dump();
        text.resize((text.size() + 3) / 4 * 4, ' ');
        std::string out;
        put_u32(out, kGlbMagic);
        put_u32(out, kVersion);
        put_u32(out, 12 + 8 + size_of(text) + 8 + size_of(bin_));
        put_u32(out, size_of(text));
        put_u32(out, kJson);
        out += text;
        put_u32(out, size_of(bin_));
        put_u32(out, kBin);
        out += bin_;
        return out;
    }

  private:
    json root_;
    std::string bin_;
};

json vec3_json(const glm::dvec3& v) {
    return json::array({static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)});
}

void add_nodes(Document& document, const SkeletalMotion& motion) {
    json nodes = json::array();
    for (std::size_t n = 0; n < kNodeCount; ++n) {
        json node = {{"name", rest_nodes()[n].name}};
        const bool root = rest_nodes()[n].parent < 0;
        node["translation"] = vec3_json(root ? motion.poses.front().root_m : motion.offset_m[n]);
        for (const int child : tree_order()) {
            if (rest_nodes()[child].parent == static_cast<int>(n)) {
                node["children"].push_back(child);
            }
        }
        nodes.push_back(std::move(node));
    }
    nodes.push_back({{"name", "bones"}, {"mesh", 0}, {"skin", 0}});
    document.root()["nodes"] = std::move(nodes);
    document.root()["scenes"] = json::array({{{"nodes", {0, kNodeCount}}}});
    document.root()["scene"] = 0;
}

void add_skin(Document& document, const SkeletalMotion& motion) {
    std::string matrices;
    json joints = json::array();
    const auto places = rest_positions(motion);
    for (std::size_t n = 0; n < kNodeCount; ++n) {
        joints.push_back(n);
        for (int i = 0; i < 16; ++i) {
            const bool translation = i >= 12 && i < 15;
            put_float(matrices, translation ? -places[n][i - 12] : (i % 5 == 0 ? 1 : 0));
        }
    }
    const std::size_t bind = document.add(matrices, kFloat, "MAT4", kNodeCount);
    document.root()["skins"] =
        json::array({{{"joints", joints}, {"skeleton", 0}, {"inverseBindMatrices", bind}}});
}

void add_mesh(Document& document, const SkeletalMotion& motion) {
    const BoneMesh mesh = bone_mesh(motion);
    std::string positions, joints, weights, indices;
    glm::vec3 low(mesh.vertices.front().position_m), high(low);
    for (const BoneMesh::Vertex& v : mesh.vertices) {
        const glm::vec3 p(v.position_m);
        low = glm::min(low, p);
        high = glm::max(high, p);
        for (int i = 0; i < 3; ++i) put_float(positions, p[i]);
        put_u32(joints, static_cast<std::uint32_t>(v.node));
        for (int i = 0; i < 4; ++i) put_float(weights, i == 0 ? 1 : 0);
    }
    for (const std::uint16_t i : mesh.indices) {
        indices += static_cast<char>(i & 0xff);
        indices += static_cast<char>(i >> 8);
    }
    const std::size_t count = mesh.vertices.size();
    const std::size_t position = document.add(positions, kFloat, "VEC3", count, kVertices);
    document.accessor(position)["min"] = vec3_json(low);
    document.accessor(position)["max"] = vec3_json(high);
    const json attributes = {
        {"POSITION", position},
        {"JOINTS_0", document.add(joints, kByte, "VEC4", count, kVertices)},
        {"WEIGHTS_0", document.add(weights, kFloat, "VEC4", count, kVertices)}};
    const std::size_t index =
        document.add(indices, kShort, "SCALAR", mesh.indices.size(), kIndices);
    document.root()["meshes"] = json::array(
        {{{"primitives", json::array({{{"attributes", attributes}, {"indices", index}}})}}});
}

std::string rotations(const SkeletalMotion& motion, std::size_t node) {
    std::string out;
    glm::quat before(1, 0, 0, 0);
    for (const SkeletonPose& pose : motion.poses) {
        // The short way for readers that do not look for it. Settled for the rounded numbers, as
        // rounding may turn a product of 0 negative.
        glm::quat q(pose.local[node]);
        if (glm::dot(glm::dquat(q), glm::dquat(before)) < 0) q = -q;
        before = q;
        for (const float v : {q.x, q.y, q.z, q.w}) put_float(out, v);
    }
    return out;
}

/// False for the nodes whose rotation is always the identity.
bool turns(std::size_t node) {
    return node != static_cast<std::size_t>(Joint::shoulder_center) &&
           tip_m(static_cast<int>(node)) == 0;
}

void add_animation(Document& document, const SkeletalMotion& motion) {
    const std::size_t count = motion.poses.size();
    std::string times, places;
    for (std::size_t i = 0; i < count; ++i) {
        put_float(times, static_cast<double>(i) / motion.rate_hz);
        for (int a = 0; a < 3; ++a) put_float(places, motion.poses[i].root_m[a]);
    }
    const std::size_t time = document.add(times, kFloat, "SCALAR", count);
    document.accessor(time)["min"] = {0.0F};
    document.accessor(time)["max"] = {
        static_cast<float>(static_cast<double>(count - 1) / motion.rate_hz)};
    json samplers = json::array(), channels = json::array();
    const auto animate = [&](std::size_t node, const char* path, std::size_t values) {
        channels.push_back(
            {{"sampler", samplers.size()}, {"target", {{"node", node}, {"path", path}}}});
        samplers.push_back({{"input", time}, {"output", values}, {"interpolation", "LINEAR"}});
    };
    animate(0, "translation", document.add(places, kFloat, "VEC3", count));
    for (std::size_t n = 0; n < kNodeCount; ++n) {
        if (!turns(n)) continue;
        animate(n, "rotation", document.add(rotations(motion, n), kFloat, "VEC4", count));
    }
    document.root()["animations"] =
        json::array({{{"name", "motion"}, {"samplers", samplers}, {"channels", channels}}});
}

}  // namespace

std::string glb_bytes(const SkeletalMotion& motion) {
    Document document;
    add_nodes(document, motion);
    add_skin(document, motion);
    add_mesh(document, motion);
    add_animation(document, motion);
    return document.finish();
}

}  // namespace kino::motion_export
