#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "sensor/openni2/oni_walk.h"

namespace kino {
namespace {

class OniFile final : public OniInput {
  public:
    OniFile(int descriptor, std::uint64_t size) : descriptor_(descriptor), size_(size) {}
    ~OniFile() override { close(descriptor_); }

    std::uint64_t size() const override { return size_; }
    bool read(std::uint64_t position, std::span<std::uint8_t> out) const override {
        if (position > size_ || out.size() > size_ - position) return false;
        std::size_t done = 0;
        while (done < out.size()) {
            const ssize_t got = pread(descriptor_, out.data() + done, out.size() - done,
                                      static_cast<off_t>(position + done));
            if (got < 0 && errno == EINTR) continue;
            if (got <= 0) return false;
            done += static_cast<std::size_t>(got);
        }
        return true;
    }

  private:
    int descriptor_;
    std::uint64_t size_;
};

}  // namespace

Result<std::unique_ptr<OniInput>> open_oni_input(const std::filesystem::path& file) {
    const int descriptor = open(file.c_str(), O_RDONLY | O_CLOEXEC);
    if (descriptor < 0) {
        return fail(fmt::format("cannot be opened: {}", std::strerror(errno)), file.string());
    }
    struct stat status {};
    if (fstat(descriptor, &status) != 0 || !S_ISREG(status.st_mode)) {
        close(descriptor);
        return fail("is not a regular file", file.string());
    }
    return std::make_unique<OniFile>(descriptor, static_cast<std::uint64_t>(status.st_size));
}

bool looks_like_oni(std::span<const std::uint8_t> head) {
    return head.size() >= 4 && std::memcmp(head.data(), "NI10", 4) == 0;
}

Result<std::vector<std::uint8_t>> read_payload(const OniInput& input, const OniData& data) {
    std::vector<std::uint8_t> bytes(data.payload_bytes);
    if (!input.read(data.next - data.payload_bytes, bytes)) {
        return fail("the file has become shorter while it was read");
    }
    return bytes;
}

}  // namespace kino
