#pragma once

#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "sensor/live/device.h"

namespace kino::test {

/// Keeps what a device puts. Thread-safe.
class Collected : public FrameIntake {
  public:
    void put(StreamId id, StreamFrame frame) override {
        const std::lock_guard lock(mutex_);
        after_loss_ += losses_.empty() ? 0 : 1;
        frames_.emplace_back(id, std::move(frame));
    }
    void lost(std::string why) override {
        const std::lock_guard lock(mutex_);
        losses_.push_back(std::move(why));
    }
    template <class Frame>
    [[nodiscard]] std::vector<std::shared_ptr<const Frame>> of(StreamKind kind) const {
        const std::lock_guard lock(mutex_);
        std::vector<std::shared_ptr<const Frame>> out;
        for (const auto& [id, frame] : frames_) {
            if (id.kind == kind) out.push_back(std::get<std::shared_ptr<const Frame>>(frame));
        }
        return out;
    }
    [[nodiscard]] std::vector<std::string> losses() const {
        const std::lock_guard lock(mutex_);
        return losses_;
    }
    [[nodiscard]] std::size_t count() const {
        const std::lock_guard lock(mutex_);
        return frames_.size();
    }
    [[nodiscard]] int after_loss() const {
        const std::lock_guard lock(mutex_);
        return after_loss_;
    }

  private:
    mutable std::mutex mutex_;
    std::vector<std::pair<StreamId, StreamFrame>> frames_;
    std::vector<std::string> losses_;
    int after_loss_ = 0;
};

}  // namespace kino::test
