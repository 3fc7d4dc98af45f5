#pragma once

#include <glm/vec3.hpp>
#include <map>
#include <string>
#include <vector>

namespace kino::test {

/// A slow, obvious reader of BVH files that shares nothing with the writer: any channel order,
/// positions on any joint. Throws std::runtime_error on what it doesn't understand.
struct BvhJoint {
    std::string name;
    int parent = -1;
    glm::dvec3 offset{0};
    std::vector<std::string> channels;
    bool end_site = false;
};

struct BvhFile {
    std::vector<BvhJoint> joints;  ///< in the file's order
    double frame_time_s = 0;
    std::vector<std::vector<double>> frames;  ///< channels as written

    /// World place of each joint by its name, in the file's units.
    [[nodiscard]] std::map<std::string, glm::dvec3> positions(std::size_t frame) const;
};

[[nodiscard]] BvhFile read_bvh(const std::string& text);

}  // namespace kino::test
