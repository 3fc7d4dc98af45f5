#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "apps/avatar/avatar_rig.h"
#include "base/body.h"
#include "base/pose.h"
#include "base/time.h"
#include "skeleton/gestures/gesture_event.h"
#include "viz/scene/scene.h"
#include "viz/scene/view.h"

namespace kino {

struct DemoOptions {
    std::vector<std::string> scenes;  ///< names or files, in the order of swiping; empty: bundled
    std::shared_ptr<const AvatarRig> avatar;  ///< null: none, and nothing of avatars is kept
    bool live_body = true;                    ///< the depth mesh of people is shown as well
    bool mirror = true;
    std::uint64_t seed = 1;
};

/// What the demo is told of one moment.
struct DemoMoment {
    double dt_s = 0;                         ///< since the last one; brought into 0 to 0.1
    TimeNs time = 0;                         ///< of the frame, by the recording's clock
    const BodyFrame* bodies = nullptr;       ///< depth-camera space; null: nobody
    std::span<const GestureEvent> gestures;  ///< since the last moment
    Pose world_from_depth;
    std::shared_ptr<const DepthSurface> surface;  ///< null: no depth in this moment
    glm::dvec3 middle_m{0};  ///< world: where people are to be expected while nobody was seen
    bool source_lost = false;
};

enum class DemoPhase : std::uint8_t {
    attract,  ///< nobody there
    invite,   ///< somebody, who has not waved yet
    playing,
    lost  ///< the sensor is away
};
[[nodiscard]] const char* demo_phase_name(DemoPhase phase);

/// What the person in front could be told next.
enum class DemoHint : std::uint8_t {
    none,
    step_into_view,
    step_back,
    step_closer,
    wave_to_start,
    paint,       ///< move a hand
    swipe,       ///< for the next scene
    push,        ///< to throw
    two_hands,   ///< to turn and zoom
    raise_both,  ///< to clear
};
[[nodiscard]] const char* demo_hint_name(DemoHint hint);

/// Guidance to draw now.
struct DemoGuidance {
    DemoHint hint = DemoHint::none;
    double shown_s = 0;                  ///< for so long
    double progress = 0;                 ///< 0..1: how much of the gesture the tracker has seen
    std::optional<glm::dvec3> anchor_m;  ///< world: beside this joint it is drawn
    Hand hand = Hand::none;
    GestureKind praised = GestureKind::wave;  ///< gesture recognised last
    double praised_ago_s = 1e9;               ///< and when; feedback is drawn while it is fresh
    double distance_m = 0;                    ///< of the person from the sensor; 0: nobody
};

/// A line of the event log.
struct DemoEvent {
    TimeNs time = 0;
    std::string what;  ///< "engaged", "scene", "palette", "throw", "turn", "clear", ...
    std::string detail;
    std::uint32_t body_id = 0;
    friend bool operator==(const DemoEvent&, const DemoEvent&) = default;
};

/// The rules of the game: who plays, what their gestures do, what is on the stage. Knows neither
/// devices nor windows. The same moments give the same bits; no clock is asked.
class DemoPlay {
  public:
    [[nodiscard]] static Result<DemoPlay> create(DemoOptions options);
    ~DemoPlay();
    DemoPlay(DemoPlay&&) noexcept;
    DemoPlay& operator=(DemoPlay&&) noexcept;

    /// A new source: everybody leaves.
    void reset();
    void step(const DemoMoment& moment);
    /// As a swipe of the player does, whoever is there: for a host's key.
    void next_scene();
    /// What is to be drawn now; valid until the next call.
    [[nodiscard]] const Scene& scene();
    /// From where, as the hands turned it.
    [[nodiscard]] View view(int width, int height) const;

    [[nodiscard]] DemoPhase phase() const;
    [[nodiscard]] const DemoGuidance& guidance() const;
    /// A second person's, if two play.
    [[nodiscard]] const DemoGuidance* second_guidance() const;
    /// Events since the last call, oldest first.
    [[nodiscard]] std::vector<DemoEvent> take_events();
    [[nodiscard]] const std::string& scene_name() const;
    [[nodiscard]] std::size_t local_lights() const;
    /// A change of scene is under way and the curtain hides the stage: pipelines of this scene may
    /// be warmed by drawing it somewhere. Null otherwise; once a change.
    [[nodiscard]] const Scene* scene_to_warm();

  private:
    struct State;
    explicit DemoPlay(std::unique_ptr<State> state);
    std::unique_ptr<State> state_;
};

}  // namespace kino
