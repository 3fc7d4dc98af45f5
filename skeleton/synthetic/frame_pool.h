#pragma once

#include <memory>
#include <mutex>
#include <utility>
#include <vector>

namespace kino {

/// Frames that come back when their last reader lets go, with their memory. Readers may outlive the
/// pool and sit on other threads.
template <class T>
class FramePool {
  public:
    [[nodiscard]] std::shared_ptr<T> take() {
        std::unique_ptr<T> frame;
        {
            const std::lock_guard lock(shelf_->mutex);
            if (!shelf_->free.empty()) {
                frame = std::move(shelf_->free.back());
                shelf_->free.pop_back();
            }
        }
        if (!frame) frame = std::make_unique<T>();
        return {frame.release(), [shelf = shelf_](T* used) {
                    std::unique_ptr<T> back(used);
                    const std::lock_guard lock(shelf->mutex);
                    if (shelf->free.size() < kKept) shelf->free.push_back(std::move(back));
                }};
    }

  private:
    static constexpr std::size_t kKept = 4;
    struct Shelf {
        Shelf() { free.reserve(kKept); }
        std::mutex mutex;
        std::vector<std::unique_ptr<T>> free;
    };
    std::shared_ptr<Shelf> shelf_ = std::make_shared<Shelf>();
};

}  // namespace kino
