#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <memory>
#include <optional>
#include <string>

#include "base/body.h"
#include "base/error.h"
#include "base/image.h"
#include "calibration/rig.h"
#include "skeleton/forest/forest.h"
#include "skeleton/people/people_finder.h"

namespace kino {

enum class TrackingMode : std::uint8_t {
    full,    ///< 20 joints
    seated,  ///< the ten of head, shoulders and arms; the others are lost
};

struct BodyTrackerOptions {
    TrackingMode mode = TrackingMode::full;
    PeopleOptions people;
    /// As make_body_filter() takes it.
    std::string filter = "one-euro:default";
    int tracked_in_full = 2;  ///< people with joints; others have their centroid as hip_center
    // Knobs of accuracy against time, each measured by `bench bodies`.
    int trees = 0;       ///< of the forest; 0: all
    int max_depth = 0;   ///< of its trees; 0: all
    int step_px = 0;     ///< every n-th pixel of every n-th row is labelled; 0: by the person's
    int fit_rounds = 0;  ///< of the model fit; 0: the default
};

/// Host time of the stages of one frame, ns.
struct TrackingTimes {
    TimeNs people = 0, parts = 0, proposals = 0, fit = 0, filter = 0;
    [[nodiscard]] TimeNs total() const { return people + parts + proposals + fit + filter; }
};

/// Depth pictures to bodies: people are found, their pixels get body parts, joints are proposed
/// where parts gather, and a jointed model is fitted and carried through time. Deterministic; one
/// thread at a time.
class BodyTracker {
  public:
    /// `rays`: as PeopleFinder::create(). The forest's labels must be those of BodyPart. Fails for
    /// other forests, for unknown filters and where PeopleFinder::create() fails.
    [[nodiscard]] static Result<BodyTracker> create(Image<RayXy> rays,
                                                    std::shared_ptr<const Forest> forest,
                                                    const BodyTrackerOptions& options = {});
    ~BodyTracker();
    BodyTracker(BodyTracker&&) noexcept;
    BodyTracker& operator=(BodyTracker&&) noexcept;

    /// As PeopleFinder::find(). Fills `out` with filtered joints, depth-camera space; every
    /// position is finite whatever the picture holds.
    void track(const Image<float>& depth_m, TimeNs time,
               const std::optional<glm::vec3>& specific_force, BodyFrame& out);

    /// As of the last track().
    [[nodiscard]] const PeopleFrame& people() const;
    [[nodiscard]] const BodyFrame& unfiltered() const;
    [[nodiscard]] const TrackingTimes& times() const;

    void reset();

  private:
    struct State;
    explicit BodyTracker(std::unique_ptr<State> state);
    std::unique_ptr<State> state_;
};

}  // namespace kino
