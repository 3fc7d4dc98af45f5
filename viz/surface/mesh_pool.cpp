#include "viz/surface/mesh_pool.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <utility>

#include "viz/surface/mesh_formats.h"
#include "viz/surface/mesh_texels.h"

namespace kino {
namespace {

constexpr std::uint64_t kVertexBytes = 32;

struct PackedWeights {
    std::array<std::uint16_t, 4> joints;
    std::array<std::uint32_t, 2> unused;
    glm::vec4 weights;
};
static_assert(sizeof(PackedWeights) == 32);

constexpr double kMostFragmentation = 0.25;
constexpr std::uint32_t kMostVertices = 1u << KINO_FIRST_VERTEX_BITS;

Result<void> check(const MeshAsset& mesh) {
    const std::size_t vertices = mesh.positions.size();
    const auto where = [&] { return "mesh '" + mesh.name + "'"; };
    if (vertices == 0 || mesh.indices.empty()) return fail("nothing to draw", where());
    if (mesh.normals.size() != vertices || (!mesh.uvs.empty() && mesh.uvs.size() != vertices)) {
        return fail("positions, normals and uvs differ in number", where());
    }
    if (mesh.joints.size() != mesh.weights.size() ||
        (mesh.skinned() && mesh.joints.size() != vertices)) {
        return fail("positions, joints and weights differ in number", where());
    }
    if (mesh.indices.size() % 3 != 0) return fail("indices are not whole triangles", where());
    if (*std::max_element(mesh.indices.begin(), mesh.indices.end()) >= vertices) {
        return fail("an index lies beyond the vertices", where());
    }
    if (vertices >= kMostVertices || mesh.indices.size() > UINT32_MAX / 2) {
        return fail("more vertices than a draw can name", where());
    }
    return {};
}

std::vector<glm::vec4> joint_spheres_of(const MeshAsset& mesh) {
    std::vector<glm::vec3> low;
    std::vector<glm::vec3> high;
    for (std::size_t v = 0; v < mesh.joints.size(); ++v) {
        const float sum =
            mesh.weights[v][0] + mesh.weights[v][1] + mesh.weights[v][2] + mesh.weights[v][3];
        for (int k = 0; k < 4; ++k) {
            // Without weights the root moves a vertex.
            const bool counts = sum > 0 ? mesh.weights[v][k] > 0 : k == 0;
            if (!counts) continue;
            const std::size_t joint = sum > 0 ? mesh.joints[v][k] : 0;
            if (joint >= low.size()) {
                low.resize(joint + 1, glm::vec3(INFINITY));
                high.resize(joint + 1, glm::vec3(-INFINITY));
            }
            low[joint] = glm::min(low[joint], mesh.positions[v]);
            high[joint] = glm::max(high[joint], mesh.positions[v]);
        }
    }
    std::vector<glm::vec4> spheres;
    for (std::size_t j = 0; j < low.size(); ++j) {
        spheres.push_back(low[j].x > high[j].x ? glm::vec4(0, 0, 0, -1)
                                               : glm::vec4((low[j] + high[j]) * 0.5f,
                                                           glm::length(high[j] - low[j]) * 0.5f));
    }
    return spheres;
}

Result<gpu::Buffer> make_pool(gpu::Device& device, const char* name, std::uint64_t units,
                              std::uint64_t unit_bytes) {
    const std::uint64_t bytes = units * unit_bytes;
    if (bytes > device.info().max_texels * sizeof(std::uint32_t)) {
        return fail(
            fmt::format("{} of {} bytes are more than the device reads at once", name, bytes),
            "meshes", "show fewer or smaller meshes");
    }
    return gpu::Buffer::create(device, name, bytes, gpu::MemoryUse::upload);
}

}  // namespace

const PooledMesh* MeshPool::find(const MeshAsset* asset) const {
    const auto found = meshes_.find(asset);
    return found == meshes_.end() ? nullptr : &found->second;
}

std::uint32_t MeshPool::texture_of(std::size_t material) const {
    return material < texture_of_material_.size() ? texture_of_material_[material] : 0;
}

std::uint64_t MeshPool::bytes() const {
    return vertices_.bytes() + indices_.bytes() + weights_.bytes() + texels_.bytes();
}

void MeshPool::write(PooledMesh& mesh) {
    const MeshAsset& asset = *mesh.asset;
    const PackedVertices packed = pack_static(asset);
    vertices_.write(std::span<const std::uint32_t>(packed.words), mesh.first_vertex * kVertexBytes);
    indices_.write(std::span<const std::uint32_t>(asset.indices),
                   std::uint64_t{mesh.first_index} * sizeof(std::uint32_t));
    if (!asset.skinned()) return;
    std::vector<PackedWeights> weights(mesh.vertices);
    for (std::size_t v = 0; v < weights.size(); ++v) {
        weights[v] = {asset.joints[v], {}, asset.weights[v]};
    }
    weights_.write(std::span<const PackedWeights>(weights),
                   std::uint64_t{mesh.first_weight} * sizeof(PackedWeights));
}

Result<void> MeshPool::place(const std::shared_ptr<const MeshAsset>& asset) {
    PooledMesh mesh{.asset = asset,
                    .vertices = static_cast<std::uint32_t>(asset->positions.size())};
    const auto indices = static_cast<std::uint32_t>(asset->indices.size());
    const auto vertex = vertex_ranges_.take(mesh.vertices);
    const auto index = index_ranges_.take(indices);
    const auto weight = asset->skinned() ? weight_ranges_.take(mesh.vertices) : std::optional(0u);
    if (!vertex || !index || !weight) {
        if (vertex) vertex_ranges_.give_back(*vertex, mesh.vertices);
        if (index) index_ranges_.give_back(*index, indices);
        if (weight && asset->skinned()) weight_ranges_.give_back(*weight, mesh.vertices);
        return fail("no room");
    }
    mesh.first_vertex = *vertex;
    mesh.first_index = *index;
    mesh.first_weight = *weight;
    if (asset->skinned()) mesh.joint_spheres = joint_spheres_of(*asset);
    write(mesh);
    meshes_.emplace(asset.get(), std::move(mesh));
    return {};
}

void MeshPool::remove(const PooledMesh& mesh) {
    vertex_ranges_.give_back(mesh.first_vertex, mesh.vertices);
    index_ranges_.give_back(mesh.first_index,
                            static_cast<std::uint32_t>(mesh.asset->indices.size()));
    if (mesh.asset->skinned()) weight_ranges_.give_back(mesh.first_weight, mesh.vertices);
}

Result<void> MeshPool::rebuild(const std::vector<std::shared_ptr<const MeshAsset>>& wanted) {
    std::uint64_t vertices = 0;
    std::uint64_t indices = 0;
    std::uint64_t weights = 0;
    std::set<const MeshAsset*> counted;
    for (const auto& asset : wanted) {
        if (!counted.insert(asset.get()).second) continue;
        vertices += asset->positions.size();
        indices += asset->indices.size();
        if (asset->skinned()) weights += asset->positions.size();
    }
    if (vertices >= kMostVertices || indices > UINT32_MAX / 2) {
        return fail(fmt::format("{} vertices in one scene", vertices), "meshes",
                    fmt::format("at most {}", kMostVertices - 1));
    }
    meshes_.clear();
    vertices_ = gpu::Buffer();
    indices_ = gpu::Buffer();
    weights_ = gpu::Buffer();
    vertex_ranges_ = MeshRanges(static_cast<std::uint32_t>(vertices));
    index_ranges_ = MeshRanges(static_cast<std::uint32_t>(indices));
    weight_ranges_ = MeshRanges(static_cast<std::uint32_t>(weights));
    if (vertices == 0) return {};
    KINO_ASSIGN(vertices_, make_pool(device_, "mesh vertices", vertices, kVertexBytes));
    KINO_ASSIGN(indices_, make_pool(device_, "mesh indices", indices, sizeof(std::uint32_t)));
    if (weights > 0) {
        KINO_ASSIGN(weights_, make_pool(device_, "mesh weights", weights, sizeof(PackedWeights)));
    }
    for (const auto& asset : wanted) {
        if (!meshes_.contains(asset.get())) KINO_TRY(place(asset));
    }
    return {};
}

Result<void> MeshPool::keep(const std::vector<std::shared_ptr<const MeshAsset>>& wanted) {
    std::set<const MeshAsset*> all;
    std::vector<std::shared_ptr<const MeshAsset>> fresh;
    for (const auto& asset : wanted) {
        if (!all.insert(asset.get()).second || meshes_.contains(asset.get())) continue;
        KINO_TRY(check(*asset));
        fresh.push_back(asset);
    }
    std::erase_if(meshes_, [&](const auto& item) {
        if (all.contains(item.first)) return false;
        remove(item.second);
        return true;
    });
    if (meshes_.empty() && fresh.empty()) return rebuild({});
    for (const auto& asset : fresh) {
        if (!place(asset)) return rebuild(wanted);
    }
    // A pool that once was large does not stay so for ever.
    const bool roomy = vertex_ranges_.used() < vertex_ranges_.capacity() / 4;
    if (roomy || (vertex_ranges_.fragmentation() > kMostFragmentation && !fresh.empty())) {
        return rebuild(wanted);
    }
    return {};
}

Result<void> MeshPool::keep_textures(const std::vector<Material>& materials) {
    std::vector<std::shared_ptr<const Image<Rgba8>>> textures;
    texture_of_material_.clear();
    for (const Material& material : materials) {
        if (material.texture == nullptr || material.texture->size() == 0) {
            texture_of_material_.push_back(0);
            continue;
        }
        auto known = std::find(textures.begin(), textures.end(), material.texture);
        if (known == textures.end()) known = textures.insert(known, material.texture);
        texture_of_material_.push_back(static_cast<std::uint32_t>(known - textures.begin()) + 1);
    }
    if (textures == textures_) return {};
    textures_ = std::move(textures);
    texels_ = gpu::Buffer();
    if (textures_.empty()) return {};
    const std::vector<std::uint32_t> words = pack_textures(textures_);
    KINO_ASSIGN(texels_, make_pool(device_, "mesh textures", words.size(), sizeof(words[0])));
    texels_.write(std::span<const std::uint32_t>(words));
    return {};
}

}  // namespace kino
