#pragma once

#include <vector>

#include "skeleton/tracking/body_tracker.h"
#include "tests/skeleton/people/people_scene.h"

namespace kino::test {

/// The whole tracker with the shipped forest before people of the synthetic room.
struct TrackedScene {
    explicit TrackedScene(const RoomOptions& room = {}, const BodyTrackerOptions& options = {});

    /// One picture `step` after the last one. `spoil` changes it before it is tracked.
    void next(const std::vector<Actor>& actors);
    /// The empty room for a second, so that it is known.
    void learn_room();
    /// True joints of an actor, depth-camera space.
    [[nodiscard]] Body truth(const Actor& actor) const;

    RoomOptions room;
    PeopleScene scene;
    BodyTracker tracker;
    BodyFrame frame;
    TimeNs time = 0, step = kNsPerSecond / 30;
    std::uint64_t index = 0;
};

[[nodiscard]] BodyTracker tracker_for(const Image<RayXy>& rays,
                                      const BodyTrackerOptions& options = {});

/// Distances of the joints [first, last], mm; 300 where lost or nobody.
[[nodiscard]] std::vector<float> errors_mm(const Body& truth, const Body* found,
                                           std::size_t first = 0, std::size_t last = 19);
[[nodiscard]] float mean_of(const std::vector<float>& v);
[[nodiscard]] float quantile_of(std::vector<float> v, double q);
/// The body whose hip centre is nearest to the truth's, within a metre.
[[nodiscard]] const Body* nearest_body(const BodyFrame& frame, const Body& truth);
[[nodiscard]] bool all_finite(const BodyFrame& frame);

}  // namespace kino::test
