#pragma once

#include <atomic>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "base/image.h"
#include "sensor/png_io.h"

namespace kino::test {

/// A folder of its own that is gone when the test is over. Its name is not ASCII, so every test
/// that opens a path through it also opens such a path.
class TestFolder {
  public:
    TestFolder() {
        std::string pattern =
            (std::filesystem::temp_directory_path() / "kino-prüfung-深-XXXXXX").string();
        path_ = ::mkdtemp(pattern.data());
    }
    ~TestFolder() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    TestFolder(const TestFolder&) = delete;
    TestFolder& operator=(const TestFolder&) = delete;

    [[nodiscard]] const std::filesystem::path& path() const { return path_; }

    std::filesystem::path write(const std::string& name, const std::string& content) const {
        const std::filesystem::path file = path_ / name;
        std::filesystem::create_directories(file.parent_path());
        std::ofstream(file, std::ios::binary) << content;
        return file;
    }

    std::filesystem::path write_depth(const std::string& name, int width, int height,
                                      std::uint16_t value) const {
        const Image<std::uint16_t> image(width, height, value);
        const std::filesystem::path file = path_ / name;
        std::filesystem::create_directories(file.parent_path());
        if (!write_png_gray16(file, image)) std::abort();
        return file;
    }

    std::filesystem::path write_color(const std::string& name, int width, int height,
                                      Rgba8 value) const {
        const Image<Rgba8> image(width, height, value);
        const std::filesystem::path file = path_ / name;
        std::filesystem::create_directories(file.parent_path());
        if (!write_png_rgba8(file, image)) std::abort();
        return file;
    }

  private:
    std::filesystem::path path_;
};

}  // namespace kino::test
