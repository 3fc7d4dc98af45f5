#include "viz/surface/assets/gltf_loader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/type_ptr.hpp>
#include <map>
#include <numeric>
#include <utility>

#include "sensor/file_bytes.h"
#include "viz/surface/assets/gltf_document.h"
#include "viz/surface/assets/gltf_mesh.h"

namespace kino {
namespace {

/// tinygltf asks for "0", "1", ...: the buffers that open_gltf() has already.
bool read_known_buffer(std::vector<unsigned char>* out, std::string* error, const std::string& name,
                       void* user) {
    const auto& buffers = *static_cast<const std::vector<std::vector<std::uint8_t>>*>(user);
    const std::string number = name.substr(name.find_last_of('/') + 1);
    for (std::size_t i = 0; i < buffers.size(); ++i) {
        if (number != std::to_string(i)) continue;
        *out = buffers[i];
        return true;
    }
    *error += "no such buffer";
    return false;
}

Result<tinygltf::Model> run_tinygltf(const std::string& text, GltfDocument& document,
                                     const std::string& where) {
    tinygltf::TinyGLTF reader;
    reader.SetFsCallbacks(
        {.FileExists = [](const std::string&, void*) { return true; },
         .ExpandFilePath = [](const std::string& p, void*) { return p; },
         .ReadWholeFile = &read_known_buffer,
         .WriteWholeFile = [](std::string*, const std::string&, const std::vector<unsigned char>&,
                              void*) { return false; },
         .user_data = &document.buffers});
    tinygltf::Model model;
    std::string error;
    std::string warning;
    if (!reader.LoadASCIIFromString(&model, &error, &warning, text.data(),
                                    static_cast<unsigned>(text.size()), "")) {
        std::replace(error.begin(), error.end(), '\n', ' ');
        return fail("tinygltf refuses the file: " + error, where);
    }
    return model;
}

/// Turns a checked tinygltf model into ours.
class GltfBuilder {
  public:
    GltfBuilder(const tinygltf::Model& in, const GltfDocument& document, std::string where,
                const GltfReadFile& read, const GltfLimits& limits, GltfModel& out)
        : in_(in),
          document_(document),
          where_(std::move(where)),
          read_(read),
          limits_(limits),
          out_(out) {}

    Result<void> run() {
        order_nodes();
        read_nodes();
        KINO_TRY(read_skins());
        KINO_TRY(read_materials());
        KINO_TRY(read_meshes());
        KINO_TRY(read_animations());
        return {};
    }

  private:
    [[nodiscard]] std::string at(const char* list, std::size_t i) const {
        return fmt::format("{}#/{}/{}", where_, list, i);
    }

    /// Parents first; new_of_[file's number] = ours.
    void order_nodes() {
        const std::size_t total = in_.nodes.size();
        std::vector<int> parents(total, -1);
        for (std::size_t i = 0; i < total; ++i) {
            for (const int child : in_.nodes[i].children) {
                parents[static_cast<std::size_t>(child)] = static_cast<int>(i);
            }
        }
        new_of_.assign(total, -1);
        std::vector<int> waiting;
        for (std::size_t i = total; i-- > 0;) {
            if (parents[i] < 0) waiting.push_back(static_cast<int>(i));
        }
        while (!waiting.empty()) {
            const int node = waiting.back();
            waiting.pop_back();
            const auto n = static_cast<std::size_t>(node);
            new_of_[n] = static_cast<int>(old_of_.size());
            old_of_.push_back(node);
            GltfNode made;
            made.parent = parents[n] < 0 ? -1 : new_of_[static_cast<std::size_t>(parents[n])];
            out_.nodes.push_back(std::move(made));
            const auto& children = in_.nodes[n].children;
            waiting.insert(waiting.end(), children.rbegin(), children.rend());
        }
    }

    void read_nodes() {
        for (std::size_t i = 0; i < out_.nodes.size(); ++i) {
            const tinygltf::Node& from = in_.nodes[static_cast<std::size_t>(old_of_[i])];
            GltfNode& node = out_.nodes[i];
            node.name = from.name;
            node.skin = from.skin;
            if (from.matrix.size() == 16) node.matrix = glm::make_mat4(from.matrix.data());
            if (from.translation.size() == 3) {
                node.place.translation = glm::make_vec3(from.translation.data());
            }
            if (from.scale.size() == 3) node.place.scale = glm::make_vec3(from.scale.data());
            if (from.rotation.size() == 4) {
                const glm::dquat q(from.rotation[3], from.rotation[0], from.rotation[1],
                                   from.rotation[2]);
                const double length = glm::length(q);
                if (length > 0) node.place.rotation = q * (1 / length);
            }
        }
    }

    Result<void> read_skins() {
        const std::vector<glm::dmat4> rest = model_from_nodes(out_, nullptr, 0);
        for (std::size_t s = 0; s < in_.skins.size(); ++s) {
            const tinygltf::Skin& from = in_.skins[s];
            std::vector<std::size_t> order(from.joints.size());
            std::iota(order.begin(), order.end(), std::size_t{0});
            const auto node_of = [&](std::size_t joint) {
                return new_of_[static_cast<std::size_t>(from.joints[joint])];
            };
            // Nodes have their parents before them, and so have joints in the nodes' order.
            std::sort(order.begin(), order.end(),
                      [&](std::size_t a, std::size_t b) { return node_of(a) < node_of(b); });
            std::vector<std::uint16_t>& order_of = joint_orders_.emplace_back(order.size());
            std::map<int, int> joint_of_node;
            GltfSkin skin;
            for (std::size_t j = 0; j < order.size(); ++j) {
                order_of[order[j]] = static_cast<std::uint16_t>(j);
                const int node = node_of(order[j]);
                joint_of_node[node] = static_cast<int>(j);
                MeshJoint joint;
                joint.name = out_.nodes[static_cast<std::size_t>(node)].name;
                int above = out_.nodes[static_cast<std::size_t>(node)].parent;
                while (above >= 0 && !joint_of_node.contains(above)) {
                    above = out_.nodes[static_cast<std::size_t>(above)].parent;
                }
                const glm::dmat4& own = rest[static_cast<std::size_t>(node)];
                joint.parent = above < 0 ? -1 : joint_of_node[above];
                joint.parent_from_joint =
                    above < 0 ? own : glm::inverse(rest[static_cast<std::size_t>(above)]) * own;
                if (from.inverseBindMatrices >= 0) {
                    const GltfNumbers numbers(in_, from.inverseBindMatrices);
                    for (int k = 0; k < 16; ++k) {
                        const double v = numbers.at(order[j], static_cast<std::size_t>(k));
                        if (!(std::abs(v) < 1e15)) {
                            return fail("a matrix of a joint is not finite", at("skins", s));
                        }
                        joint.joint_from_bind[k / 4][k % 4] = static_cast<float>(v);
                    }
                }
                skin.joints.push_back(std::move(joint));
                skin.nodes.push_back(node);
            }
            out_.skins.push_back(std::move(skin));
        }
        return {};
    }

    Result<std::shared_ptr<const Image<Rgba8>>> texture(int number) {
        const int source = in_.textures.at(static_cast<std::size_t>(number)).source;
        if (source < 0) {
            out_.notes.push_back("a texture of a kind that is not read is left out");
            return std::shared_ptr<const Image<Rgba8>>();
        }
        if (const auto known = pictures_.find(source); known != pictures_.end()) {
            return known->second;
        }
        KINO_ASSIGN(
            const GltfPicture picture,
            gltf_picture(document_, static_cast<std::size_t>(source), where_, read_, limits_));
        KINO_ASSIGN(Image<Rgba8> image, decode_picture(picture, limits_));
        texels_ += image.size();
        if (texels_ > limits_.texels) return fail("the textures are too large", where_);
        return pictures_[source] = std::make_shared<const Image<Rgba8>>(std::move(image));
    }

    Result<void> read_materials() {
        for (const tinygltf::Material& from : in_.materials) {
            const tinygltf::PbrMetallicRoughness& pbr = from.pbrMetallicRoughness;
            Material material;
            material.name = from.name;
            const auto unit = [](double v) { return static_cast<float>(std::clamp(v, 0.0, 1.0)); };
            material.base_color = {unit(pbr.baseColorFactor[0]), unit(pbr.baseColorFactor[1]),
                                   unit(pbr.baseColorFactor[2])};
            if (from.alphaMode == "BLEND") material.opacity = unit(pbr.baseColorFactor[3]);
            for (int c = 0; c < 3 && from.emissiveFactor.size() == 3; ++c) {
                material.emission[c] = unit(from.emissiveFactor[static_cast<std::size_t>(c)]);
            }
            // glTF 2.0, appendix B.2: a coat that reflects 4 % over a body that scatters, or bare
            // metal; in between, shares of both.
            const float metal = unit(pbr.metallicFactor);
            const glm::vec3 reflected = glm::mix(glm::vec3(0.04f), material.base_color, metal);
            MaterialLayer coat;
            coat.lobes = {{.kind = LobeKind::ggx,
                           .color = reflected,
                           .roughness = std::max(unit(pbr.roughnessFactor), 0.05f)}};
            coat.transmission = glm::vec3((1 - metal) * 0.96f);
            material.layers = {coat};
            if (metal < 1) material.layers.push_back({.lobes = {{.kind = LobeKind::lambert}}});
            if (pbr.baseColorTexture.index >= 0) {
                KINO_ASSIGN(material.texture, texture(pbr.baseColorTexture.index));
            }
            out_.materials.push_back(std::move(material));
        }
        return {};
    }

    /// Nodes of the scene that the file shows first; all of them where it names none.
    [[nodiscard]] std::vector<char> shown() const {
        std::vector<char> seen(out_.nodes.size(), in_.scenes.empty() ? 1 : 0);
        if (in_.scenes.empty()) return seen;
        const auto scene = static_cast<std::size_t>(std::max(in_.defaultScene, 0));
        for (const int root : in_.scenes.at(scene).nodes) {
            seen[static_cast<std::size_t>(new_of_[static_cast<std::size_t>(root)])] = 1;
        }
        for (std::size_t i = 0; i < seen.size(); ++i) {
            const int parent = out_.nodes[i].parent;
            if (parent >= 0 && seen[static_cast<std::size_t>(parent)] != 0) seen[i] = 1;
        }
        return seen;
    }

    Result<void> read_meshes() {
        const std::vector<char> seen = shown();
        std::map<std::pair<int, int>, std::vector<int>> made;  // of a mesh with a skin
        std::size_t vertices_read = 0;
        std::size_t primitives = 0;
        std::size_t vertices = 0;
        std::size_t corners = 0;
        for (std::size_t i = 0; i < out_.nodes.size(); ++i) {
            const tinygltf::Node& from = in_.nodes[static_cast<std::size_t>(old_of_[i])];
            if (from.mesh < 0 || seen[i] == 0) continue;
            const std::pair key(from.mesh, from.skin);
            auto known = made.find(key);
            if (known == made.end()) {
                known = made.emplace(key, std::vector<int>()).first;
                const auto m = static_cast<std::size_t>(from.mesh);
                for (std::size_t p = 0; p < in_.meshes[m].primitives.size(); ++p) {
                    const tinygltf::Primitive& primitive = in_.meshes[m].primitives[p];
                    GltfMeshOptions options{
                        .name = in_.meshes[m].name,
                        .where = fmt::format("{}/primitives/{}", at("meshes", m), p),
                        .joint_order = {}};
                    if (from.skin >= 0) {
                        options.joint_order = joint_orders_[static_cast<std::size_t>(from.skin)];
                    }
                    // One mesh with many skins is read, and kept, many times.
                    const int positions = primitive.attributes.at("POSITION");
                    vertices_read += in_.accessors.at(static_cast<std::size_t>(positions)).count;
                    if (vertices_read > limits_.vertices || ++primitives > limits_.items) {
                        return fail("too many vertices or primitives", where_);
                    }
                    KINO_ASSIGN(auto mesh, read_primitive(in_, primitive, options, out_.notes));
                    if (!mesh) continue;
                    vertices += mesh->positions.size();
                    corners += mesh->indices.size();
                    if (vertices > limits_.vertices || corners > limits_.indices) {
                        return fail("too many vertices or corners", where_);
                    }
                    known->second.push_back(static_cast<int>(out_.meshes.size()));
                    out_.meshes.push_back(
                        {std::make_shared<const MeshAsset>(std::move(*mesh)), primitive.material});
                }
            }
            out_.nodes[i].meshes = known->second;
        }
        return {};
    }

    Result<void> read_animations() {
        for (std::size_t a = 0; a < in_.animations.size(); ++a) {
            const tinygltf::Animation& from = in_.animations[a];
            GltfAnimation animation;
            animation.name = from.name;
            for (const tinygltf::AnimationChannel& channel : from.channels) {
                GltfChannel made;
                made.node = new_of_[static_cast<std::size_t>(channel.target_node)];
                if (channel.target_path == "rotation") {
                    made.path = GltfPath::rotation;
                } else if (channel.target_path == "scale") {
                    made.path = GltfPath::scale;
                } else if (channel.target_path != "translation") {
                    continue;
                }
                KINO_TRY(read_keys(from.samplers.at(static_cast<std::size_t>(channel.sampler)),
                                   at("animations", a), made));
                animation.duration_s = std::max(animation.duration_s, made.times_s.back());
                animation.channels.push_back(std::move(made));
            }
            out_.animations.push_back(std::move(animation));
        }
        return {};
    }

    Result<void> read_keys(const tinygltf::AnimationSampler& sampler, const std::string& place,
                           GltfChannel& made) {
        if (sampler.interpolation == "STEP") made.interpolation = GltfInterpolation::step;
        if (sampler.interpolation == "CUBICSPLINE") made.interpolation = GltfInterpolation::cubic;
        const std::size_t a_key = made.interpolation == GltfInterpolation::cubic ? 3 : 1;
        const GltfNumbers times(in_, sampler.input);
        const GltfNumbers values(in_, sampler.output);
        const std::size_t parts = made.path == GltfPath::rotation ? 4 : 3;
        if (times.parts() != 1 || !times.is_float() || values.parts() != parts ||
            values.count() / a_key < times.count()) {
            return fail("keys of an animation do not fit together", place);
        }
        for (std::size_t key = 0; key < times.count(); ++key) {
            const double time = times.at(key, 0);
            if (!(time >= 0) || !(time < 1e6)) {
                return fail("the time of a key is not sound", place);
            }
            // A key that does not come after the last one has no say.
            if (!made.times_s.empty() && time <= made.times_s.back()) continue;
            made.times_s.push_back(time);
            for (std::size_t k = key * a_key; k < (key + 1) * a_key; ++k) {
                glm::dvec4 value(0);
                for (std::size_t part = 0; part < parts; ++part) {
                    value[static_cast<int>(part)] = values.at(k, part);
                    if (!(std::abs(values.at(k, part)) < 1e9)) {
                        return fail("the value of a key is not a number", place);
                    }
                }
                made.values.push_back(value);
            }
        }
        return {};
    }

    const tinygltf::Model& in_;
    const GltfDocument& document_;
    std::string where_;
    const GltfReadFile& read_;
    const GltfLimits& limits_;
    GltfModel& out_;
    std::vector<int> new_of_;
    std::vector<int> old_of_;
    std::vector<std::vector<std::uint16_t>> joint_orders_;
    std::map<int, std::shared_ptr<const Image<Rgba8>>> pictures_;
    std::size_t texels_ = 0;
};

}  // namespace

Result<GltfModel> parse_gltf(std::span<const std::uint8_t> bytes, const std::string& where,
                             const GltfReadFile& read, const GltfLimits& limits) {
    KINO_ASSIGN(GltfDocument document, open_gltf(bytes, where, read, limits));
    GltfModel model;
    KINO_ASSIGN(const std::string checked, check_gltf(document, where, limits, model.notes));
    KINO_ASSIGN(const tinygltf::Model read_by_tinygltf, run_tinygltf(checked, document, where));
    KINO_TRY(GltfBuilder(read_by_tinygltf, document, where, read, limits, model).run());
    return model;
}

Result<GltfModel> load_gltf(const std::filesystem::path& path, const GltfLimits& limits) {
    KINO_ASSIGN(const std::vector<std::uint8_t> bytes, read_file_bytes(path, limits.file_bytes));
    const std::filesystem::path folder = path.parent_path();
    return parse_gltf(
        bytes, path.string(),
        [&](const std::string& name, std::size_t limit) -> Result<std::vector<std::uint8_t>> {
            KINO_ASSIGN(const std::filesystem::path file,
                        path_inside(folder.empty() ? "." : folder, name));
            return read_file_bytes(file, limit);
        },
        limits);
}

}  // namespace kino
