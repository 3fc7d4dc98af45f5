#include <fcntl.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <filesystem>

#include "sensor/v4l2/video_nodes.h"
#include "sensor/v4l2/video_system.h"

namespace kino {
namespace {

int or_errno(int result) {
    return result < 0 ? -errno : result;
}

class KernelVideoSystem final : public VideoSystem {
  public:
    std::vector<VideoNode> nodes() override { return list_video_nodes(); }

    std::string resolve(const std::string& path) override {
        std::error_code error;
        const auto target = std::filesystem::canonical(path, error);
        return error ? path : target.string();
    }

    int open(const std::string& path) override {
        return or_errno(::open(path.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC));
    }

    int close(int descriptor) override { return or_errno(::close(descriptor)); }

    int ioctl(int descriptor, unsigned long request, void* argument) override {
        return or_errno(::ioctl(descriptor, request, argument));
    }

    MapResult map(int descriptor, std::size_t length, std::int64_t offset) override {
        void* const data =
            ::mmap(nullptr, length, PROT_READ | PROT_WRITE, MAP_SHARED, descriptor, offset);
        if (data == MAP_FAILED) return {nullptr, errno};
        return {data, 0};
    }

    int unmap(void* data, std::size_t length) override { return or_errno(::munmap(data, length)); }

    int make_event() override { return or_errno(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)); }

    void set_event(int event) override {
        const std::uint64_t one = 1;
        while (::write(event, &one, sizeof one) < 0 && errno == EINTR) {
        }
    }

    PollResult poll(int descriptor, int event, TimeNs timeout) override {
        std::array<pollfd, 2> waiting{pollfd{descriptor, POLLIN, 0}, pollfd{event, POLLIN, 0}};
        const TimeNs until = now_ns() + timeout;
        while (true) {
            const TimeNs left = std::max<TimeNs>(0, until - now_ns());
            const timespec wait{left / kNsPerSecond, left % kNsPerSecond};
            const int ready = ::ppoll(waiting.data(), waiting.size(), &wait, nullptr);
            if (ready < 0 && errno == EINTR) continue;
            if (ready < 0) return {.error = errno};
            if (waiting[1].revents != 0) return {.stopped = true};
            return {.events = waiting[0].revents};
        }
    }

    TimeNs now() override { return now_ns(); }
};

}  // namespace

std::shared_ptr<VideoSystem> real_video_system() {
    static const auto system = std::make_shared<KernelVideoSystem>();
    return system;
}

}  // namespace kino
