#include "sensor/session/byte_source.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

namespace kino {
namespace {

class FileBytes final : public ByteSource {
  public:
    FileBytes(int descriptor, std::uint64_t size) : descriptor_(descriptor), size_(size) {}
    FileBytes(const FileBytes&) = delete;
    FileBytes& operator=(const FileBytes&) = delete;
    ~FileBytes() override { ::close(descriptor_); }

    std::uint64_t size() const override { return size_; }

    bool read(std::uint64_t offset, std::span<std::uint8_t> out) const override {
        if (offset > size_ || out.size() > size_ - offset) return false;
        while (!out.empty()) {
            const ssize_t got =
                ::pread(descriptor_, out.data(), out.size(), static_cast<off_t>(offset));
            if (got < 0 && errno == EINTR) continue;
            if (got <= 0) return false;
            offset += static_cast<std::uint64_t>(got);
            out = out.subspan(static_cast<std::size_t>(got));
        }
        return true;
    }

  private:
    int descriptor_;
    std::uint64_t size_;
};

class MemoryBytes final : public ByteSource {
  public:
    explicit MemoryBytes(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}
    std::uint64_t size() const override { return bytes_.size(); }
    bool read(std::uint64_t offset, std::span<std::uint8_t> out) const override {
        if (offset > bytes_.size() || out.size() > bytes_.size() - offset) return false;
        if (!out.empty()) std::memcpy(out.data(), bytes_.data() + offset, out.size());
        return true;
    }

  private:
    std::span<const std::uint8_t> bytes_;
};

}  // namespace

Result<std::unique_ptr<ByteSource>> open_byte_source(const std::filesystem::path& path) {
    // Not waiting: a pipe of this name must not hold the program up.
    const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (descriptor < 0) return fail(std::strerror(errno), path.string());
    struct stat status {};
    if (::fstat(descriptor, &status) != 0 || !S_ISREG(status.st_mode)) {
        ::close(descriptor);
        return fail("not a regular file", path.string());
    }
    return std::make_unique<FileBytes>(descriptor, static_cast<std::uint64_t>(status.st_size));
}

std::unique_ptr<ByteSource> memory_byte_source(std::span<const std::uint8_t> bytes) {
    return std::make_unique<MemoryBytes>(bytes);
}

std::span<const std::uint8_t> ByteWindow::at(std::uint64_t offset, std::size_t count) {
    constexpr std::size_t kWindow = 4096;
    if (offset >= source_.size()) return {};
    count = static_cast<std::size_t>(std::min<std::uint64_t>(count, source_.size() - offset));
    if (offset < start_ || offset + count > start_ + bytes_.size()) {
        bytes_.resize(static_cast<std::size_t>(std::min<std::uint64_t>(
            std::max<std::size_t>(count, kWindow), source_.size() - offset)));
        start_ = offset;
        if (!source_.read(offset, bytes_)) {
            bytes_.clear();
            return {};
        }
    }
    return std::span(bytes_).subspan(static_cast<std::size_t>(offset - start_), count);
}

}  // namespace kino
