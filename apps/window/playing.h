#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "apps/pipeline/live_runner.h"

namespace kino {

struct PlayingOptions {
    std::optional<LoopMode> loop;
    double speed = 1;
    std::string filters;  ///< as DepthFilterChain::parse() reads them
    BodyOptions bodies;
    bool wants_people = false;  ///< bodies are looked for where none are recorded
    std::string calibration{};  ///< as find_calibration() reads it
    bool stepped = false;       ///< the clock waits for the pictures instead of the other way round
};

/// One source being played in the window, live or stepped.
class Playing {
  public:
    [[nodiscard]] static Result<std::unique_ptr<Playing>> open(const std::string& uri,
                                                               const PlayingOptions& options);

    [[nodiscard]] LiveRunner& runner() { return *runner_; }
    [[nodiscard]] const SourceInfo& info() const { return info_; }
    [[nodiscard]] const RigParameters& rig() const { return rig_; }

    /// The newest frame, if there is a new one. Stepped: waits for the one that is due.
    [[nodiscard]] std::optional<ProcessedFrame> take();
    /// A picture was shown: stepped, the clock moves on to the next frame.
    void picture_shown();

    /// Ends it. What was recorded, for a person; empty if nothing was.
    [[nodiscard]] std::string stop();

    /// Its frames come when they come: it has no timeline.
    [[nodiscard]] bool is_device() const { return times_.empty(); }
    [[nodiscard]] bool is_stepped() const { return stepped_; }
    /// Recorded time of frame `index` from the start; 0 for devices.
    [[nodiscard]] TimeNs time_of(std::int64_t index) const;
    /// All of one round of the loop; 0 for devices.
    [[nodiscard]] TimeNs round() const;

  private:
    Playing() = default;

    SourceInfo info_;
    RigParameters rig_;
    std::vector<TimeNs> times_;
    TimeNs last_duration_ = 0;
    bool stepped_ = false;
    std::int64_t taken_ = -1;
    std::shared_ptr<std::atomic<TimeNs>> stepped_clock_;
    std::unique_ptr<LiveRunner> runner_;
};

}  // namespace kino
