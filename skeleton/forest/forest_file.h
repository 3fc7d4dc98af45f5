#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "base/error.h"
#include "skeleton/forest/forest.h"

namespace kino {

/// The format of docs/forest.md, version 1. The forest must be sound.
[[nodiscard]] std::vector<std::uint8_t> forest_to_bytes(const Forest& forest);

/// Takes any bytes: fails on damage (CRC-32), on other versions and on whatever forest_defect()
/// names, without allocating more than a small multiple of the input's size.
[[nodiscard]] Result<Forest> forest_from_bytes(std::span<const std::uint8_t> bytes,
                                               const std::string& where);

[[nodiscard]] Result<Forest> read_forest(const std::filesystem::path& path);
[[nodiscard]] Result<void> write_forest(const std::filesystem::path& path, const Forest& forest);

}  // namespace kino
