#include "skeleton/gestures/gesture_definitions.h"

#include <fmt/format.h>

#include <algorithm>
#include <span>

#include "sensor/json_cursor.h"
#include "skeleton/gestures/template_json.h"

namespace kino {
namespace {

using nlohmann::json;
using nlohmann::ordered_json;

// Calls f(section, key, value, least, most) for every number there is.
template <class D, class F>
void each_number(D& d, F f) {
    auto& k = d.tracking;
    f("tracking", "smoothing_s", k.smoothing_s, 0.05, 0.5);
    f("tracking", "max_turn_deg", k.max_turn_deg, 1, 180);
    f("tracking", "max_walk_per_s", k.max_walk_per_s, 0.1, 100);
    f("tracking", "max_gap_s", k.max_gap_s, 0.05, 5);
    auto& w = d.wave;
    f("wave", "min_swing", w.min_swing, 0.02, 2);
    f("wave", "reversals", w.reversals, 2, 20);
    f("wave", "large_swing", w.large_swing, 0.02, 3);
    f("wave", "large_reversals", w.large_reversals, 2, 20);
    f("wave", "window_s", w.window_s, 0.2, 10);
    f("wave", "hand_above_elbow", w.hand_above_elbow, -1, 1);
    f("wave", "cooldown_s", w.cooldown_s, 0, 60);
    auto& s = d.stroke;
    f("stroke", "start_speed_per_s", s.start_speed_per_s, 0.1, 20);
    f("stroke", "stop_speed_per_s", s.stop_speed_per_s, 0.05, 20);
    f("stroke", "min_s", s.min_s, 0, 5);
    f("stroke", "max_s", s.max_s, 0.05, 5);
    f("stroke", "cooldown_s", s.cooldown_s, 0, 60);
    auto& w4 = d.swipe;
    f("swipe", "min_travel", w4.min_travel, 0.1, 2);
    f("swipe", "max_across", w4.max_across, 0.05, 5);
    f("swipe", "max_depth", w4.max_depth, 0.05, 5);
    f("swipe", "zone_forward", w4.zone_forward, -2, 1);
    f("swipe", "zone_up", w4.zone_up, -2, 1);
    auto& p = d.push;
    f("push", "min_travel", p.min_travel, 0.1, 2);
    f("push", "max_aside", p.max_aside, 0.05, 5);
    f("push", "min_reach", p.min_reach, 0, 1);
    f("push", "zone_up", p.zone_up, -2, 1);
    auto& r = d.raise;
    f("raise", "hand_above_head", r.hand_above_head, -1, 1);
    f("raise", "release_above_head", r.release_above_head, -1, 1);
    f("raise", "elbow_above_shoulder", r.elbow_above_shoulder, -1, 1);
    f("raise", "max_aside", r.max_aside, 0.1, 2);
    f("raise", "max_stir", r.max_stir, 0.05, 4);
    f("raise", "hold_s", r.hold_s, 0, 10);
    f("raise", "cooldown_s", r.cooldown_s, 0, 60);
    auto& two = d.two_hand;
    f("two_hand", "zone_forward", two.zone_forward, -2, 1);
    f("two_hand", "zone_up", two.zone_up, -2, 1);
    f("two_hand", "settle_s", two.settle_s, 0, 5);
    f("two_hand", "min_stretch", two.min_stretch, 0.02, 2);
    f("two_hand", "min_turn_deg", two.min_turn_deg, 1, 180);
    f("two_hand", "max_drift", two.max_drift, 0.02, 4);
    f("two_hand", "release_s", two.release_s, 0, 5);
    auto& h = d.dwell;
    f("dwell", "radius", h.radius, 0.01, 1);
    f("dwell", "release_radius", h.release_radius, 0.01, 2);
    f("dwell", "hold_s", h.hold_s, 0.1, 20);
    f("dwell", "zone_forward", h.zone_forward, -2, 1);
    f("dwell", "zone_up", h.zone_up, -2, 1);
    auto& t = d.t_pose;
    f("t_pose", "min_reach", t.min_reach, 0.1, 1.5);
    f("t_pose", "release_reach", t.release_reach, 0, 1.5);
    f("t_pose", "max_off", t.max_off, 0.02, 1);
    f("t_pose", "release_off", t.release_off, 0.02, 2);
    f("t_pose", "hold_s", t.hold_s, 0, 20);
    auto& u = d.primary;
    f("primary", "lost_s", u.lost_s, 0, 60);
    f("primary", "max_distance_m", u.max_distance_m, 0.5, 20);
    f("primary", "leave_s", u.leave_s, 0, 60);
    f("primary", "offer_s", u.offer_s, 0, 60);
}

Result<void> check_pairs(const GestureDefinitions& d, const JsonCursor& root) {
    const auto pair = [&](bool good, const char* section, const char* what) -> Result<void> {
        if (good) return {};
        const auto at = root.find(section);
        return (at ? *at : root).error(what);
    };
    KINO_TRY(pair(d.stroke.stop_speed_per_s <= d.stroke.start_speed_per_s, "stroke",
                  "stop_speed_per_s must not be above start_speed_per_s"));
    KINO_TRY(pair(d.stroke.min_s <= d.stroke.max_s, "stroke", "min_s must not be above max_s"));
    KINO_TRY(pair(d.raise.release_above_head <= d.raise.hand_above_head, "raise",
                  "release_above_head must not be above hand_above_head"));
    KINO_TRY(pair(d.dwell.radius <= d.dwell.release_radius, "dwell",
                  "radius must not be above release_radius"));
    KINO_TRY(pair(d.t_pose.release_reach <= d.t_pose.min_reach, "t_pose",
                  "release_reach must not be above min_reach"));
    return pair(d.t_pose.max_off <= d.t_pose.release_off, "t_pose",
                "max_off must not be above release_off");
}

// Keys of a section that the table does not have.
Result<void> check_keys(const JsonCursor& section, const json& value, const ordered_json& known) {
    if (!value.is_object()) return section.error("must be an object");
    for (const auto& [key, unused] : value.items()) {
        if (known.contains(key)) continue;
        std::string names;
        for (const auto& [name, number] : known.items())
            names += (names.empty() ? "" : ", ") + name;
        return section.error(fmt::format("unknown key \"{}\"", key), "known: " + names);
    }
    return {};
}

ordered_json numbers_of(const GestureDefinitions& definitions) {
    ordered_json out;
    each_number(definitions, [&](const char* section, const char* key, double value, double,
                                 double) { out[section][key] = value; });
    return out;
}

}  // namespace

Result<GestureDefinitions> gestures_from_json(std::string_view text, const std::string& where) {
    KINO_ASSIGN(const json document, parse_json(text, where));
    const JsonCursor root(document, where);
    KINO_TRY(root.only({"kinoscope_gestures", "tracking", "wave", "stroke", "swipe", "push",
                        "raise", "two_hand", "dwell", "t_pose", "primary", "learned"}));
    KINO_ASSIGN(const JsonCursor version, root.member("kinoscope_gestures"));
    KINO_TRY(version.integer(1, 1));

    GestureDefinitions out;
    const ordered_json known = numbers_of(out);
    for (const auto& [section, keys] : known.items()) {
        const auto cursor = root.find(section.c_str());
        if (cursor) KINO_TRY(check_keys(*cursor, document.at(section), keys));
    }
    Result<void> read{};
    each_number(
        out, [&](const char* section, const char* key, double& value, double least, double most) {
            const auto cursor = root.find(section);
            const auto member = cursor ? cursor->find(key) : std::nullopt;
            if (!member || !read) return;
            const auto number = member->number();
            if (!number) {
                read = tl::unexpected<Error>(number.error());
            } else if (*number < least || *number > most) {
                read = member->error(fmt::format("must be between {} and {}", least, most));
            } else {
                value = *number;
            }
        });
    KINO_TRY(read);
    KINO_TRY(check_pairs(out, root));
    if (const auto learned = root.find("learned")) {
        KINO_ASSIGN(const auto items, learned->items(0, 64));
        for (const JsonCursor& item : items) {
            KINO_ASSIGN(GestureTemplate one, template_from_json(item));
            for (const GestureTemplate& other : out.learned) {
                if (other.name() == one.name()) return item.error("this name is there twice");
            }
            out.learned.push_back(std::move(one));
        }
    }
    return out;
}

std::string gestures_to_json(const GestureDefinitions& definitions) {
    ordered_json out = {{"kinoscope_gestures", 1}};
    out.update(numbers_of(definitions));
    if (!definitions.learned.empty()) {
        out["learned"] = ordered_json::array();
        for (const GestureTemplate& one : definitions.learned)
            out["learned"].push_back(template_to_json(one));
    }
    return out.dump(2, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace kino
