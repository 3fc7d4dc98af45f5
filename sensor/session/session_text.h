#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "base/error.h"
#include "base/frame.h"
#include "sensor/source.h"

namespace kino {

/// One line of a session's event track.
struct SessionEvent {
    /// "started", "lost", "back", "ended" as the source said; "gesture": of a person; "dropped":
    /// the recorder's queue was full; "refused": frames that could not be written as they were.
    std::string kind;
    TimeNs time = 0;  ///< host time
    std::string text;
    /// A JSON object whose values are no lists and no objects, ASCII, keys in order; or empty.
    std::string detail;
    std::optional<StreamId> stream;  ///< for "dropped" and "refused"
    std::int64_t count = 0;          ///< frames, for "dropped" and "refused"
    std::int64_t first_sequence = 0;
    std::int64_t last_sequence = 0;
    friend bool operator==(const SessionEvent&, const SessionEvent&) = default;
};

/// Where the depth camera stood, for recordings that know it (PoseOrigin::trajectory).
struct SessionPose {
    TimeNs time = 0;  ///< host time of the depth frame
    Pose world_from_depth;
};

/// The JSON texts of docs/session-format.md. ASCII; numbers read back to the same bits, but
/// infinities and NaN become null and read back as NaN.
[[nodiscard]] std::string motion_to_text(const MotionFrame& frame);
[[nodiscard]] std::string bodies_to_text(const BodyFrame& frame);
[[nodiscard]] std::string pose_to_text(const SessionPose& pose);
/// A detail that is not what SessionEvent says is left out.
[[nodiscard]] std::string event_to_text(const SessionEvent& event);

/// Keys that are not known are passed over.
[[nodiscard]] Result<MotionFrame> motion_from_text(std::string_view text, const std::string& where);
[[nodiscard]] Result<BodyFrame> bodies_from_text(std::string_view text, const std::string& where);
/// Fails also for a pose that is not valid.
[[nodiscard]] Result<SessionPose> pose_from_text(std::string_view text, const std::string& where);
[[nodiscard]] Result<SessionEvent> event_from_text(std::string_view text, const std::string& where);

[[nodiscard]] const char* event_kind_name(EventKind kind);

/// What SourceInfo says beside the streams, as the attachment source.json.
[[nodiscard]] std::string source_to_text(const SourceInfo& source);
/// Streams stay empty.
[[nodiscard]] Result<SourceInfo> source_from_text(std::string_view text, const std::string& where);

}  // namespace kino
