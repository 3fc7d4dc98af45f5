#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "apps/demo/demo_play.h"
#include "apps/demo_show/show_options.h"
#include "apps/pipeline/time_series.h"
#include "sensor/source.h"
#include "viz/gpu/device.h"

namespace kino {

/// A gesture, and the first picture whose play had heard of it.
struct SeenGesture {
    std::int64_t frame = 0;    ///< of the source, that decided it
    std::int64_t picture = 0;  ///< number of the picture
    TimeNs delay = 0;          ///< from that frame to the picture's, by the recording's clock
    GestureEvent event;
};

struct SeenEvent {
    std::int64_t picture = 0;
    DemoEvent event;
};

/// What is known at the end of a headless run.
struct ShowSummary {
    ShowOptions options;
    // The same in every run on the same device:
    SourceInfo source;
    std::int64_t frames = 0, errors = 0;
    std::string first_error;
    std::uint64_t pictures_hash = 0;  ///< over all pixels of all pictures
    std::vector<SeenGesture> gestures;
    std::vector<SeenEvent> events;
    std::vector<std::string> passes;  ///< of the last picture
    std::int64_t device_bytes = 0;
    std::size_t most_lights = 0, most_meshes = 0;
    bool interrupted = false;
    // Different every time:
    TimeSeries read, track, play, render;
    double wall_s = 0;
    TimeNs first_picture = 0;  ///< after the start
    gpu::DeviceInfo device;
    std::string video_codec;  ///< empty: no video
};

/// "deterministic" holds what repeats bit by bit, "timing" what does not, "machine" the device.
[[nodiscard]] nlohmann::ordered_json to_json(const ShowSummary& summary);
/// A few lines for a person.
[[nodiscard]] std::string to_text(const ShowSummary& summary);

}  // namespace kino
