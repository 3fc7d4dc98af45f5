#pragma once

#include <map>

#include "skeleton/tracking/person_skeleton.h"
#include "tests/skeleton/tracking/eval/take.h"

namespace kino::test {

/// Joints from true masks and, unless labels are given, true parts: the upper bound of the fit.
class TruthTracker {
  public:
    explicit TruthTracker(const Image<RayXy>& rays, const SkeletonOptions& options = {})
        : rays_(rays), camera_(PinholeFit::of(rays)), options_(options) {}

    /// Unfiltered joints. `floor` may be unknown.
    BodyFrame track(const TakeFrame& frame, const FloorPlane& floor = {});

    [[nodiscard]] const PersonSkeleton* skeleton(std::uint32_t id) const {
        const auto found = skeletons_.find(id);
        return found == skeletons_.end() ? nullptr : &found->second;
    }
    double modes_ms = 0, fit_ms = 0;  ///< of the last frame

  private:
    Image<RayXy> rays_;
    PinholeFit camera_;
    SkeletonOptions options_;
    std::map<std::uint32_t, PersonSkeleton> skeletons_;
    PartPoints points_;
    PartModes modes_;
    FreeSpace space_;
};

}  // namespace kino::test
