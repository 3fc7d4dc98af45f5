#pragma once

#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <optional>
#include <utility>

#include "base/time.h"

namespace kino {

/// One slot between two threads: the newest value wins and what it replaces is counted as
/// dropped. The writer never waits.
template <class T>
class Mailbox {
  public:
    void put(T value) {
        {
            const std::lock_guard lock(mutex_);
            if (slot_) ++dropped_;
            slot_ = std::move(value);
        }
        ready_.notify_one();
    }

    [[nodiscard]] std::optional<T> take() {
        const std::lock_guard lock(mutex_);
        return std::exchange(slot_, std::nullopt);
    }

    /// Waits up to `timeout` for a value; none after close() once the slot is empty.
    [[nodiscard]] std::optional<T> wait(TimeNs timeout) {
        std::unique_lock lock(mutex_);
        ready_.wait_for(lock, std::chrono::nanoseconds(timeout),
                        [&] { return slot_.has_value() || closed_; });
        return std::exchange(slot_, std::nullopt);
    }

    void close() {
        {
            const std::lock_guard lock(mutex_);
            closed_ = true;
        }
        ready_.notify_all();
    }

    [[nodiscard]] std::int64_t dropped() const {
        const std::lock_guard lock(mutex_);
        return dropped_;
    }

  private:
    mutable std::mutex mutex_;
    std::condition_variable ready_;
    std::optional<T> slot_;
    std::int64_t dropped_ = 0;
    bool closed_ = false;
};

}  // namespace kino
