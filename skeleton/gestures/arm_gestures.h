#pragma once

#include <deque>
#include <vector>

#include "skeleton/gestures/body_space.h"
#include "skeleton/gestures/gesture_definitions.h"
#include "skeleton/gestures/gesture_event.h"
#include "skeleton/gestures/hand_motion.h"

namespace kino {

/// A gesture seen, before it is known whose it is.
struct Sighting {
    GestureKind kind = GestureKind::wave;
    GesturePhase phase = GesturePhase::once;
    Hand hand = Hand::none;
    double start_s = 0;
    double margin = 0;  ///< 0: just over the threshold; 1 and more: far over it
    double value = 0;
    std::string name;
};

/// Wave, swipes, push and dwell of one arm.
class ArmGestures {
  public:
    explicit ArmGestures(std::size_t side) : side_(side) {}
    void update(const BodyView& view, const GestureDefinitions& definitions,
                std::vector<Sighting>& out);
    void reset();
    /// The hand goes to and fro: what may become a wave is no raised hand.
    [[nodiscard]] bool waving() const { return reversals_.size() >= 2; }
    /// The hand has just made a gesture: resting where it is now is no dwell.
    void calm_dwell() { dwelled_ = true; }

  private:
    /// `hand` is measured from the elbow; `alone`: the other hand is not up, too.
    void wave(const HandSample& hand, bool alone, const WaveDefinition& d,
              std::vector<Sighting>& out);
    void stroke(const Stroke& stroke, const GestureDefinitions& d, std::vector<Sighting>& out);
    void dwell(const HandSample& hand, const DwellDefinition& d, std::vector<Sighting>& out);

    std::size_t side_;
    HandMotion motion_, against_elbow_;
    double seen_s_ = -1e9;

    double turn_x_ = 0, turn_s_ = 0;  // the furthest place since the last turning point
    int direction_ = 0;
    double from_x_ = 0;  // the turning point before
    struct Reversal {
        double time_s = 0, swing = 0;  // swing: the way to it
    };
    std::deque<Reversal> reversals_;
    double wave_ready_s_ = -1e9, stroke_ready_s_ = -1e9;

    bool dwelling_ = false, dwelled_ = false;
    glm::dvec3 dwell_at_{0};
    double dwell_from_s_ = 0;
};

/// Raising of one or both hands, and the T-pose.
class PoseGestures {
  public:
    /// `waving`: of the left and the right arm, ArmGestures::waving().
    void update(const BodyView& view, const std::array<bool, 2>& waving,
                const GestureDefinitions& definitions, std::vector<Sighting>& out);
    void reset() { *this = {}; }

  private:
    void raise(const BodyView& view, const std::array<bool, 2>& waving, const RaiseDefinition& d,
               std::vector<Sighting>& out);
    void t_pose(const BodyView& view, const TPoseDefinition& d, std::vector<Sighting>& out);

    /// The hand has been up for long enough, and calm.
    [[nodiscard]] bool held(const BodyView& view, std::size_t side, const RaiseDefinition& d) const;

    std::array<bool, 2> up_{}, told_{};
    std::array<std::deque<std::pair<double, glm::dvec3>>, 2> way_;  // while up, the last hold_s
    std::array<double, 2> since_s_{};
    bool told_both_ = false;
    double raise_ready_s_ = -1e9;
    bool tee_ = false, told_tee_ = false;
    double tee_since_s_ = 0;
};

/// Zoom and rotation with two hands.
class TwoHandGestures {
  public:
    void update(const BodyView& view, const TwoHandDefinition& d, std::vector<Sighting>& out);
    void reset() { *this = {}; }
    [[nodiscard]] bool active() const { return zoom_ || rotate_; }
    /// Ends what goes on.
    void stop(std::vector<Sighting>& out);

  private:
    bool in_zone_ = false, zoom_ = false, rotate_ = false;
    double since_s_ = 0, seen_s_ = 0, begin_s_ = 0;
    std::array<HandMotion, 2> motion_;
    glm::dvec3 base_middle_{0};
    double base_distance_ = 0, base_angle_ = 0, angle_ = 0;
    double zoom_value_ = 1, rotate_value_ = 0;
};

}  // namespace kino
