#pragma once

#include <atomic>
#include <mutex>
#include <string>
#include <vector>

#include "sensor/live/device.h"

namespace kino::test {

class CollectingIntake final : public FrameIntake {
  public:
    void put(StreamId id, StreamFrame frame) override {
        const std::lock_guard lock(mutex_);
        if (!losses_.empty()) ++put_after_lost_;
        ids_.push_back(id);
        frames_.push_back(std::move(frame));
    }
    void lost(std::string why) override {
        const std::lock_guard lock(mutex_);
        losses_.push_back(std::move(why));
        is_lost_ = true;
    }

    [[nodiscard]] bool is_lost() const { return is_lost_; }
    [[nodiscard]] std::vector<std::string> losses() const {
        const std::lock_guard lock(mutex_);
        return losses_;
    }
    [[nodiscard]] int put_after_lost() const {
        const std::lock_guard lock(mutex_);
        return put_after_lost_;
    }
    [[nodiscard]] std::vector<StreamFrame> frames() const {
        const std::lock_guard lock(mutex_);
        return frames_;
    }
    template <class Frame>
    [[nodiscard]] std::vector<std::shared_ptr<const Frame>> all() const {
        std::vector<std::shared_ptr<const Frame>> out;
        for (const StreamFrame& frame : frames())
            if (const auto* held = std::get_if<std::shared_ptr<const Frame>>(&frame))
                out.push_back(*held);
        return out;
    }

  private:
    mutable std::mutex mutex_;
    std::vector<StreamId> ids_;
    std::vector<StreamFrame> frames_;
    std::vector<std::string> losses_;
    int put_after_lost_ = 0;
    std::atomic<bool> is_lost_ = false;
};

}  // namespace kino::test
