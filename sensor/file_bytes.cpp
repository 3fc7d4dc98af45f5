#include "sensor/file_bytes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <system_error>

namespace kino {
namespace {

namespace fs = std::filesystem;

struct FileCloser {
    void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, FileCloser>;

template <class Container>
Result<Container> read_whole(const fs::path& path, std::size_t limit) {
    std::error_code error;
    const fs::file_status status = fs::status(path, error);
    if (status.type() == fs::file_type::not_found) return fail("no such file", path.string());
    if (!fs::is_regular_file(status)) return fail("not a regular file", path.string());
    const File file(std::fopen(path.c_str(), "rb"));
    if (!file) return fail(std::strerror(errno), path.string());
    const std::uintmax_t size = fs::file_size(path, error);
    if (error) return fail(error.message(), path.string());
    if (size > limit) {
        return fail(fmt::format("file of {} bytes is larger than the limit of {}", size, limit),
                    path.string());
    }
    Container content;
    content.resize(static_cast<std::size_t>(size));
    const std::size_t got = std::fread(content.data(), 1, content.size(), file.get());
    if (got != content.size()) return fail("file could not be read to its end", path.string());
    return content;
}

}  // namespace

Result<std::vector<std::uint8_t>> read_file_bytes(const fs::path& path, std::size_t limit) {
    return read_whole<std::vector<std::uint8_t>>(path, limit);
}

Result<std::string> read_file_text(const fs::path& path, std::size_t limit) {
    return read_whole<std::string>(path, limit);
}

Result<void> write_file_bytes(const fs::path& path, const void* data, std::size_t size) {
    fs::path partial = path;
    partial += ".partial";
    {
        const File file(std::fopen(partial.c_str(), "wb"));
        if (!file) return fail(std::strerror(errno), path.string());
        if (std::fwrite(data, 1, size, file.get()) != size || std::fflush(file.get()) != 0) {
            const std::string reason = std::strerror(errno);
            std::remove(partial.c_str());
            return fail(reason, path.string());
        }
    }
    std::error_code error;
    fs::rename(partial, path, error);
    if (error) {
        std::remove(partial.c_str());
        return fail(error.message(), path.string());
    }
    return {};
}

Result<std::vector<fs::path>> png_files(const fs::path& folder) {
    std::error_code error;
    std::vector<fs::path> files;
    fs::directory_iterator entry(folder, error);
    if (error) return fail(error.message(), folder.string());
    for (; entry != fs::directory_iterator(); entry.increment(error)) {
        std::string extension = entry->path().extension().string();
        for (char& c : extension) {
            if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
        }
        if (extension == ".png") files.push_back(entry->path());
    }
    if (error) return fail(error.message(), folder.string());
    std::sort(files.begin(), files.end(),
              [](const fs::path& a, const fs::path& b) { return a.native() < b.native(); });
    return files;
}

Result<fs::path> path_inside(const fs::path& folder, const std::string& name) {
    const fs::path relative(name);
    if (name.empty() || name.find('\0') != std::string::npos || relative.is_absolute()) {
        return fail(fmt::format("\"{}\" is not a file name inside the recording", name));
    }
    for (const fs::path& part : relative) {
        if (part == "..") return fail(fmt::format("\"{}\" leads out of the recording", name));
    }
    return folder / relative;
}

}  // namespace kino
