#include "skeleton/gestures/gesture_json.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <limits>

#include "sensor/json_cursor.h"

namespace kino {
namespace {

using nlohmann::json;
using Limits = std::numeric_limits<std::int64_t>;

constexpr std::array<GesturePhase, 4> kPhases = {GesturePhase::once, GesturePhase::begin,
                                                 GesturePhase::change, GesturePhase::end};
constexpr std::array<Hand, 4> kHands = {Hand::none, Hand::left, Hand::right, Hand::both};

template <class Number>
Number finite(Number value) {
    return std::isfinite(value) ? value : Number(0);
}

template <class Choice, std::size_t kCount>
Result<void> choose(const JsonCursor& object, const char* key,
                    const std::array<Choice, kCount>& choices, std::string_view (*name)(Choice),
                    Choice& out) {
    const auto at = object.find(key);
    if (!at) return {};
    KINO_ASSIGN(const std::string text, at->text());
    for (const Choice choice : choices) {
        if (name(choice) == text) {
            out = choice;
            return {};
        }
    }
    return at->error(fmt::format("\"{}\" is not known", text));
}

}  // namespace

std::string_view phase_name(GesturePhase phase) {
    constexpr std::array<std::string_view, 4> kNames = {"once", "begin", "change", "end"};
    return kNames[static_cast<std::size_t>(phase)];
}

std::string gesture_to_json(const GestureEvent& event) {
    const json object = {{"gesture", gesture_name(event.kind)},
                         {"phase", phase_name(event.phase)},
                         {"hand", hand_name(event.hand)},
                         {"body", event.body_id},
                         {"primary", event.primary},
                         {"time_ns", event.time},
                         {"start_ns", event.start_time},
                         // As a double every float keeps its bits.
                         {"confidence", static_cast<double>(finite(event.confidence))},
                         {"value", finite(event.value)},
                         {"name", event.name}};
    return object.dump(-1, ' ', true, json::error_handler_t::replace);
}

Result<GestureEvent> gesture_event_from_json(std::string_view text, const std::string& where) {
    KINO_ASSIGN(const json value, parse_json(text, where));
    const JsonCursor object(value, where);
    GestureEvent event;
    KINO_ASSIGN(const JsonCursor kind_at, object.member("gesture"));
    KINO_ASSIGN(const std::string kind_text, kind_at.text());
    const auto kind = gesture_from_name(kind_text);
    if (!kind) return kind_at.error(fmt::format("\"{}\" is no gesture", kind_text));
    event.kind = *kind;
    KINO_TRY(choose(object, "phase", kPhases, phase_name, event.phase));
    KINO_TRY(choose(object, "hand", kHands, hand_name, event.hand));
    KINO_ASSIGN(const JsonCursor body, object.member("body"));
    KINO_ASSIGN(const std::int64_t id, body.integer(0, UINT32_MAX));
    event.body_id = static_cast<std::uint32_t>(id);
    KINO_TRY(object.read("primary", event.primary));
    KINO_ASSIGN(const JsonCursor time, object.member("time_ns"));
    KINO_ASSIGN(event.time, time.integer(Limits::min(), Limits::max()));
    event.start_time = event.time;
    if (const auto start = object.find("start_ns")) {
        KINO_ASSIGN(event.start_time, start->integer(Limits::min(), event.time));
    }
    double confidence = 0;
    KINO_TRY(object.read("confidence", confidence));
    if (!(confidence >= 0 && confidence <= 1)) return object.error("confidence is not in 0 to 1");
    event.confidence = static_cast<float>(confidence);
    KINO_TRY(object.read("value", event.value));
    KINO_TRY(object.read("name", event.name));
    return event;
}

std::string gesture_text(const GestureEvent& event) {
    std::string text(event.kind == GestureKind::learned && !event.name.empty()
                         ? std::string_view(event.name)
                         : gesture_name(event.kind));
    if (event.phase == GesturePhase::begin) text += " begins";
    if (event.phase == GesturePhase::end) text += " ends";
    if (event.phase != GesturePhase::once) text += fmt::format(" at {:.2f}", event.value);
    if (event.hand == Hand::both) text += ", both hands";
    if (event.hand == Hand::left || event.hand == Hand::right) {
        text += fmt::format(", {} hand", hand_name(event.hand));
    }
    return text + fmt::format(", person {}", event.body_id);
}

Event event_of(const GestureEvent& event) {
    return {EventKind::gesture, event.time, gesture_text(event), gesture_to_json(event)};
}

}  // namespace kino
