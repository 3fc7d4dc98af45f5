#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "skeleton/gestures/gesture_template.h"

namespace kino {

// Lengths are in arm lengths of the person, in the body's axes (body_space.h): x to the person's
// left, y up along the trunk, z where the chest faces, origin in the middle of the shoulders.

struct TrackingDefinition {
    double smoothing_s = 0.15;    ///< window over which a hand's place and speed are fitted
    double max_turn_deg = 60;     ///< of the chest from the sensor; beyond it no gestures
    double max_walk_per_s = 0.9;  ///< of the trunk; faster people make no gestures
    double max_gap_s = 0.3;       ///< without a trunk or hand; after it detectors start anew
};
struct WaveDefinition {
    double min_swing = 0.15;  ///< between turning points, hand against elbow, along x
    double reversals = 4;
    double large_swing = 0.45;   ///< where every swing is at least this
    double large_reversals = 3;  ///< so many are enough
    double window_s = 2.0;
    double hand_above_elbow = 0.15;
    double cooldown_s = 1.5;
};
/// A stroke is what a hand does from rest to rest.
struct StrokeDefinition {
    double start_speed_per_s = 1.3, stop_speed_per_s = 0.8;
    double min_s = 0.1, max_s = 0.9;
    double cooldown_s = 0.7;
};
struct SwipeDefinition {
    double min_travel = 0.5;
    double max_across = 0.5;     ///< share of the travel, along the other axis of the picture
    double max_depth = 0.8;      ///< share of the travel, along z
    double zone_forward = 0.45;  ///< the whole stroke is in front of this
    double zone_up = -0.5;       ///< and above this
};
struct PushDefinition {
    double min_travel = 0.35;
    double max_aside = 0.7;   ///< share of the travel, along x and y
    double min_reach = 0.65;  ///< z at the end
    double zone_up = -0.7;
};
struct RaiseDefinition {
    double hand_above_head = 0.1, release_above_head = -0.1;
    double elbow_above_shoulder = 0.3;
    double max_aside = 0.5;  ///< of the hand from its shoulder, along x
    double max_stir = 0.3;   ///< of the hand from where it is, during the last hold_s
    double hold_s = 0.6;
    double cooldown_s = 0.7;
};
struct TwoHandDefinition {
    double zone_forward = 0.55, zone_up = -0.45;
    double settle_s = 0.25;     ///< both hands in the zone before anything begins
    double min_stretch = 0.25;  ///< change of the distance that begins a zoom
    double min_turn_deg = 25;   ///< turn that begins a rotation
    double max_drift = 0.25;    ///< of the middle of the hands before the begin
    double release_s = 0.15;    ///< a hand out of the zone for this long ends it
};
struct DwellDefinition {
    double radius = 0.10, release_radius = 0.22;
    double hold_s = 1.2;
    double zone_forward = 0.6, zone_up = -0.4;
};
struct TPoseDefinition {
    double min_reach = 0.75, release_reach = 0.6;  ///< of each hand from its shoulder, along x
    double max_off = 0.3, release_off = 0.45;      ///< of each hand from that line
    double hold_s = 1.0;
};
struct PrimaryDefinition {
    double lost_s = 1.5;          ///< out of view for this long: released
    double max_distance_m = 4.2;  ///< of the shoulders from the sensor
    double leave_s = 2.0;         ///< further away for this long: released
    double offer_s = 5.0;         ///< after the primary user waves again, another's wave takes over
};

/// Everything the recogniser goes by; the defaults are compiled in and listed in docs/gestures.md.
struct GestureDefinitions {
    TrackingDefinition tracking;
    WaveDefinition wave;
    StrokeDefinition stroke;
    SwipeDefinition swipe;
    PushDefinition push;
    RaiseDefinition raise;
    TwoHandDefinition two_hand;
    DwellDefinition dwell;
    TPoseDefinition t_pose;
    PrimaryDefinition primary;
    std::vector<GestureTemplate> learned;
};

/// {"kinoscope_gestures": 1, "wave": {"min_swing": 0.2}, ..., "learned": [...]}: what is not there
/// keeps its default. Unknown keys, wrong types, values out of range and thresholds whose release
/// is on the wrong side are errors that name the JSON pointer within `where`.
[[nodiscard]] Result<GestureDefinitions> gestures_from_json(std::string_view text,
                                                            const std::string& where);
/// All values; gestures_from_json() reads it back to the same.
[[nodiscard]] std::string gestures_to_json(const GestureDefinitions& definitions);

}  // namespace kino
