#pragma once

#include <glm/gtc/quaternion.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace kino::test {

/// A slow reader of binary glTF after its specification; shares nothing with the writer but the
/// JSON library. Throws std::exception's kin on anything the specification forbids that it looks
/// at: chunk sizes, alignment, accessors outside their views, wrong min and max.
struct GlbFile {
    nlohmann::json json;
    std::string bin;

    /// Components of an accessor as doubles, element after element.
    [[nodiscard]] std::vector<double> values(std::size_t accessor) const;
    /// Key times of the first animation.
    [[nodiscard]] std::vector<double> times() const;
    /// Global transforms of all nodes at a key of the first animation.
    [[nodiscard]] std::vector<glm::dmat4> nodes_at(std::size_t key) const;
    [[nodiscard]] std::map<std::string, glm::dvec3> positions(std::size_t key) const;
    /// The mesh's vertices skinned at a key.
    [[nodiscard]] std::vector<glm::dvec3> skinned(std::size_t key) const;
    /// One node's rotations over all keys; empty if it isn't animated.
    [[nodiscard]] std::vector<glm::dquat> rotations(std::size_t node) const;
};

[[nodiscard]] GlbFile read_glb(const std::string& bytes);

}  // namespace kino::test
