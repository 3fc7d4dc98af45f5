#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/demo_sources/device_watch.h"
#include "apps/pipeline/live_runner.h"

namespace kino {

enum class ShowMode : std::uint8_t {
    live,     ///< the sensor, or the recording that was asked for
    attract,  ///< the performance: nobody is in front of the sensor, or there is none
    lost      ///< the sensor went away
};

struct SourceDeskOptions {
    DeviceWatch::Open open_live;         ///< the sensor, or what was asked for
    DeviceWatch::Open open_performance;  ///< played meanwhile
    bool waits = false;  ///< a sensor may come later; else open_live is asked once, and must give
    TimeNs attract_after = 20 * kNsPerSecond;  ///< with nobody in front of the sensor
    int frames_to_return = 5;                  ///< with somebody there, in a row
    TimeNs look_every = 3 * kNsPerSecond;      ///< for a sensor
};

/// Decides what the demo shows: the sensor; the performance while nobody is there; that the sensor
/// was lost. What is not played is closed, except the sensor, which watches for people.
class SourceDesk {
  public:
    /// Fails where what must open does not.
    [[nodiscard]] static Result<std::unique_ptr<SourceDesk>> create(SourceDeskOptions options);

    struct Shown {
        ShowMode mode = ShowMode::live;
        bool cut = false;  ///< another source than last time
        std::optional<ProcessedFrame> fresh;
        std::vector<GestureEvent> gestures;  ///< of this source, since last time
    };
    /// Once a loop. `now`: a clock that does not jump.
    [[nodiscard]] Shown step(TimeNs now);

    [[nodiscard]] bool has_sensor() const { return live_ != nullptr; }
    /// What is shown now comes from a device, whose frames carry the host's clock.
    [[nodiscard]] bool shows_device() const { return mode_ == ShowMode::live && is_device_; }
    /// Whoever looks for one has come back empty-handed once; before, nothing is known.
    [[nodiscard]] bool knows_of_none() const { return trouble().has_value(); }
    /// Why there is no sensor, as far as that is known.
    [[nodiscard]] std::optional<Error> trouble() const {
        return watch_ ? watch_->trouble() : std::nullopt;
    }
    /// The source that is shown now; null before there is one.
    [[nodiscard]] LiveRunner* runner();

  private:
    explicit SourceDesk(SourceDeskOptions options) : options_(std::move(options)) {}
    void take_sensor(TimeNs now);
    void watch_people(const ProcessedFrame& frame, TimeNs now);
    void choose(TimeNs now);
    void enter(ShowMode mode);

    SourceDeskOptions options_;
    std::unique_ptr<DeviceWatch> watch_;  ///< while there is no sensor
    std::unique_ptr<LiveRunner> live_, performance_;
    bool is_device_ = false;
    ShowMode mode_ = ShowMode::live;
    bool cut_ = true;
    bool started_ = false;
    TimeNs seen_ = 0;  ///< somebody, by the sensor
    int in_a_row_ = 0;
};

}  // namespace kino
