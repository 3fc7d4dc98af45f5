#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace kino::test {

/// A small glTF made by hand: a strip of `1 + 1` quads that two joints bend, an animation, a
/// material with a PNG texture; everything in one buffer.
struct GltfSample {
    nlohmann::json json;
    std::vector<std::uint8_t> buffer;

    /// Adds a view and an accessor; returns the accessor's index.
    int add(const std::vector<float>& values, const std::string& type);
    int add(const std::vector<std::uint16_t>& values, const std::string& type);

    [[nodiscard]] std::vector<std::uint8_t> as_glb() const;
    [[nodiscard]] std::vector<std::uint8_t> as_gltf() const;  ///< the buffer as a data URI
};
[[nodiscard]] GltfSample make_gltf_sample();

[[nodiscard]] std::string base64(const std::vector<std::uint8_t>& bytes);

}  // namespace kino::test
