#include "apps/demo_sources/device_watch.h"

#include <chrono>
#include <utility>

namespace kino {

DeviceWatch::DeviceWatch(Open open, TimeNs pause) : open_(std::move(open)), pause_(pause) {
    thread_ = std::thread([this] { run(); });
}

DeviceWatch::~DeviceWatch() {
    {
        const std::lock_guard lock(mutex_);
        stopping_ = true;
    }
    changed_.notify_all();
    thread_.join();
}

std::unique_ptr<LiveRunner> DeviceWatch::take() {
    const std::lock_guard lock(mutex_);
    return std::exchange(found_, nullptr);
}

std::optional<Error> DeviceWatch::trouble() const {
    const std::lock_guard lock(mutex_);
    return trouble_;
}

void DeviceWatch::run() {
    std::unique_lock lock(mutex_);
    while (!stopping_) {
        lock.unlock();
        auto opened = open_();
        lock.lock();
        if (opened) {
            found_ = std::move(*opened);
            trouble_.reset();
            return;
        }
        trouble_ = std::move(opened).error();
        changed_.wait_for(lock, std::chrono::nanoseconds(pause_), [this] { return stopping_; });
    }
}

}  // namespace kino
