#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/pipeline/body_stage.h"
#include "apps/pipeline/found_calibration.h"
#include "apps/pipeline/processor.h"
#include "sensor/playback.h"
#include "sensor/source.h"

namespace kino {

/// A source ready to play: every stream subscribed, its calibration at work.
struct OpenedSource {
    std::unique_ptr<Source> source;
    Processor processor;
    LoopMode mode = LoopMode::loop;       ///< as asked for, else what suits the recording
    std::vector<StreamId> streams;        ///< that are subscribed
    BodyOptions body_options;             ///< what switching bodies on goes by
    std::unique_ptr<BodyStage> bodies{};  ///< null: off
    FoundCalibration calibration{};       ///< of the source's own pictures, before any filter
};

/// How a source is to be played.
struct PlayOptions {
    std::optional<LoopMode> mode;  ///< empty: natural_loop()
    std::string filters;           ///< as DepthFilterChain::parse() reads them
    BodyOptions bodies;
    std::string calibration{};  ///< as find_calibration() reads it
};

/// Subscribes to every stream; a device's that exclude each other as far as they go together, in
/// the order in which it lists them. Returns those that were subscribed.
[[nodiscard]] Result<std::vector<StreamId>> subscribe_what_goes(Source& source);

/// Opens, subscribes, calibrates; says on stderr which file the calibration came from, if any.
/// Streams that cannot be had beside the others (a Kinect v1 sends colour or infrared) are left
/// out.
[[nodiscard]] Result<OpenedSource> open_for_playing(const std::string& uri,
                                                    const PlayOptions& options = {});

/// The same for a source that is open already.
[[nodiscard]] Result<OpenedSource> prepare_for_playing(std::unique_ptr<Source> source,
                                                       const PlayOptions& options = {});

/// Reads the frame at `index` of a timeline, or whatever a live device brings next, and processes
/// it. Empty: nothing came in time. `on_set`: sees the set before it is processed.
[[nodiscard]] Result<std::optional<ProcessedFrame>> read_frame(
    OpenedSource& opened, std::optional<std::int64_t> index, TimeNs timeout,
    const std::function<void(const FrameSet&)>& on_set = {});

/// The gestures among a source's events.
[[nodiscard]] std::vector<GestureEvent> gestures_in(const std::vector<Event>& events);

}  // namespace kino
