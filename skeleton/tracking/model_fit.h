#pragma once

#include <array>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "skeleton/people/person.h"
#include "skeleton/tracking/body_limits.h"
#include "skeleton/tracking/fit_system.h"
#include "skeleton/tracking/free_space.h"
#include "skeleton/tracking/jointed_model.h"
#include "skeleton/tracking/part_modes.h"
#include "skeleton/tracking/part_points.h"

namespace kino {

/// Everything of one frame that a model is held against.
struct FitEvidence {
    std::span<const PartPoint> points;
    const PartModes* modes = nullptr;
    const FreeSpace* space = nullptr;
    PinholeFit camera;
    FloorPlane floor;
    float cell_tangent = 0.01f;  ///< distance between neighbouring points at one metre, metres
    int per_part = 36;           ///< points are thinned to so many
};

/// What is believed before the frame is seen.
struct FitPrior {
    bool known = false;  ///< is there a last frame?
    JointedPose expected;
    float hips_sigma_m = 0.05f, turn_sigma = 0.2f;
    std::array<float, kSegmentCount> direction_sigma{};
    /// Of the shape's factors: mean and information (1 / variance), learned so far.
    std::array<float, kShapeCount> shape_mean{}, shape_information{};
};

struct FitOptions {
    int rounds = 5;
    bool shape = true;          ///< false: it stays as it is
    float far_m = 0.08f;        ///< a residual that counts a quarter, at the end
    float start_far_m = 0.08f;  ///< and in the first round
    float mode_weight = 1.0f;
};

/// How a bone was seen.
struct BoneSupport {
    int points = 0;           ///< that lie on it
    float low = 0, high = 0;  ///< points in its first and second half
};

struct FitResult {
    float cost = 0;      ///< mean over the points, 0 (all on the bones they name) .. kFitCostMax
    float on_model = 0;  ///< share of the points that lie on the model
    float free = 0;      ///< share of the model's samples that are where nothing can be
    float side = 0;      ///< mean log odds that left is left; negative: mirrored would be likelier
    std::array<BoneSupport, kBoneCount> support;
    [[nodiscard]] float total() const { return cost + 4 * free; }
};

/// Fits the jointed model to one frame by Gauss-Newton on robust residuals.
class ModelFit {
  public:
    void fit(const FitEvidence& evidence, const FitPrior& prior, const FitOptions& options,
             JointedModel& model, FitResult& result);
    /// Of the model as it is.
    void judge(const FitEvidence& evidence, const JointedModel& model, FitResult& result);
    /// Points on half of a bone if it were seen whole.
    [[nodiscard]] static float expected_points(const FitEvidence& evidence,
                                               const JointedModel& model, Bone bone);
    /// After fit() with the shape free: information that this frame adds about a factor.
    [[nodiscard]] double shape_information(int factor);

  private:
    void add_points(const FitEvidence& evidence, const JointedModel& model, float far_m);
    void add_modes(const FitEvidence& evidence, const JointedModel& model, float weight);
    void add_space(const FitEvidence& evidence, const JointedModel& model);
    void add_body_knowledge(const FitEvidence& evidence, const JointedModel& model);
    void pull_to_rest(const JointedModel& model, const RestDirection& rest);
    void keep_legs_apart(const JointedModel& model);
    void add_prior(const FitPrior& prior, const JointedModel& model, bool shape);
    void pull_direction(const JointedModel& model, Segment segment, const glm::vec3& target,
                        int frame_unknown, double weight);

    FitSystem system_;
    std::array<int, kBoneCount> on_bone_{};
    /// Of the points that a segment would have, were it seen whole.
    std::array<float, kSegmentCount> seen_{};
    std::vector<std::uint8_t> chosen_;  // candidate of each point
    int free_ = kPoseUnknowns;
};

}  // namespace kino
