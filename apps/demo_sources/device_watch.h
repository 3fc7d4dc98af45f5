#pragma once

#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>

#include "apps/pipeline/live_runner.h"

namespace kino {

/// Looks for a sensor on a thread of its own, for opening one takes longer than a picture may.
class DeviceWatch {
  public:
    using Open = std::function<Result<std::unique_ptr<LiveRunner>>()>;

    /// Asks `open` at once and then every `pause` until it gives something.
    DeviceWatch(Open open, TimeNs pause);
    ~DeviceWatch();  ///< waits for an `open` under way
    DeviceWatch(const DeviceWatch&) = delete;
    DeviceWatch& operator=(const DeviceWatch&) = delete;

    /// What was opened, once. Null: nothing yet.
    [[nodiscard]] std::unique_ptr<LiveRunner> take();
    /// Why there is nothing, of the last try. Empty before the first is over.
    [[nodiscard]] std::optional<Error> trouble() const;

  private:
    void run();

    Open open_;
    TimeNs pause_;
    mutable std::mutex mutex_;
    std::condition_variable changed_;
    std::unique_ptr<LiveRunner> found_;
    std::optional<Error> trouble_;
    bool stopping_ = false;
    std::thread thread_;
};

}  // namespace kino
