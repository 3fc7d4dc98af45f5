#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "apps/pipeline/stepper.h"

namespace kino {

/// So many frames of a device are a run, unless it is told otherwise.
constexpr std::int64_t kDeviceFrames = 300;

/// The frames of a run that nobody watches: unreadable ones are told and passed over, and a device
/// that is silent is waited for.
class FrameFeed {
  public:
    struct Hooks {
        std::function<bool()> interrupted;
        std::function<void(const Error&)> on_unreadable;
    };
    /// `most` frames, unreadable ones counted.
    FrameFeed(Stepper stepper, std::int64_t most, Hooks hooks);

    /// The next frame that could be read. Empty: that was all, or the run was interrupted. Fails
    /// where a whole round was unreadable, and where a device brought nothing for ten seconds.
    [[nodiscard]] Result<std::optional<ProcessedFrame>> next();

    /// Of the frame last returned, from 0.
    [[nodiscard]] std::int64_t index() const { return taken_ - 1; }
    [[nodiscard]] std::int64_t most() const { return most_; }
    [[nodiscard]] const Stepper& stepper() const { return stepper_; }

  private:
    Stepper stepper_;
    std::int64_t most_;
    Hooks hooks_;
    std::int64_t taken_ = 0;
    std::int64_t unreadable_in_a_row_ = 0;
    int silent_waits_ = 0;  ///< in a row
};

}  // namespace kino
