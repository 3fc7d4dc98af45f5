#pragma once

#include <atomic>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "apps/pipeline/processed_frame.h"
#include "apps/viewer/scene_builder.h"
#include "base/error.h"
#include "viz/scene/scene.h"
#include "viz/scene/view.h"

namespace kino::bench {

/// What happens to the picture from one frame on.
struct Disturbance {
    std::string name;
    double nearer = 1;  ///< the camera's distance is divided by it
    double turn = 0;    ///< radians about the person
    int lights = 1;     ///< the stage's lights so many times
    bool busy = false;  ///< somebody else takes one core
};

/// The light-painting stage with a computed person, frame by frame, the same in every run, and with
/// disturbances of view, coverage and workload at fixed frames.
class GovernorScript {
  public:
    /// Fails where the stage or the person cannot be made.
    [[nodiscard]] static Result<std::unique_ptr<GovernorScript>> create(int width, int height,
                                                                        int frames);
    ~GovernorScript();
    GovernorScript(const GovernorScript&) = delete;
    GovernorScript& operator=(const GovernorScript&) = delete;

    /// From the first frame again.
    void restart();
    /// The next frame's scene, good until the following call, and its view.
    struct Moment {
        const Scene& scene;
        View view;
        const Disturbance& disturbance;
        bool fresh = false;  ///< the disturbance began with this frame
    };
    [[nodiscard]] Moment next();
    [[nodiscard]] int frames() const { return frames_; }
    [[nodiscard]] static const std::vector<Disturbance>& disturbances();

  private:
    GovernorScript(int width, int height, int frames)
        : width_(width), height_(height), frames_(frames) {}
    void let_busy(bool busy);

    int width_, height_, frames_;
    std::vector<ProcessedFrame> person_;
    std::unique_ptr<SceneBuilder> builder_;
    Scene scene_;
    int at_ = 0;
    std::atomic<bool> busy_{false};
    std::thread neighbour_;
};

}  // namespace kino::bench
