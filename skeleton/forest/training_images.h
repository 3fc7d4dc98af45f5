#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/image.h"

namespace kino {

/// In a label picture: whatever is not the body.
constexpr std::uint8_t kNotBody = 255;

/// One body with the truth for each of its pixels. Both pictures have the same size.
struct TrainingImage {
    Image<std::uint16_t> depth_mm;  ///< with the sensor's noise; 0: no reading
    Image<std::uint8_t> label;      ///< index into TrainingImages::labels(), or kNotBody
    double focal_px = 0;
};

/// Where a trainer's pictures come from: rendered on the fly or read from files. The trainer asks
/// for every picture again in every pass, so that it need not keep them.
class TrainingImages {
  public:
    TrainingImages() = default;
    TrainingImages(const TrainingImages&) = delete;
    TrainingImages& operator=(const TrainingImages&) = delete;
    virtual ~TrainingImages() = default;

    /// At most 32 names.
    [[nodiscard]] virtual std::vector<std::string> labels() const = 0;
    [[nodiscard]] virtual std::int64_t count() const = 0;
    /// Picture `index` of [0, count()), the same at every call. Called from several threads at
    /// once, each with an `out` of its own whose memory may be reused.
    [[nodiscard]] virtual Result<void> load(std::int64_t index, TrainingImage& out) const = 0;
};

}  // namespace kino
