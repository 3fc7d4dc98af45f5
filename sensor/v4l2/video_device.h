#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "base/error.h"
#include "sensor/v4l2/video_system.h"

namespace kino {

/// A system call that failed: which one, and how.
struct CallFailure {
    int error = 0;  ///< a positive errno
    const char* call = "";
};
using Called = tl::expected<void, CallFailure>;

/// The device is no longer there, as opposed to being in trouble.
[[nodiscard]] bool means_gone(int error);

/// "VIDIOC_S_FMT failed: Device or resource busy (EBUSY)".
[[nodiscard]] std::string describe(const CallFailure& failure);

/// An open video node. Interrupted calls are repeated. Thread-safe as the kernel is.
class VideoDevice {
  public:
    [[nodiscard]] static Result<VideoDevice> open(std::shared_ptr<VideoSystem> system,
                                                  std::string path);
    VideoDevice(VideoDevice&& other) noexcept;
    VideoDevice& operator=(VideoDevice&&) = delete;
    ~VideoDevice();

    [[nodiscard]] const std::string& path() const { return path_; }
    [[nodiscard]] VideoSystem& system() const { return *system_; }

    /// `argument` is the structure that the request names.
    template <class T>
    [[nodiscard]] Called call(unsigned long request, T& argument) const {
        return call_raw(request, &argument);
    }
    [[nodiscard]] MapResult map(std::size_t length, std::int64_t offset) const;
    /// A descriptor, or the negative errno.
    [[nodiscard]] int make_event() const;
    /// A negative timeout counts as 0.
    [[nodiscard]] PollResult poll(int event, TimeNs timeout) const;

    /// The failure as an error at this node, with what the user can do about it.
    [[nodiscard]] tl::unexpected<Error> fails(const CallFailure& failure) const;

  private:
    VideoDevice(std::shared_ptr<VideoSystem> system, std::string path, int descriptor);
    [[nodiscard]] Called call_raw(unsigned long request, void* argument) const;

    std::shared_ptr<VideoSystem> system_;
    std::string path_;
    int descriptor_ = -1;
};

/// As VideoDevice::fails, for a node that could not even be opened.
[[nodiscard]] Error video_error(const CallFailure& failure, const std::string& path);

}  // namespace kino

/// KINO_TRY for calls: returns the failure from the enclosing function.
#define KINO_TRY_CALL(expression)                                              \
    do {                                                                       \
        if (auto kino_try_call = (expression); !kino_try_call) {               \
            return tl::unexpected<::kino::CallFailure>(kino_try_call.error()); \
        }                                                                      \
    } while (false)
