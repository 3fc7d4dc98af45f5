#pragma once

#include <deque>
#include <map>
#include <vector>

#include "skeleton/gestures/arm_gestures.h"
#include "skeleton/gestures/primary_user.h"

namespace kino {

/// Turns bodies into gesture events. Feed it every frame in order of time; it needs no filter
/// before it. The same frames give the same events. Not thread-safe.
class GestureRecognizer {
  public:
    explicit GestureRecognizer(GestureDefinitions definitions = {});

    /// The events this frame decided, in the order of bodies. A frame of the same time as the last
    /// gives none; an earlier one (a jump back in a recording) starts everything anew. Bodies with
    /// id 0 make no gestures.
    [[nodiscard]] std::vector<GestureEvent> update(const BodyFrame& frame);

    [[nodiscard]] std::uint32_t primary_id() const { return primary_.id(); }
    /// Hands the lock to a body, or to nobody with 0; the next update() does not report it.
    void hand_over(std::uint32_t id) { primary_.hand_over(id, time_); }
    [[nodiscard]] const GestureDefinitions& definitions() const { return definitions_; }

    /// The last `seconds` (at most 5) of a body's hands, for GestureTemplate::learn(). Empty for a
    /// body that is not there.
    [[nodiscard]] HandPath recent_hands(std::uint32_t body_id, double seconds) const;

  private:
    struct Candidate {  // of one learned gesture: the best match that goes on getting better
        double distance = 1e9, start_s = 0, time_s = 0, ready_s = -1e9;
    };
    struct Person {
        BodySpace space;
        std::array<ArmGestures, 2> arms{ArmGestures(0), ArmGestures(1)};
        PoseGestures poses;
        TwoHandGestures two_hands;
        HandPath path;
        std::vector<Candidate> learned;
        std::deque<std::pair<double, glm::dvec3>> trunk;
        std::map<GestureKind, double> ready_s;
        double seen_s = 0;
        double distance_m = 0;
        float confidence = 0;  // of the arms' joints
        bool here = false;
    };
    void observe(Person& person, const Body& body, double time_s, std::vector<Sighting>& out);
    void match(Person& person, const BodyView& view, std::vector<Sighting>& out) const;
    [[nodiscard]] bool walking(Person& person, const BodyView& view) const;
    void rest(Person& person, std::vector<Sighting>& out);

    GestureDefinitions definitions_;
    PrimaryUser primary_;
    std::map<std::uint32_t, Person> people_;
    bool started_ = false;
    TimeNs time_ = 0;
};

}  // namespace kino
