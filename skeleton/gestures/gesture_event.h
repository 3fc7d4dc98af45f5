#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "base/time.h"

namespace kino {

/// Left and right are the person's own: a swipe to the left goes to the person's left.
enum class GestureKind : std::uint8_t {
    wave,
    swipe_left,
    swipe_right,
    swipe_up,
    swipe_down,
    push,
    raise,
    raise_both,
    zoom,    ///< continuous; value: distance of the hands over that at the begin
    rotate,  ///< continuous; value: turn since the begin, rad, positive clockwise as the person
             ///< sees their own hands (the left one goes up)
    dwell,
    t_pose,
    learned,   ///< GestureEvent::name says which
    engaged,   ///< the body became the primary user
    released,  ///< the body stopped being it
};
constexpr std::size_t kGestureKindCount = 15;

[[nodiscard]] std::string_view gesture_name(GestureKind kind);
[[nodiscard]] std::optional<GestureKind> gesture_from_name(std::string_view name);

enum class Hand : std::uint8_t { none, left, right, both };
[[nodiscard]] std::string_view hand_name(Hand hand);

/// Discrete gestures happen `once`; continuous ones begin, change with every frame, and end.
enum class GesturePhase : std::uint8_t { once, begin, change, end };

struct GestureEvent {
    GestureKind kind = GestureKind::wave;
    GesturePhase phase = GesturePhase::once;
    Hand hand = Hand::none;
    std::uint32_t body_id = 0;
    bool primary = false;   ///< the body was the primary user
    TimeNs time = 0;        ///< of the frame that decided it
    TimeNs start_time = 0;  ///< when the movement began; <= time
    float confidence = 0;   ///< 0..1
    double value = 0;       ///< of continuous gestures
    std::string name;       ///< of learned gestures

    friend bool operator==(const GestureEvent&, const GestureEvent&) = default;
};

}  // namespace kino
