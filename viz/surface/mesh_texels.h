#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "base/image.h"

namespace kino {

/// Words at the front of packed textures that describe one of them: width, height, levels, unused,
/// then the first texel of each level.
constexpr std::size_t kTextureHeadWords = 16;
constexpr std::size_t kMostTextureLevels = 12;

/// All textures in one list of words for a texel buffer: heads, then the texels of every level,
/// sRGB RGBA8. Each level has half the size of the one before, its texels averaged in linear light.
[[nodiscard]] std::vector<std::uint32_t> pack_textures(
    std::span<const std::shared_ptr<const Image<Rgba8>>> textures);

}  // namespace kino
