#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "sensor/convert/frame_sink.h"
#include "sensor/session/session_reader.h"
#include "sensor/source.h"

namespace kino {

/// Frames of the leading stream, by number.
struct ConvertRange {
    std::int64_t from = 0;
    std::optional<std::int64_t> count;  ///< none: to the end
};

struct ConvertReport {
    std::int64_t frames = 0;      ///< of the leading stream, read
    std::int64_t unreadable = 0;  ///< frames that could not be read and are left out
    std::string first_problem;    ///< of those
};

/// Told after every leading frame; false stops the conversion.
using ConvertWatch = std::function<bool(std::int64_t done, std::int64_t total)>;

/// Feeds a recording to a sink and finishes that. `source` has all its streams subscribed and a
/// timeline. `session`: the same recording's frames one by one, so that not only those beside a
/// leading frame are kept; null for sources that are no session. Fails, and leaves nothing behind,
/// where the sink fails, the range is empty or `watch` stops it.
[[nodiscard]] Result<ConvertReport> convert_recording(Source& source, SessionReader* session,
                                                      FrameSink& sink, const ConvertRange& range,
                                                      const ConvertWatch& watch = {});

}  // namespace kino
