#pragma once

#include <string>
#include <string_view>

#include "base/error.h"
#include "sensor/source.h"
#include "skeleton/gestures/gesture_event.h"

namespace kino {

/// The `detail` of docs/session-format.md, ASCII. What is not finite becomes 0.
[[nodiscard]] std::string gesture_to_json(const GestureEvent& event);

/// Any text is safe. Keys that are not known are passed over; those that are not there but for
/// "gesture", "body" and "time_ns" have the values of GestureEvent{}, and start_time is time.
/// Fails for unknown names of gestures, phases and hands.
[[nodiscard]] Result<GestureEvent> gesture_event_from_json(std::string_view text,
                                                           const std::string& where);

/// For a person: "wave, right hand, person 2".
[[nodiscard]] std::string gesture_text(const GestureEvent& event);

/// The way gestures take into sessions and out of them.
[[nodiscard]] Event event_of(const GestureEvent& event);

[[nodiscard]] std::string_view phase_name(GesturePhase phase);

}  // namespace kino
