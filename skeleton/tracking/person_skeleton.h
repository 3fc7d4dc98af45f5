#pragma once

#include <array>

#include "base/body.h"
#include "skeleton/tracking/model_fit.h"
#include "skeleton/tracking/pose_guess.h"

namespace kino {

/// One person's labelled picture.
struct PersonView {
    const PartPoints* points = nullptr;
    const PartModes* modes = nullptr;
    const FreeSpace* space = nullptr;
    PinholeFit camera;
    FloorPlane floor;
    float cell_tangent = 0.01f;  ///< distance between neighbouring points at one metre, metres
    bool cut_off = false;        ///< by the picture's edge
};

struct SkeletonOptions {
    int rounds = 2;  ///< of the fit; more fit what the forest gets wrong, too
    int points_per_part = 36;
    double learn_s = 2.5;  ///< bone lengths are free for so long
    float hold = 0.012f;   ///< and then stay within this share
};

/// The jointed model of one person, carried through time.
class PersonSkeleton {
  public:
    explicit PersonSkeleton(const SkeletonOptions& options = {}) : options_(options) {}

    /// Times rise. False: the person has no pose yet.
    bool update(const PersonView& view, TimeNs time);

    /// Joints of the last update.
    [[nodiscard]] const std::array<JointPosition, kJointCount>& joints() const { return joints_; }
    [[nodiscard]] const JointedModel& model() const { return model_; }
    [[nodiscard]] const FitResult& result() const { return result_; }
    /// How often the pose had to be found anew.
    [[nodiscard]] int restarts() const { return restarts_; }

  private:
    [[nodiscard]] JointedPose predict(double dt_s) const;
    [[nodiscard]] FitPrior prior_for(double dt_s) const;
    bool restart(const FitEvidence& evidence, bool compare);
    void try_limbs(const FitEvidence& evidence);
    void learn(double dt_s);
    void describe(const FitEvidence& evidence, double dt_s);

    SkeletonOptions options_;
    ModelFit fit_;
    JointedModel model_;
    JointedPose before_;  // of the frame before the last
    double before_dt_s_ = 0;
    double settled_s_ = 0;  // since the pose was last found anew
    bool known_ = false, moving_ = false;
    TimeNs time_ = 0;
    int frames_ = 0, restarts_ = 0;
    FitResult result_;
    std::array<float, kShapeCount> mean_{}, information_{}, anchor_{};
    std::array<double, kShapeCount> learned_s_{};
    std::array<float, kSegmentCount> seen_{};  // smoothed, 0..1
    std::array<float, kJointCount> trust_{};
    std::vector<PartPoint> points_;
    std::array<JointPosition, kJointCount> joints_{};
};

}  // namespace kino
