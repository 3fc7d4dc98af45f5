#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "base/error.h"

namespace kino {

/// A file's whole content. Fails where it is missing, not a regular file, or larger than `limit`
/// bytes (so that a hostile or wrong path cannot fill the memory). Paths are UTF-8 bytes as the
/// user typed them; nothing is converted.
[[nodiscard]] Result<std::vector<std::uint8_t>> read_file_bytes(const std::filesystem::path& path,
                                                                std::size_t limit);
[[nodiscard]] Result<std::string> read_file_text(const std::filesystem::path& path,
                                                 std::size_t limit);

/// Writes through a neighbouring temporary name, so a crash leaves the old file or the new one.
[[nodiscard]] Result<void> write_file_bytes(const std::filesystem::path& path, const void* data,
                                            std::size_t size);

/// The PNG files directly inside `folder`, sorted by name as bytes. Fails where there is no such
/// folder.
[[nodiscard]] Result<std::vector<std::filesystem::path>> png_files(
    const std::filesystem::path& folder);

/// Joins a name read from a recording to its folder; refuses names that lead out of it.
[[nodiscard]] Result<std::filesystem::path> path_inside(const std::filesystem::path& folder,
                                                        const std::string& name);

}  // namespace kino
