#include "viz/surface/assets/gltf_mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "viz/surface/mesh_shapes.h"

namespace kino {
namespace {

constexpr int kAnyMode = -1;

Result<GltfNumbers> attribute(const tinygltf::Model& model, const tinygltf::Primitive& primitive,
                              const char* name, std::size_t parts, const std::string& where) {
    const GltfNumbers numbers(model, primitive.attributes.at(name));
    if (numbers.parts() != parts) return fail(fmt::format("{} has other parts", name), where);
    return numbers;
}

/// Vertex numbers of every triangle, three each, from lists, strips and fans.
Result<std::vector<std::uint32_t>> corners_of(const tinygltf::Model& model,
                                              const tinygltf::Primitive& primitive,
                                              std::size_t vertices, const std::string& where) {
    std::vector<std::uint32_t> named;
    if (primitive.indices >= 0) {
        const GltfNumbers numbers(model, primitive.indices);
        if (numbers.parts() != 1 || !numbers.is_unsigned()) {
            return fail("indices are not whole numbers", where);
        }
        named.resize(numbers.count());
        for (std::size_t i = 0; i < named.size(); ++i) {
            named[i] = numbers.whole(i);
            if (named[i] >= vertices) return fail("an index lies beyond the vertices", where);
        }
    } else {
        named.resize(vertices);
        for (std::size_t i = 0; i < vertices; ++i) named[i] = static_cast<std::uint32_t>(i);
    }
    if (primitive.mode == TINYGLTF_MODE_TRIANGLES || primitive.mode == kAnyMode) {
        named.resize(named.size() / 3 * 3);
        return named;
    }
    std::vector<std::uint32_t> corners;
    const bool strip = primitive.mode == TINYGLTF_MODE_TRIANGLE_STRIP;
    for (std::size_t i = 2; i < named.size(); ++i) {
        const std::uint32_t a = strip ? named[i - 2] : named[0];
        const std::uint32_t b = named[i - 1];
        const std::uint32_t c = named[i];
        if (a == b || b == c || c == a) continue;
        // Every other triangle of a strip runs the other way.
        const bool turned = strip && i % 2 == 1;
        corners.insert(corners.end(), {a, turned ? c : b, turned ? b : c});
    }
    return corners;
}

void read_weights(const tinygltf::Primitive& primitive, const tinygltf::Model& model,
                  const GltfMeshOptions& options, MeshAsset& mesh,
                  std::vector<std::string>& notes) {
    std::vector<GltfNumbers> joints;
    std::vector<GltfNumbers> weights;
    for (const char* set : {"0", "1"}) {
        if (!primitive.attributes.contains(fmt::format("JOINTS_{}", set))) continue;
        joints.emplace_back(model, primitive.attributes.at(fmt::format("JOINTS_{}", set)));
        weights.emplace_back(model, primitive.attributes.at(fmt::format("WEIGHTS_{}", set)));
        if (joints.back().parts() != 4 || weights.back().parts() != 4 ||
            !joints.back().is_unsigned()) {
            joints.pop_back();
            weights.pop_back();
            notes.push_back(fmt::format("{}: a set of joints is not read", options.where));
        }
    }
    if (joints.empty()) return;
    struct Pull {
        double weight = 0;
        std::uint32_t joint = 0;
    };
    std::size_t dropped = 0;
    std::size_t rootless = 0;
    std::size_t strangers = 0;
    for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
        std::array<Pull, 8> pulls{};
        std::size_t used = 0;
        for (std::size_t set = 0; set < joints.size(); ++set) {
            for (std::size_t k = 0; k < 4; ++k) {
                const double weight = weights[set].at(v, k);
                const std::uint32_t joint = joints[set].whole(v, k);
                // Also what is not a number.
                if (!(weight > 0) || !(weight < 1e6)) continue;
                if (joint >= options.joint_order.size()) {
                    ++strangers;
                    continue;
                }
                pulls[used++] = {weight, options.joint_order[joint]};
            }
        }
        // Equal weights keep the file's order, so that reading twice gives the same mesh.
        std::stable_sort(pulls.begin(), pulls.begin() + static_cast<std::ptrdiff_t>(used),
                         [](const Pull& a, const Pull& b) { return a.weight > b.weight; });
        dropped += used > 4;
        used = std::min<std::size_t>(used, 4);
        double sum = 0;
        for (std::size_t k = 0; k < used; ++k) sum += pulls[k].weight;
        std::array<std::uint16_t, 4> numbers{};
        glm::vec4 shares(0);
        if (!(sum > 0)) {
            ++rootless;
            shares[0] = 1;
        }
        for (std::size_t k = 0; sum > 0 && k < used; ++k) {
            numbers[k] = static_cast<std::uint16_t>(pulls[k].joint);
            shares[static_cast<int>(k)] = static_cast<float>(pulls[k].weight / sum);
        }
        mesh.joints.push_back(numbers);
        mesh.weights.push_back(shares);
    }
    if (dropped > 0) {
        notes.push_back(
            fmt::format("{}: {} vertices hang on more than four joints; the strongest "
                        "four are kept",
                        options.where, dropped));
    }
    if (rootless > 0) {
        notes.push_back(fmt::format("{}: {} vertices hang on no joint; they follow the root",
                                    options.where, rootless));
    }
    if (strangers > 0) {
        notes.push_back(fmt::format("{}: {} weights name joints that the skin does not have",
                                    options.where, strangers));
    }
}

/// Every triangle gets corners of its own, with its own normal.
void make_flat(MeshAsset& mesh) {
    MeshAsset flat;
    flat.name = mesh.name;
    for (std::size_t t = 0; t + 2 < mesh.indices.size(); t += 3) {
        const glm::dvec3 a = mesh.positions[mesh.indices[t]];
        const glm::dvec3 n = glm::cross(glm::dvec3(mesh.positions[mesh.indices[t + 1]]) - a,
                                        glm::dvec3(mesh.positions[mesh.indices[t + 2]]) - a);
        const double length = glm::length(n);
        const glm::vec3 normal =
            length > 0 && std::isfinite(length) ? glm::vec3(n / length) : glm::vec3(0, 1, 0);
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t v = mesh.indices[t + k];
            flat.indices.push_back(static_cast<std::uint32_t>(flat.positions.size()));
            flat.positions.push_back(mesh.positions[v]);
            flat.normals.push_back(normal);
            if (!mesh.uvs.empty()) flat.uvs.push_back(mesh.uvs[v]);
            if (mesh.skinned()) {
                flat.joints.push_back(mesh.joints[v]);
                flat.weights.push_back(mesh.weights[v]);
            }
        }
    }
    mesh = std::move(flat);
}

}  // namespace

Result<std::optional<MeshAsset>> read_primitive(const tinygltf::Model& model,
                                                const tinygltf::Primitive& primitive,
                                                const GltfMeshOptions& options,
                                                std::vector<std::string>& notes) {
    const bool triangles =
        primitive.mode == kAnyMode ||
        (primitive.mode >= TINYGLTF_MODE_TRIANGLES && primitive.mode <= TINYGLTF_MODE_TRIANGLE_FAN);
    if (!triangles) {
        notes.push_back(fmt::format("{}: points and lines are not drawn", options.where));
        return std::optional<MeshAsset>();
    }
    MeshAsset mesh;
    mesh.name = options.name;
    KINO_ASSIGN(const GltfNumbers positions,
                attribute(model, primitive, "POSITION", 3, options.where));
    for (std::size_t v = 0; v < positions.count(); ++v) {
        const glm::vec3 p(positions.at(v, 0), positions.at(v, 1), positions.at(v, 2));
        // Squares of larger ones would not fit a float.
        if (!(glm::dot(p, p) < 1e30f)) return fail("a position is not a number", options.where);
        mesh.positions.push_back(p);
    }
    KINO_ASSIGN(mesh.indices, corners_of(model, primitive, mesh.positions.size(), options.where));
    if (mesh.indices.empty()) {
        notes.push_back(fmt::format("{}: no triangles", options.where));
        return std::optional<MeshAsset>();
    }
    if (primitive.attributes.contains("TEXCOORD_0")) {
        KINO_ASSIGN(const GltfNumbers uvs,
                    attribute(model, primitive, "TEXCOORD_0", 2, options.where));
        for (std::size_t v = 0; v < uvs.count(); ++v) {
            const glm::vec2 uv(uvs.at(v, 0), uvs.at(v, 1));
            const bool sound = std::abs(uv.x) < 1e6f && std::abs(uv.y) < 1e6f;
            mesh.uvs.push_back(sound ? uv : glm::vec2(0));
        }
    }
    if (!options.joint_order.empty()) read_weights(primitive, model, options, mesh, notes);
    if (!primitive.attributes.contains("NORMAL")) {
        make_flat(mesh);
    } else {
        KINO_ASSIGN(const GltfNumbers normals,
                    attribute(model, primitive, "NORMAL", 3, options.where));
        std::size_t mended = 0;
        for (std::size_t v = 0; v < normals.count(); ++v) {
            const glm::dvec3 n(normals.at(v, 0), normals.at(v, 1), normals.at(v, 2));
            const double length = glm::length(n);
            const bool sound = length > 1e-6 && length < 1e6;
            mended += !sound;
            mesh.normals.emplace_back(sound ? n / length : glm::dvec3(0, 1, 0));
        }
        if (mended > 0) {
            notes.push_back(
                fmt::format("{}: {} normals without a direction point up", options.where, mended));
        }
    }
    set_bounding_sphere(mesh);
    if (const std::string broken = broken_invariant(mesh); !broken.empty()) {
        return fail(broken, options.where);
    }
    return std::optional<MeshAsset>(std::move(mesh));
}

}  // namespace kino
