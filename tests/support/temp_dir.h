#pragma once

#include <filesystem>
#include <string_view>

namespace kino::test {

/// A fresh folder that goes with the object.
class TempDir {
  public:
    TempDir();
    ~TempDir();
    TempDir(const TempDir&) = delete;
    TempDir& operator=(const TempDir&) = delete;

    [[nodiscard]] const std::filesystem::path& path() const { return path_; }
    [[nodiscard]] std::filesystem::path operator/(std::string_view name) const {
        return path_ / name;
    }
    /// Writes a file below the folder, making the folders on the way, and returns its path.
    std::filesystem::path write(std::string_view name, std::string_view content) const;

  private:
    std::filesystem::path path_;
};

/// The whole file as bytes; KINO_CHECKs that it can be read.
[[nodiscard]] std::string read_bytes(const std::filesystem::path& path);

}  // namespace kino::test
