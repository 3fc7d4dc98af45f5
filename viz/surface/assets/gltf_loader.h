#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "base/error.h"
#include "viz/surface/assets/gltf_model.h"

namespace kino {

/// What a file may ask for; more is refused before memory is taken.
struct GltfLimits {
    std::size_t file_bytes = std::size_t{256} << 20;
    std::size_t vertices = std::size_t{8} << 20;  ///< of all primitives
    std::size_t indices = std::size_t{32} << 20;  ///< of all primitives
    std::size_t keys = std::size_t{8} << 20;      ///< of all animation channels
    std::size_t items = 65536;                    ///< nodes, accessors, ... of each kind
    std::size_t nesting = 64;                     ///< of the JSON text
    int texture_px = 4096;                        ///< width and height
    std::size_t texels = std::size_t{64} << 20;   ///< of all textures
};

/// Reads .gltf (with buffers and pictures beside it or inside) and .glb. The file is checked here,
/// and only what was found sound is handed to tinygltf; files are read from its own folder only.
/// Not read, and told in the notes: lines and points, morph targets, cameras, extensions that the
/// file can do without.
[[nodiscard]] Result<GltfModel> load_gltf(const std::filesystem::path& path,
                                          const GltfLimits& limits = {});

/// The same from memory; `read` gives the bytes of a file named relative to it.
using GltfReadFile =
    std::function<Result<std::vector<std::uint8_t>>(const std::string& name, std::size_t limit)>;
[[nodiscard]] Result<GltfModel> parse_gltf(std::span<const std::uint8_t> bytes,
                                           const std::string& where, const GltfReadFile& read,
                                           const GltfLimits& limits = {});

}  // namespace kino
