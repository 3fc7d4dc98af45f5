#pragma once

#include <memory>
#include <optional>

#include "apps/pipeline/opened_source.h"

namespace kino {

/// Every frame in playing order, on the caller's thread, as fast as it is asked: no clock decides
/// anything, so two runs give the same bits. Tests, export and pictures use it.
class Stepper {
  public:
    explicit Stepper(OpenedSource opened);

    /// The next frame in playing order. Empty: the end of mode `once`, or of a source without a
    /// timeline. An error concerns one frame; calling again goes on with the following one. A frame
    /// that is shown again (a picture alone in its loop) is not read again.
    [[nodiscard]] Result<std::optional<ProcessedFrame>> next();

    /// How long the frame last returned is shown at speed 1.
    [[nodiscard]] TimeNs duration() const { return duration_; }
    /// Frames in one round of the loop; 0 where there is no timeline.
    [[nodiscard]] std::int64_t round() const;
    [[nodiscard]] const OpenedSource& opened() const { return opened_; }

  private:
    Result<std::optional<ProcessedFrame>> read(std::optional<std::int64_t> index);

    OpenedSource opened_;
    std::optional<Playback> order_;
    bool started_ = false;
    TimeNs duration_ = kNsPerSecond / 30;
    std::optional<ProcessedFrame> shown_;
};

}  // namespace kino
