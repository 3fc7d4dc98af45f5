#include "sensor/session/session_text.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "sensor/json_cursor.h"
#include "sensor/session/stream_format.h"

namespace kino {
namespace {

using nlohmann::json;
using Limits = std::numeric_limits<std::int64_t>;

// The shortest text that reads back to the same bits; "-0" alone would read back as a whole number.
template <class T>
std::string number(T value) {
    if (!std::isfinite(value)) return "null";
    std::string text = fmt::format("{}", value);
    if (text == "-0") text = "-0.0";
    return text;
}

std::string quoted(const std::string& text) {
    return json(text).dump(-1, ' ', true, json::error_handler_t::replace);
}

Result<double> number_of(const JsonCursor& cursor, const json& value) {
    if (value.is_null()) return std::numeric_limits<double>::quiet_NaN();
    return cursor.number();
}

Result<std::int64_t> integer(const JsonCursor& object, const char* key) {
    KINO_ASSIGN(const JsonCursor member, object.member(key));
    return member.integer(Limits::min(), Limits::max());
}

/// The one form in which details are kept; empty for anything but an object of plain values.
std::string detail_text(const json& value) {
    if (!value.is_object()) return {};
    for (const json& member : value) {
        if (member.is_structured()) return {};
    }
    return value.dump(-1, ' ', true, json::error_handler_t::replace);
}

constexpr std::array<const char*, 3> kStates = {"lost", "inferred", "tracked"};

Result<JointPosition> joint_of(const JsonCursor& cursor, const json& value) {
    KINO_ASSIGN(const auto items, cursor.items(5, 5));
    JointPosition joint;
    std::array<float, 4> numbers{};
    for (std::size_t i = 0; i < 4; ++i) {
        const std::size_t at = i < 3 ? i : 4;
        KINO_ASSIGN(const double read, number_of(items[at], value[at]));
        numbers[i] = static_cast<float>(read);
    }
    joint.position_m = {numbers[0], numbers[1], numbers[2]};
    joint.confidence = numbers[3];
    KINO_ASSIGN(const std::string state, items[3].text());
    for (std::size_t i = 0; i < kStates.size(); ++i) {
        if (state == kStates[i]) {
            joint.state = static_cast<JointState>(i);
            return joint;
        }
    }
    return items[3].error(fmt::format("\"{}\" is not a state of a joint", state));
}

}  // namespace

std::string motion_to_text(const MotionFrame& frame) {
    const auto& a = frame.acceleration_m_s2;
    return fmt::format(R"({{"device_ns":{},"host_ns":{},"sequence":{},"lost_before":{},)"
                       R"("acceleration_m_s2":[{},{},{}],"tilt_deg":{}}})",
                       frame.header.device_time, frame.header.host_time, frame.header.sequence,
                       frame.header.lost_before, number(a[0]), number(a[1]), number(a[2]),
                       frame.tilt_deg ? number(*frame.tilt_deg) : "null");
}

std::string bodies_to_text(const BodyFrame& frame) {
    std::string text = fmt::format(R"({{"time_ns":{},"bodies":[)", frame.time);
    for (std::size_t i = 0; i < frame.bodies.size(); ++i) {
        const Body& body = frame.bodies[i];
        text += fmt::format(R"({}{{"id":{},"joints":{{)", i == 0 ? "" : ",", body.id);
        for (std::size_t j = 0; j < kJointCount; ++j) {
            const JointPosition& joint = body.joints[j];
            text += fmt::format(R"({}"{}":[{},{},{},"{}",{}])", j == 0 ? "" : ",",
                                joint_name(static_cast<Joint>(j)), number(joint.position_m.x),
                                number(joint.position_m.y), number(joint.position_m.z),
                                kStates[static_cast<std::size_t>(joint.state) % kStates.size()],
                                number(joint.confidence));
        }
        text += "}}";
    }
    return text + "]}";
}

std::string pose_to_text(const SessionPose& pose) {
    const glm::dquat& r = pose.world_from_depth.rotation;
    const glm::dvec3& t = pose.world_from_depth.translation;
    return fmt::format(
        R"({{"time_ns":{},"rotation_wxyz":[{},{},{},{}],"translation_m":[{},{},{}]}})", pose.time,
        number(r.w), number(r.x), number(r.y), number(r.z), number(t.x), number(t.y), number(t.z));
}

std::string event_to_text(const SessionEvent& event) {
    std::string text = fmt::format(R"({{"time_ns":{},"kind":{},"text":{})", event.time,
                                   quoted(event.kind), quoted(event.text));
    if (event.stream) {
        text += fmt::format(
            R"(,"stream":"{}","device":{},"count":{},"first_sequence":{},"last_sequence":{})",
            track_name(event.stream->kind), event.stream->device, event.count, event.first_sequence,
            event.last_sequence);
    }
    if (!event.detail.empty()) {
        const auto read = parse_json(event.detail, "detail");
        const std::string detail = read ? detail_text(*read) : std::string();
        if (!detail.empty()) text += fmt::format(R"(,"detail":{})", detail);
    }
    return text + "}";
}

Result<MotionFrame> motion_from_text(std::string_view text, const std::string& where) {
    KINO_ASSIGN(const json value, parse_json(text, where));
    const JsonCursor object(value, where);
    MotionFrame frame;
    KINO_ASSIGN(frame.header.device_time, integer(object, "device_ns"));
    KINO_ASSIGN(frame.header.host_time, integer(object, "host_ns"));
    KINO_ASSIGN(frame.header.sequence, integer(object, "sequence"));
    KINO_ASSIGN(frame.header.lost_before, integer(object, "lost_before"));
    KINO_ASSIGN(const JsonCursor acceleration, object.member("acceleration_m_s2"));
    KINO_ASSIGN(const auto parts, acceleration.items(3, 3));
    for (std::size_t i = 0; i < 3; ++i) {
        KINO_ASSIGN(frame.acceleration_m_s2[i], number_of(parts[i], value["acceleration_m_s2"][i]));
    }
    if (const auto tilt = object.find("tilt_deg"); tilt && !value["tilt_deg"].is_null()) {
        KINO_ASSIGN(frame.tilt_deg, tilt->number());
    }
    return frame;
}

Result<BodyFrame> bodies_from_text(std::string_view text, const std::string& where) {
    KINO_ASSIGN(const json value, parse_json(text, where));
    const JsonCursor object(value, where);
    BodyFrame frame;
    KINO_ASSIGN(frame.time, integer(object, "time_ns"));
    KINO_ASSIGN(const JsonCursor list, object.member("bodies"));
    KINO_ASSIGN(const auto bodies, list.items(0, 64));
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        Body body;
        KINO_ASSIGN(const JsonCursor id, bodies[i].member("id"));
        KINO_ASSIGN(const std::int64_t id_number, id.integer(0, UINT32_MAX));
        body.id = static_cast<std::uint32_t>(id_number);
        KINO_ASSIGN(const JsonCursor joints, bodies[i].member("joints"));
        for (std::size_t j = 0; j < kJointCount; ++j) {
            const char* name = joint_name(static_cast<Joint>(j));
            const auto joint = joints.find(name);
            if (!joint) continue;
            KINO_ASSIGN(body.joints[j], joint_of(*joint, value["bodies"][i]["joints"][name]));
        }
        frame.bodies.push_back(body);
    }
    return frame;
}

Result<SessionPose> pose_from_text(std::string_view text, const std::string& where) {
    KINO_ASSIGN(const json value, parse_json(text, where));
    const JsonCursor object(value, where);
    SessionPose pose;
    KINO_ASSIGN(pose.time, integer(object, "time_ns"));
    const auto numbers = [&]<std::size_t kCount>(const char* key,
                                                 std::array<double, kCount>& out) -> Result<void> {
        KINO_ASSIGN(const JsonCursor member, object.member(key));
        KINO_ASSIGN(const auto items, member.items(kCount, kCount));
        for (std::size_t i = 0; i < kCount; ++i) {
            KINO_ASSIGN(out[i], items[i].number());
        }
        return {};
    };
    std::array<double, 4> r{};
    std::array<double, 3> t{};
    KINO_TRY(numbers("rotation_wxyz", r));
    KINO_TRY(numbers("translation_m", t));
    pose.world_from_depth = {glm::dquat(r[0], r[1], r[2], r[3]), {t[0], t[1], t[2]}};
    if (!is_valid(pose.world_from_depth)) return object.error("not a pose");
    return pose;
}

Result<SessionEvent> event_from_text(std::string_view text, const std::string& where) {
    KINO_ASSIGN(const json value, parse_json(text, where));
    const JsonCursor object(value, where);
    SessionEvent event;
    KINO_ASSIGN(event.time, integer(object, "time_ns"));
    KINO_TRY(object.read("kind", event.kind));
    KINO_TRY(object.read("text", event.text));
    if (const auto stream = object.find("stream")) {
        StreamId id;
        KINO_ASSIGN(const std::string name, stream->text());
        KINO_ASSIGN(id.kind, stream_kind_of(name, where));
        KINO_ASSIGN(const JsonCursor device, object.member("device"));
        KINO_ASSIGN(const std::int64_t number, device.integer(0, 1000));
        id.device = static_cast<int>(number);
        event.stream = id;
        KINO_ASSIGN(event.count, integer(object, "count"));
        KINO_ASSIGN(event.first_sequence, integer(object, "first_sequence"));
        KINO_ASSIGN(event.last_sequence, integer(object, "last_sequence"));
    }
    if (object.find("detail")) event.detail = detail_text(value["detail"]);
    return event;
}

const char* event_kind_name(EventKind kind) {
    switch (kind) {
        case EventKind::started:
            return "started";
        case EventKind::lost:
            return "lost";
        case EventKind::back:
            return "back";
        case EventKind::gesture:
            return "gesture";
        case EventKind::ended:
            break;
    }
    return "ended";
}

std::string source_to_text(const SourceInfo& source) {
    json streams = json::array();
    for (const StreamInfo& stream : source.streams) {
        streams.push_back({{"stream", track_name(stream.id.kind)},
                           {"device", stream.id.device},
                           {"width", stream.width},
                           {"height", stream.height},
                           {"nominal_hz", stream.nominal_hz},
                           {"format", stream.format}});
    }
    const json object = {{"uri", source.uri},         {"name", source.name},
                         {"serial", source.serial},   {"note", source.note},
                         {"licence", source.licence}, {"streams", std::move(streams)}};
    return object.dump(1, ' ', true, json::error_handler_t::replace) + "\n";
}

Result<SourceInfo> source_from_text(std::string_view text, const std::string& where) {
    KINO_ASSIGN(const json value, parse_json(text, where));
    const JsonCursor object(value, where);
    SourceInfo source;
    KINO_TRY(object.read("uri", source.uri));
    KINO_TRY(object.read("name", source.name));
    KINO_TRY(object.read("serial", source.serial));
    KINO_TRY(object.read("note", source.note));
    KINO_TRY(object.read("licence", source.licence));
    return source;
}

}  // namespace kino
