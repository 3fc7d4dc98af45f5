#pragma once

#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "apps/calibrate/board_source.h"
#include "apps/calibrate/session_shots.h"
#include "calibration/boards/capture_guide.h"

namespace kino {

/// One frame of a guided capture, as it is shown.
struct GuidedFrame {
    const FrameSet& set;
    const std::vector<std::string>& cameras;
    const BoardSource::Pictures& pictures;
    const BoardSource::Look& look;
    const CaptureGuide& guide;
    const GuideAnswer& answer;
    TimeNs detection = 0;  ///< what finding the board took
};

/// Where a guided capture is shown: a window, or lines on a terminal.
class GuideScreen {
  public:
    virtual ~GuideScreen() = default;
    /// False: the user has had enough.
    [[nodiscard]] virtual Result<bool> show(const GuidedFrame& frame) = 0;
    /// While nothing comes; as above.
    [[nodiscard]] virtual Result<bool> idle() = 0;
    /// Recordings are played as if they were live.
    [[nodiscard]] virtual bool wants_real_time() const = 0;
};

/// What there is to say, a line whenever it changes.
class GuideLinesScreen : public GuideScreen {
  public:
    explicit GuideLinesScreen(std::function<void(std::string_view)> say) : say_(std::move(say)) {}
    [[nodiscard]] Result<bool> show(const GuidedFrame& frame) override;
    [[nodiscard]] Result<bool> idle() override { return true; }
    [[nodiscard]] bool wants_real_time() const override { return false; }

  private:
    std::function<void(std::string_view)> say_;
    std::string last_;
};

struct GuidedCaptureOptions {
    GuideOptions guide;
    std::int64_t frames = std::numeric_limits<std::int64_t>::max();  ///< at most
    TimeNs duration = std::numeric_limits<TimeNs>::max();            ///< at most, host clock
};

/// Plays a device, or a session as if it were one, and takes the views that the guide chooses.
/// Ends with the source, with Ctrl-C, when the guide says that it is enough, or the screen.
[[nodiscard]] Result<Shots> guided_shots(const std::string& uri, const Board& board,
                                         const GuidedCaptureOptions& options, GuideScreen& screen,
                                         std::vector<ViewDepth>& depth,
                                         std::vector<std::string>& notes);

}  // namespace kino
