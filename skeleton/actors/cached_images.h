#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

#include "skeleton/forest/training_images.h"

namespace kino {

/// Keeps every picture that was asked for once in memory: only pixels of the body, three bytes
/// each. Depth of other pixels is forgotten (they load as 0). 20,000 actors take about 0.6 GB.
class CachedImages : public TrainingImages {
  public:
    explicit CachedImages(std::shared_ptr<const TrainingImages> from);
    ~CachedImages() override;

    [[nodiscard]] std::vector<std::string> labels() const override { return from_->labels(); }
    [[nodiscard]] std::int64_t count() const override { return from_->count(); }
    [[nodiscard]] Result<void> load(std::int64_t index, TrainingImage& out) const override;

    /// Memory that the pictures take so far.
    [[nodiscard]] std::size_t bytes() const;

  private:
    struct Packed;
    std::shared_ptr<const TrainingImages> from_;
    mutable std::vector<std::unique_ptr<const Packed>> packed_;
    mutable std::vector<std::once_flag> once_;
};

}  // namespace kino
