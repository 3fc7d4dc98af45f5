#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "apps/pipeline/processed_frame.h"
#include "apps/pipeline/time_series.h"
#include "apps/replay_options.h"
#include "apps/viewer/frame_budget.h"
#include "apps/viewer/true_error.h"
#include "sensor/source.h"
#include "viz/gpu/device.h"

namespace kino {

/// Who was seen in a run, and what they did.
struct BodySummary {
    struct Seen {
        std::int64_t frame = 0;  ///< on the timeline
        GestureEvent event;
    };
    std::map<std::size_t, std::int64_t> frames_with;  ///< so many people: frames
    std::set<std::uint32_t> ids;
    std::vector<Seen> gestures;
    TimeSeries total, people, parts, proposals, fit, filter;

    void add(const ProcessedFrame& frame);
};

/// What was on the stage in the last frame.
struct StageSummary {
    std::size_t lights = 0;  ///< local ones
    std::size_t meshes = 0;
};

/// What drawing below full quality lost, over the pictures that were compared.
struct TrueErrorSummary {
    std::int64_t pictures = 0;
    double mean_flip = 0, worst_flip = 0;
    double worst_psnr_db = 0;  ///< of pictures that differ at all; 0: none did
    double worst_failed_pixels = 0;

    void add(const TrueError& error);
};

/// What is known about one source at the end of a headless run.
struct SourceSummary {
    // The same in every stepped run on the same device:
    SourceInfo info;
    LoopMode loop = LoopMode::loop;
    ColorMode color = ColorMode::captured;
    std::int64_t frames = 0;
    std::int64_t errors = 0;
    std::int64_t points = 0;          ///< of the last frame
    std::uint64_t pictures_hash = 0;  ///< over all pixels of all pictures
    std::vector<std::string> passes;  ///< of the last frame
    std::int64_t device_bytes = 0;
    std::string first_error;
    BodySummary bodies;
    std::optional<StageSummary> stage;         ///< empty: none was asked for
    SceneZoomBy zoom_by = SceneZoomBy::fixed;  ///< who chose the zoom of `levels`
    std::vector<FrameBudget::Logged> levels;
    std::optional<TrueErrorSummary> true_error;  ///< empty: nobody asked
    // Different every time; `arrive` is from the sensor to here, of devices only:
    TimeSeries arrive;
    TimeSeries read, color_conversion, filter, registration, render, render_device, write;
};

struct Summary {
    gpu::DeviceInfo device;
    ReplayOptions options;
    int width = 0, height = 0;  ///< px
    std::string video_codec;    ///< empty: no video
    bool interrupted = false;
    double wall_s = 0;
    std::vector<SourceSummary> sources;
};

/// "deterministic" holds what repeats bit by bit, "timing" what does not, "machine" the device.
[[nodiscard]] nlohmann::ordered_json to_json(const Summary& summary);
/// A few lines for a person.
[[nodiscard]] std::string to_text(const Summary& summary);

}  // namespace kino
