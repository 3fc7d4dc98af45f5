#pragma once

#include <memory>
#include <optional>
#include <string>

#include "apps/pipeline/processor.h"
#include "sensor/playback.h"
#include "sensor/source.h"

namespace kino {

/// A source ready to play: every stream subscribed, its calibration at work.
struct OpenedSource {
    std::unique_ptr<Source> source;
    Processor processor;
    LoopMode mode = LoopMode::loop;  ///< as asked for, else what suits the recording
};

/// Opens, subscribes, calibrates. `wanted_mode` empty: natural_loop().
[[nodiscard]] Result<OpenedSource> open_for_playing(const std::string& uri,
                                                    std::optional<LoopMode> wanted_mode = {});

/// The same for a source that is open already.
[[nodiscard]] Result<OpenedSource> prepare_for_playing(std::unique_ptr<Source> source,
                                                       std::optional<LoopMode> wanted_mode = {});

/// Reads the frame at `index` of a timeline, or whatever a live device brings next, and processes
/// it. Empty: nothing came in time.
[[nodiscard]] Result<std::optional<ProcessedFrame>> read_frame(OpenedSource& opened,
                                                               std::optional<std::int64_t> index,
                                                               TimeNs timeout);

}  // namespace kino
