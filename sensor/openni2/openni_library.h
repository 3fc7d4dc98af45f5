#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "base/error.h"
#include "sensor/openni2/openni_c.h"

namespace kino {

/// Names the library to load in place of Debian's: a path. OpenNI2 looks for its drivers in
/// OpenNI2/Drivers beside itself, so this also chooses the drivers.
constexpr const char* kOpenniLibraryVariable = "KINOSCOPE_OPENNI2";

/// OpenNI2, loaded when it is first needed and kept for the life of the process: it has one global
/// context, and its shutdown is where it is known to hang. Drivers print and log nothing. While the
/// library starts (once) it changes the process's working folder for a moment.
class OpenniLibrary {
  public:
    /// Fails where the library is not installed (naming the package) or finds no driver; a later
    /// call tries again.
    [[nodiscard]] static Result<OpenniLibrary*> get();

    [[nodiscard]] const openni::Api& api() const { return api_; }
    /// Held around everything that opens, closes, lists or sets: the library's own locks are not
    /// enough for two threads. Not needed for reading frames.
    [[nodiscard]] std::mutex& calls() { return calls_; }
    /// Why the last call failed, in the library's words; for Error::what. Hold calls().
    [[nodiscard]] std::string last_error() const;
    /// Devices present, ONI files that are open left out. Takes calls().
    [[nodiscard]] std::vector<openni::DeviceInfo> devices();

    /// `gone` is called once, on the library's thread, when the device with that URI disappears or
    /// reports an error; it must not call the library. Returns a number for unwatch().
    std::int64_t watch(std::string uri, std::function<void(const std::string& why)> gone);
    /// On return `gone` is not running and will not be called.
    void unwatch(std::int64_t watch);

  private:
    OpenniLibrary() = default;
    Result<void> load();
    void device_gone(const char* uri, const std::string& why);

    struct Watch {
        std::int64_t number = 0;
        std::string uri;
        std::function<void(const std::string&)> gone;
    };

    openni::Api api_{};
    openni::DeviceCallbacks callbacks_{};
    openni::Callbacks* callback_handle_ = nullptr;
    std::mutex calls_;
    std::mutex watch_mutex_;
    std::vector<Watch> watches_;
    std::int64_t last_watch_ = 0;
};

/// Runs `work` on one of the threads that are kept for the library and never end: it remembers
/// every thread that has called it and later asks the system about them, which crashes once one of
/// them has ended. So every call into the library goes through here or run_bounded().
void run_kept(std::function<void()> work);

/// As run_kept(), and waits for it at most `limit`: calls into the library may never come back.
/// False: it still runs, and goes on alone with what it holds.
[[nodiscard]] bool run_bounded(std::function<void()> work, std::chrono::milliseconds limit);

}  // namespace kino
