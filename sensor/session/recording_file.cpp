#include "sensor/session/recording_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string>
#include <utility>

#include "base/check.h"

namespace kino {
namespace {

const char* hint_of(int number) {
    switch (number) {
        case ENOSPC:
        case EDQUOT:
            return "make room on the disk or record elsewhere";
        case EROFS:
        case EACCES:
        case EPERM:
            return "choose a folder that this user may write to";
        case EEXIST:
            return "choose another name; recordings are never overwritten";
        case ENOENT:
            return "make the folder first";
        case EFBIG:
            return "this file system or user limit allows no larger file";
        default:
            return "";
    }
}

class PosixFile final : public RecordingFile {
  public:
    PosixFile(int descriptor, std::uint64_t size, std::filesystem::path path)
        : descriptor_(descriptor), size_(size), path_(std::move(path)) {}
    ~PosixFile() override { ::close(descriptor_); }

    Result<void> append(std::span<const std::uint8_t> bytes) override {
        return write_at(size_, bytes);
    }

    Result<void> overwrite(std::uint64_t offset, std::span<const std::uint8_t> bytes) override {
        KINO_CHECK_LE(offset + bytes.size(), size_);
        return write_at(offset, bytes);
    }

    Result<void> sync() override {
        while (::fdatasync(descriptor_) != 0) {
            if (errno != EINTR) return failed();
        }
        return {};
    }

    Result<void> truncate(std::uint64_t size) override {
        while (::ftruncate(descriptor_, static_cast<off_t>(size)) != 0) {
            if (errno != EINTR) return failed();
        }
        size_ = size;
        return {};
    }

    std::uint64_t size() const override { return size_; }

  private:
    Result<void> write_at(std::uint64_t offset, std::span<const std::uint8_t> bytes) {
        while (!bytes.empty()) {
            const ssize_t written =
                ::pwrite(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(offset));
            if (written < 0) {
                if (errno == EINTR) continue;
                return failed();
            }
            offset += static_cast<std::uint64_t>(written);
            size_ = std::max(size_, offset);
            bytes = bytes.subspan(static_cast<std::size_t>(written));
        }
        return {};
    }

    tl::unexpected<Error> failed() const {
        const int number = errno;
        return fail(std::strerror(number), path_.string(), hint_of(number));
    }

    int descriptor_;
    std::uint64_t size_;
    std::filesystem::path path_;
};

Result<std::unique_ptr<RecordingFile>> open_with(const std::filesystem::path& path, int flags) {
    const int descriptor = ::open(path.c_str(), flags | O_CLOEXEC, 0644);
    if (descriptor < 0) {
        const int number = errno;
        return fail(std::strerror(number), path.string(), hint_of(number));
    }
    struct stat status {};
    if (::fstat(descriptor, &status) != 0 || !S_ISREG(status.st_mode)) {
        ::close(descriptor);
        return fail("not a regular file", path.string());
    }
    return std::make_unique<PosixFile>(descriptor, static_cast<std::uint64_t>(status.st_size),
                                       path);
}

// A new name is safe only when its folder is, too. Folders that cannot be opened or synced are
// none of the recording's business.
void sync_folder_of(const std::filesystem::path& path) {
    const std::filesystem::path folder = path.has_parent_path() ? path.parent_path() : ".";
    const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (descriptor < 0) return;
    (void)::fsync(descriptor);
    ::close(descriptor);
}

}  // namespace

Result<std::unique_ptr<RecordingFile>> create_recording_file(const std::filesystem::path& path) {
    auto file = open_with(path, O_WRONLY | O_CREAT | O_EXCL);
    if (file) sync_folder_of(path);
    return file;
}

Result<std::unique_ptr<RecordingFile>> open_recording_file(const std::filesystem::path& path) {
    return open_with(path, O_WRONLY);
}

}  // namespace kino
