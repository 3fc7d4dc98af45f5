#pragma once

#include <array>

#include "apps/demo/demo_play.h"
#include "apps/demo/hand_tracker.h"
#include "apps/stage/cast.h"

namespace kino::demo {

/// Decides what one person could be told next: first where to stand, then to wave, then one
/// lesson after the other until each was done once. A lesson that is not taken up waits till the
/// others had their turn.
class Coach {
  public:
    static constexpr double kTooNearM = 1.3, kTooFarM = 3.8, kSlackM = 0.12;
    static constexpr double kPatienceS = 25;  ///< with one lesson

    struct Moment {
        double time_s = 0, dt_s = 0;
        DemoPhase phase = DemoPhase::attract;
        const Body* body = nullptr;          ///< as the sensor has it
        const CastMember* member = nullptr;  ///< the same person on the stage
        bool mirror = false;                 ///< their left is the stage's right
        bool primary = true;                 ///< may change scenes and the view
        double painted_m = 0;
    };
    /// Somebody else: nothing was learned yet.
    void reset() { *this = {}; }
    /// Of this person. In the same step guidance() praises it.
    void hear(const GestureEvent& event);
    void step(const Moment& moment);
    [[nodiscard]] const DemoGuidance& guidance() const { return guidance_; }

  private:
    static constexpr std::size_t kLessons = 5;
    [[nodiscard]] DemoHint lesson(bool primary);
    void learn(DemoHint hint);
    void anchor(const Moment& moment);
    [[nodiscard]] double progress(const Moment& moment) const;

    DemoGuidance guidance_;
    HandTracker hands_;
    std::array<bool, kLessons> learned_{};
    std::size_t at_ = 0;
    bool near_ = false, far_ = false, just_praised_ = false;
};

}  // namespace kino::demo
