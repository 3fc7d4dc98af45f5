#pragma once

#include <cmath>
#include <cstdint>
#include <span>

#include "base/check.h"
#include "viz/surface/assets/gltf_loader.h"
#include "viz/surface/mesh_shapes.h"

/// What the reader of glTF promises for any bytes at all: no crash, and whatever it accepts is
/// sound. Shared by the libFuzzer driver beside this file and by gltf_mutation_test.cpp.
namespace kino::fuzz {

inline bool gltf(std::span<const std::uint8_t> bytes) {
    GltfLimits limits;
    limits.file_bytes = 4 << 20;
    limits.vertices = limits.indices = limits.keys = 1 << 18;
    limits.items = 4096;
    limits.texture_px = 512;
    limits.texels = 1 << 20;
    const auto no_files = [](const std::string& name, std::size_t) {
        KINO_CHECK(name.find("..") == std::string::npos || name.find("../") == std::string::npos);
        KINO_CHECK(!name.starts_with("/"));
        return Result<std::vector<std::uint8_t>>(fail("no such file", name));
    };
    const auto model = parse_gltf(bytes, "fuzz", no_files, limits);
    if (!model) {
        KINO_CHECK(!model.error().what.empty());
        return false;
    }
    for (const GltfMesh& mesh : model->meshes) {
        KINO_CHECK(broken_invariant(*mesh.asset).empty());
        KINO_CHECK(mesh.material < static_cast<int>(model->materials.size()));
    }
    for (std::size_t i = 0; i < model->nodes.size(); ++i) {
        const GltfNode& node = model->nodes[i];
        KINO_CHECK(node.parent < static_cast<int>(i));
        KINO_CHECK(node.skin < static_cast<int>(model->skins.size()));
        for (const int mesh : node.meshes) {
            KINO_CHECK(mesh >= 0 && mesh < static_cast<int>(model->meshes.size()));
        }
    }
    for (const GltfSkin& skin : model->skins) {
        for (std::size_t j = 0; j < skin.joints.size(); ++j) {
            KINO_CHECK(skin.joints[j].parent < static_cast<int>(j));
        }
    }
    for (const GltfAnimation& animation : model->animations) {
        for (const double t : {-1.0, 0.0, 0.3 * animation.duration_s, 1e9}) {
            (void)model_from_nodes(*model, &animation, t);
        }
    }
    for (int a = -1; a < std::min(static_cast<int>(model->animations.size()), 2); ++a) {
        for (const MeshNode& node : mesh_nodes(*model, {.animation = a, .time_s = 0.5})) {
            if (!node.mesh->skinned() || !node.pose) continue;
            for (const auto& joints : node.mesh->joints) {
                for (const std::uint16_t joint : joints) KINO_CHECK_LT(joint, node.pose->size());
            }
        }
    }
    return true;
}

}  // namespace kino::fuzz
