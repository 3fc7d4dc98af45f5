#pragma once

#include <array>
#include <vector>

#include "base/error.h"
#include "viz/frame/learning/light_table.h"
#include "viz/frame/renderer.h"

namespace kino {

struct LightLearningOptions {
    std::vector<double> r = {2, 4, 8};  ///< factors that each part is resized by alone
    int repeats = 3;                    ///< pairs of timed pictures at each pose
};

/// Learns a staged scene's light from pictures of itself: draws each pose with and without each
/// part, and with each part resized alone. Time is that of the passes that shade and cast rays
/// ("light" and "shadows"); culling and what stands before it do not shrink with the picture.
class LightLearning {
  public:
    explicit LightLearning(LightLearningOptions options = {}) : options_(std::move(options)) {}

    /// One more pose. `frame`: everything but rates, LOD and timing as the program draws. Fails
    /// where a picture cannot be drawn or the scene is not staged.
    Result<void> add(Renderer& renderer, const Scene& scene, const View& view, FrameOptions frame);
    /// What all poses say; no parts before the first.
    [[nodiscard]] LightTable table() const;

  private:
    struct Part {
        std::vector<double> ms_with, ms_without;
        std::vector<double> squares;  ///< of factor i, sum over poses of the mean squared error
        int poses = 0;                ///< that had the part
    };
    LightLearningOptions options_;
    std::array<Part, 3> parts_;
    std::vector<double> chain_ms_, other_ms_;
    int width_ = 0, height_ = 0;
    int poses_ = 0;
};

}  // namespace kino
