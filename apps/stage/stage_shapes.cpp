#include "apps/stage/stage_shapes.h"

#include <fmt/format.h>

#include <array>
#include <glm/geometric.hpp>
#include <utility>

#include "base/check.h"
#include "viz/surface/mesh_shapes.h"

namespace kino {
namespace {

using Part = std::shared_ptr<const MeshAsset>;

/// Several bodies as one, each scaled and then moved.
class Assembly {
  public:
    void add(const Part& part, const glm::vec3& at_m, const glm::vec3& scale = glm::vec3(1)) {
        const auto first = static_cast<std::uint32_t>(mesh_.positions.size());
        for (std::size_t i = 0; i < part->positions.size(); ++i) {
            mesh_.positions.push_back(at_m + scale * part->positions[i]);
            mesh_.normals.push_back(glm::normalize(part->normals[i] / scale));
            mesh_.uvs.push_back(part->uvs.empty() ? glm::vec2(0) : part->uvs[i]);
        }
        for (const std::uint32_t index : part->indices) mesh_.indices.push_back(first + index);
    }
    /// Seen from within instead.
    void turn_inside_out() {
        for (glm::vec3& normal : mesh_.normals) normal = -normal;
        for (std::size_t i = 0; i + 2 < mesh_.indices.size(); i += 3) {
            std::swap(mesh_.indices[i + 1], mesh_.indices[i + 2]);
        }
    }
    Part finish(const char* name, const glm::vec3& scale = glm::vec3(1)) {
        for (glm::vec3& position : mesh_.positions) position *= scale;
        for (glm::vec3& normal : mesh_.normals) normal = glm::normalize(normal / scale);
        mesh_.name = name;
        set_bounding_sphere(mesh_);
        KINO_CHECK(broken_invariant(mesh_).empty());
        return std::make_shared<const MeshAsset>(std::move(mesh_));
    }

  private:
    MeshAsset mesh_;
};

Part column(const glm::vec3& size) {
    const float wide = 1.3f;  // of plinth and capital, in diameters
    const float low = std::min(0.12f * size.y, 0.25f * size.x);
    const float shaft = size.y - 2 * low;
    Assembly assembly;
    const Part slab = make_box({wide * size.x, low, wide * size.z});
    assembly.add(slab, {0, 0.5f * low, 0});
    assembly.add(make_cylinder(0.5f, 1, 20), {0, low + 0.5f * shaft, 0}, {size.x, shaft, size.z});
    assembly.add(slab, {0, size.y - 0.5f * low, 0});
    return assembly.finish("column");
}

/// A side chair of 0.44 x 0.90 x 0.46 m with legs of 24 mm, brought to the size wanted.
Part chair(const glm::vec3& size) {
    constexpr float kLeg = 0.012f, kSeat = 0.45f;
    Assembly assembly;
    const Part front_leg = make_cylinder(kLeg, kSeat, 8);
    const Part back_leg = make_cylinder(kLeg, 0.9f, 8);
    for (const float x : {-0.2f, 0.2f}) {
        assembly.add(front_leg, {x, 0.5f * kSeat, 0.205f});
        assembly.add(back_leg, {x, 0.45f, -0.205f});
        assembly.add(make_box({0.014f, 0.014f, 0.41f}), {x, 0.2f, 0});
    }
    assembly.add(make_box({0.44f, 0.024f, 0.46f}), {0, kSeat, 0});
    for (const float y : {0.62f, 0.74f, 0.86f}) {
        assembly.add(make_box({0.4f, 0.05f, 0.012f}), {0, y, -0.205f});
    }
    return assembly.finish("chair", size / glm::vec3(0.44f, 0.9f, 0.46f));
}

Part room(const glm::vec3& size) {
    Assembly assembly;
    assembly.add(make_box(size), {0, 0.5f * size.y, 0});
    assembly.turn_inside_out();
    return assembly.finish("room");
}

Part scaled(const Part& part, const char* name, const glm::vec3& size) {
    Assembly assembly;
    assembly.add(part, glm::vec3(0));
    return assembly.finish(name, size);
}

}  // namespace

std::shared_ptr<const MeshAsset> make_stage_shape(SceneShape shape, const glm::dvec3& size_m) {
    const glm::vec3 size(size_m);
    switch (shape) {
        case SceneShape::box:
            return make_box(size);
        case SceneShape::sphere:
            return scaled(make_sphere(0.5f, 28, 14), "sphere", size);
        case SceneShape::cylinder:
            return scaled(make_cylinder(0.5f, 1, 24), "cylinder", size);
        case SceneShape::plane:
            return make_grid(size.x, size.z);
        case SceneShape::room:
            return room(size);
        case SceneShape::column:
            return column(size);
        case SceneShape::chair:
            return chair(size);
        case SceneShape::gltf:
            break;
    }
    KINO_CHECK(false);
    return nullptr;
}

std::shared_ptr<const MeshAsset> make_bead() {
    return make_sphere(0.5f, 6, 4);
}

std::shared_ptr<const MeshAsset> make_spark() {
    return make_sphere(0.5f, 4, 2);
}

std::shared_ptr<const MeshAsset> make_stroke() {
    return make_cylinder(0.5f, 1, 5);
}

}  // namespace kino
