#pragma once

#include <cstdint>
#include <filesystem>

#include "base/error.h"
#include "base/frame.h"
#include "base/image.h"

namespace kino {

using GreyPicture = Image<std::uint8_t>;

/// A PNG (8 or 16 bit) or JPEG as grey, by content and not by name. 16 bits, the infrared
/// pictures, are stretched so that the darkest and brightest hundredth of the pixels are clipped.
[[nodiscard]] Result<GreyPicture> read_grey(const std::filesystem::path& path);

[[nodiscard]] Result<GreyPicture> grey_of(const ColorFrame& frame);
/// Stretched as above.
[[nodiscard]] GreyPicture grey_of(const Image<std::uint16_t>& infrared);

/// Left becomes right.
[[nodiscard]] GreyPicture mirrored(const GreyPicture& picture);

}  // namespace kino
