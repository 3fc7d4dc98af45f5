#pragma once

#include <cstdint>
#include <functional>
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
    std::uint32_t xy = 0;  ///< in the padded picture of its body
    std::int16_t scale = 0;
    std::uint8_t label = 0;
    std::uint16_t image = 0;  ///< of the block
    std::int32_t node = 0;    ///< of the growing tree, where it has got to
};

/// How many pixels to draw from each picture, and how.
struct SampleDraw {
    std::uint64_t seed = 0;
    std::uint64_t stream = 0;  ///< of the tree and the purpose
    int pixels = 0;
    double balanced_share = 0;
};

/// A few pictures and the pixels drawn from them.
class TrainingBlock {
  public:
    /// Pictures [first, first + count) modulo the number there is. Samples come by picture and by
    /// rows, those drawn for balance after the others of their picture.
    [[nodiscard]] Result<void> load(const TrainingImages& images, std::int64_t first, int count,
                                    const SampleDraw& draw, int threads);

    /// Sets every sample's node by walking down from node 0.
    void walk(const std::vector<ForestNode>& nodes, int threads);

    [[nodiscard]] std::vector<std::vector<TrainingSample>>& samples() { return samples_; }
    [[nodiscard]] const forest::WalkImage& image(std::size_t i) const { return walk_images_[i]; }

  private:
    std::vector<TrainingImage> pictures_;
    std::vector<Image<std::uint8_t>> masks_;
    std::vector<BodyDepth> bodies_;
    std::vector<forest::WalkImage> walk_images_;
    std::vector<std::vector<TrainingSample>> samples_;
};

}  // namespace kino
