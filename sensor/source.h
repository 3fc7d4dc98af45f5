#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "base/camera_model.h"
#include "base/error.h"
#include "base/frame.h"

namespace kino {

enum class StreamKind : std::uint8_t { depth, color, infrared, bodies, motion };
[[nodiscard]] const char* stream_name(StreamKind kind);

struct StreamId {
    int device = 0;
    StreamKind kind = StreamKind::depth;
    friend bool operator==(const StreamId&, const StreamId&) = default;
};

struct StreamInfo {
    StreamId id;
    int width = 0;
    int height = 0;
    double nominal_hz = 0;
    std::string format;  ///< for a person: "16 bit, 5000 per metre", "png rgb"
};

enum class EventKind : std::uint8_t { started, lost, back, ended, gesture };

struct Event {
    EventKind kind = EventKind::started;
    TimeNs time = 0;
    std::string text;    ///< for a person
    std::string detail;  ///< of a gesture: a JSON object, as gesture_to_json() writes it
};

struct SourceInfo {
    std::string uri;
    std::string name;     ///< for a person: "TUM RGB-D fr1/desk"
    std::string serial;   ///< of the device, if known
    std::string note;     ///< what the viewer must say: "depth only, roughly metric"
    std::string licence;  ///< of a recording, if stated
    std::vector<StreamInfo> streams;
    bool seated_people = false;  ///< a recording that says: nothing below the hips is to be asked
};

/// What only recordings (and the synthetic source) can do: exact random access by frame index.
/// Frame i is the i-th depth frame in device-time order. Not thread-safe: it belongs to the thread
/// that calls Source::next().
class Timeline {
  public:
    virtual ~Timeline() = default;
    [[nodiscard]] virtual std::int64_t frame_count() const = 0;  ///< >= 1
    /// Time of frame `index` relative to frame 0; strictly increasing. Index within the range.
    [[nodiscard]] virtual TimeNs time_of(std::int64_t index) const = 0;
    /// How long frame frame_count()-1 is shown, so that a loop has a period.
    [[nodiscard]] virtual TimeNs last_frame_duration() const = 0;
    /// The index that next() will return; frame_count() at the end.
    [[nodiscard]] virtual std::int64_t position() const = 0;
    /// Exact; an index outside the range is an error and moves nothing.
    virtual Result<void> seek(std::int64_t index) = 0;
};

enum class ControlKind : std::uint8_t { range, toggle, menu };

/// One knob of a device, for a slider, a tick box or a list.
struct Control {
    std::string id;    ///< "tilt", "led", "white_balance_auto", "exposure": the same on all devices
    std::string name;  ///< for a person: "tilt, degrees"
    ControlKind kind = ControlKind::range;
    double minimum = 0;
    double maximum = 1;
    double step = 1;
    double fallback = 0;            ///< the device's default
    std::vector<std::string> menu;  ///< names of 0, 1, ... for ControlKind::menu
};

/// Device knobs. Callable from any thread; a call waits for the device at most a second.
class Controls {
  public:
    virtual ~Controls() = default;
    [[nodiscard]] virtual std::vector<Control> list() const = 0;
    /// Fails for an unknown id, and where the device has gone or refuses.
    [[nodiscard]] virtual Result<double> get(const std::string& id) = 0;
    /// As get; a value outside the range is an error and changes nothing.
    virtual Result<void> set(const std::string& id, double value) = 0;
};

/// One frame of one stream.
using StreamFrame =
    std::variant<std::shared_ptr<const DepthFrame>, std::shared_ptr<const ColorFrame>,
                 std::shared_ptr<const InfraredFrame>, std::shared_ptr<const BodyFrame>,
                 std::shared_ptr<const MotionFrame>>;

/// Sees every frame of every subscribed stream in the order in which they were complete, before
/// pairing: for recorders. Called on the source's own thread; it must not wait long.
using FrameTap = std::function<void(StreamId, const StreamFrame&)>;

/// Live devices and recordings behind one face: the same frames, events and calibration query.
/// A source starts with no stream subscribed; an unsubscribed stream costs nothing (its files are
/// not read, its transfers not started).
class Source {
  public:
    virtual ~Source() = default;
    Source() = default;
    Source(const Source&) = delete;
    Source& operator=(const Source&) = delete;

    [[nodiscard]] virtual const SourceInfo& info() const = 0;
    [[nodiscard]] virtual Result<RigParameters> calibration() const = 0;
    virtual Result<void> subscribe(StreamId id) = 0;
    virtual void unsubscribe(StreamId id) = 0;

    /// The next frame set in order. Recordings return at once; live devices wait up to `timeout`.
    /// Empty: nothing came in time, or the end was reached (take_events() then holds `ended`). An
    /// error concerns this frame only; calling again goes on with the following one.
    [[nodiscard]] virtual Result<std::optional<FrameSet>> next(TimeNs timeout) = 0;

    /// Events since the last call, oldest first.
    [[nodiscard]] virtual std::vector<Event> take_events() = 0;

    /// Sets or (empty) removes the tap; on return no call to the former one is under way. False
    /// where next() already gives every frame there is (recordings): record those.
    [[nodiscard]] virtual bool set_tap(FrameTap) { return false; }

    /// Null where the source cannot do it.
    [[nodiscard]] virtual Timeline* timeline() { return nullptr; }
    [[nodiscard]] virtual Controls* controls() { return nullptr; }
};

/// Opens one kind of source. `probe` says cheaply whether the URI is its kind (by content for
/// paths, by scheme otherwise).
struct SourceOpener {
    std::string name;         ///< "TUM RGB-D folder"
    std::string uri_pattern;  ///< for help texts: "synthetic:[scene]"
    std::function<bool(const std::string& uri)> probe;
    std::function<Result<std::unique_ptr<Source>>(const std::string& uri)> open;
    /// URIs that could be opened right now (devices present, built-in scenes); may be null.
    std::function<std::vector<std::string>()> list;
};

/// Adds an opener; later ones are asked first. Rooms above sensor/ register from apps/.
void register_source(SourceOpener opener);
[[nodiscard]] const std::vector<SourceOpener>& source_openers();

/// Opens any URI: `scheme:rest`, or a path (content decides, not the extension).
[[nodiscard]] Result<std::unique_ptr<Source>> open_source(const std::string& uri);

/// Subscribes to every stream the source lists.
[[nodiscard]] Result<void> subscribe_all(Source& source);

}  // namespace kino
