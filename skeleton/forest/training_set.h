#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "base/error.h"
#include "skeleton/forest/body_depth.h"
#include "skeleton/forest/forest.h"
#include "skeleton/forest/training_images.h"

namespace kino {

/// Calls work(i) for each i of [0, count) on so many threads; returns when all is done.
void parallel_for(int threads, std::size_t count, const std::function<void(std::size_t)>& work);

/// depth at u minus depth at v, mm, as the labeller has it.
[[nodiscard]] std::int32_t feature_response(const forest::WalkImage& image, std::uint32_t xy,
                                            std::int32_t scale, const ForestFeature& feature);

/// One pixel that has been drawn.
struct TrainingSample {
    std::uint32_t xy = 0;     ///< in the padded picture of its body
    std::uint32_t image = 0;  ///< of the set
    std::int16_t scale = 0;
    std::uint8_t label = 0;
};

/// How many pixels to draw from each picture, and how.
struct SampleDraw {
    std::uint64_t seed = 0;
    std::uint64_t stream = 0;  ///< of the tree and the purpose
    int pixels = 0;
    double balanced_share = 0;
};

/// Pictures and the pixels drawn from them, all in memory: about 2 bytes for each pixel of the
/// bodies' bounding boxes and 12 for each sample.
class TrainingSet {
  public:
    /// Pictures [first, first + count) modulo the number there is. Samples come by picture and by
    /// rows, those drawn for balance after the others of their picture.
    [[nodiscard]] Result<void> load(const TrainingImages& images, std::int64_t first,
                                    std::int64_t count, const SampleDraw& draw, int threads);

    [[nodiscard]] std::vector<TrainingSample>& samples() { return samples_; }
    [[nodiscard]] std::span<const forest::WalkImage> images() const { return walk_images_; }

  private:
    std::vector<std::vector<std::uint16_t>> depth_;
    std::vector<forest::WalkImage> walk_images_;
    std::vector<TrainingSample> samples_;
};

/// Drawn pixels of one picture, ready to walk.
struct DrawnPixels {
    BodyDepth body;
    std::vector<std::uint32_t> xy;
    std::vector<std::int16_t> scale;
    std::vector<std::uint8_t> label;
};

/// Draws from picture `index`; reuses the memory of `picture` and `out`.
[[nodiscard]] Result<void> draw_pixels(const TrainingImages& images, std::int64_t index,
                                       const SampleDraw& draw, TrainingImage& picture,
                                       DrawnPixels& out);

}  // namespace kino
