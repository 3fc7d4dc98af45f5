#pragma once

#include <map>
#include <memory>

#include "skeleton/forest/body_depth.h"
#include "skeleton/forest/part_labeller.h"
#include "skeleton/tracking/person_skeleton.h"
#include "tests/skeleton/tracking/eval/take.h"

namespace kino::test {

/// Joints from true masks and, unless labels are given, true parts: the upper bound of the fit.
class TruthTracker {
  public:
    explicit TruthTracker(const Image<RayXy>& rays, const SkeletonOptions& options = {})
        : rays_(rays), camera_(PinholeFit::of(rays)), options_(options) {}

    /// From now on parts come from this forest.
    void label_by(const Forest& forest) { labeller_ = std::make_unique<PartLabeller>(forest); }

    /// Unfiltered joints. `floor` may be unknown.
    BodyFrame track(const TakeFrame& frame, const FloorPlane& floor = {});

    [[nodiscard]] const PersonSkeleton* skeleton(std::uint32_t id) const {
        const auto found = skeletons_.find(id);
        return found == skeletons_.end() ? nullptr : &found->second;
    }
    double modes_ms = 0, fit_ms = 0;  ///< of the last frame

  private:
    void add_labelled(const TakeFrame& frame, std::uint8_t id, int step);

    Image<RayXy> rays_;
    PinholeFit camera_;
    SkeletonOptions options_;
    std::map<std::uint32_t, PersonSkeleton> skeletons_;
    std::unique_ptr<PartLabeller> labeller_;
    BodyDepth body_depth_;
    PartLabels labels_;
    PartPoints points_;
    PartModes modes_;
    FreeSpace space_;
};

}  // namespace kino::test
