#pragma once

#include <memory>
#include <mutex>
#include <utility>
#include <vector>

namespace kino {

/// Lends objects whose memory is worth keeping. What is lent comes back by itself when its last
/// owner lets go, on any thread; it may outlive the pool. Contents are those of the last use.
template <class T>
class RecyclingPool {
  public:
    RecyclingPool() : shelf_(std::make_shared<Shelf>()) {}

    [[nodiscard]] std::shared_ptr<T> take() {
        std::unique_ptr<T> item;
        {
            const std::lock_guard lock(shelf_->mutex);
            if (!shelf_->items.empty()) {
                item = std::move(shelf_->items.back());
                shelf_->items.pop_back();
            }
        }
        if (!item) item = std::make_unique<T>();
        return std::shared_ptr<T>(item.release(), [shelf = shelf_](T* returned) {
            std::unique_ptr<T> owned(returned);
            const std::lock_guard lock(shelf->mutex);
            shelf->items.push_back(std::move(owned));
        });
    }

    /// Objects waiting to be lent again.
    [[nodiscard]] std::size_t idle() const {
        const std::lock_guard lock(shelf_->mutex);
        return shelf_->items.size();
    }

  private:
    struct Shelf {
        std::mutex mutex;
        std::vector<std::unique_ptr<T>> items;
    };
    std::shared_ptr<Shelf> shelf_;
};

}  // namespace kino
