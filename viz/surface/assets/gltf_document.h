#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "base/error.h"
#include "viz/surface/assets/gltf_loader.h"

namespace kino {

/// A file taken apart: its JSON and the bytes that the JSON speaks of.
struct GltfDocument {
    nlohmann::json json;
    std::vector<std::vector<std::uint8_t>> buffers;
};

/// A picture named by the file, still coded.
struct GltfPicture {
    std::vector<std::uint8_t> bytes;
    std::string where;
};

/// Splits a GLB or takes plain JSON, checks nesting, parses, and gets every buffer.
[[nodiscard]] Result<GltfDocument> open_gltf(std::span<const std::uint8_t> bytes,
                                             const std::string& where, const GltfReadFile& read,
                                             const GltfLimits& limits);

/// Checks everything that will be read: types, ranges, sums against the limits, that nodes form
/// trees. Returns a JSON text that holds this and nothing else; its buffers are named "0", "1", ...
[[nodiscard]] Result<std::string> check_gltf(const GltfDocument& document, const std::string& where,
                                             const GltfLimits& limits,
                                             std::vector<std::string>& notes);

/// Bytes of image `index` of a checked document.
[[nodiscard]] Result<GltfPicture> gltf_picture(const GltfDocument& document, std::size_t index,
                                               const std::string& where, const GltfReadFile& read,
                                               const GltfLimits& limits);

/// PNG or JPEG by its first bytes; refused by its header where it is too large.
[[nodiscard]] Result<Image<Rgba8>> decode_picture(const GltfPicture& picture,
                                                  const GltfLimits& limits);

}  // namespace kino
