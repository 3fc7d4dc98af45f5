#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/time.h"
#include "calibration/boards/gather.h"
#include "calibration/boards/guide_coverage.h"
#include "calibration/solve/view_information.h"

namespace kino {

struct GuideOptions {
    int views = 30;                 ///< most that are taken
    int least_views = 12;           ///< before it may say that it is enough
    int still_frames = 3;           ///< frames in a row in which the board holds still
    double still_share = 0.002;     ///< of the width: how far corners may move from frame to frame
    double different_share = 0.03;  ///< of the width: how far corners moved since every view
    double least_fall = 0.03;       ///< of the lens' expected deviations, see expected_fall()
    double noise_px = 0.3;          ///< of a corner, for those deviations
    TimeNs patience = 8 * kNsPerSecond;  ///< then it asks for something else
};

enum class GuideState {
    no_board,  ///< not seen by every camera
    blurred,
    moving,
    known,    ///< still, but such a view is there already
    holding,  ///< still and worth taking: not long enough yet
    taken,    ///< this very frame is a view
    enough    ///< nothing is missing any more, or options.views are taken
};

struct GuideAnswer {
    GuideState state = GuideState::no_board;
    bool take = false;   ///< this frame is to be kept as a view
    double fall = 0;     ///< what the view promises: expected_fall(), best of the cameras
    int new_fields = 0;  ///< of the picture, all cameras
    std::string words;   ///< what to do now, for a person
};

/// Decides while the board is moved about: which view is worth taking, when it holds still, and
/// what is missing. Pure logic: it gets sightings and times, so scripts can test it. The decisions
/// are calm: a board lost for two frames is not lost, what holds still may tremble, a picture is
/// taken once in a place, and what is asked for stays until it is met or patience is over.
class CaptureGuide {
  public:
    CaptureGuide(Board board, std::size_t cameras, GuideOptions options = {});

    /// One picture a camera, none where it took none; sizes must not change. `time` rises.
    [[nodiscard]] GuideAnswer look(const std::vector<std::optional<GatheredPicture>>& pictures,
                                   TimeNs time);

    [[nodiscard]] int taken() const { return static_cast<int>(views_.size()); }
    [[nodiscard]] bool enough() const;
    /// Null before the camera's first picture.
    [[nodiscard]] const GuideCoverage* coverage(std::size_t camera) const;
    /// Of the focal length, as the views taken promise it, percent; none before three views.
    [[nodiscard]] std::optional<double> expected_focal_percent(std::size_t camera) const;
    /// Where the last seen board stands, for drawing; none where it is not seen.
    [[nodiscard]] const std::optional<GuideCoverage::Stand>& stand(std::size_t camera) const {
        return eyes_[camera].stand;
    }

  private:
    using Pictures = std::vector<std::optional<GatheredPicture>>;
    /// What is known of one camera.
    struct Eye {
        std::optional<GuideCoverage> coverage;
        int width = 0;
        Lens lens{};
        std::optional<GuideCoverage::Stand> stand;
        LensInformation seen;  ///< by the views taken
        LensInformation now;   ///< by this frame
        std::vector<double> edge_widths;
    };

    void meet(const Pictures& pictures);
    bool sees_all(const Pictures& pictures) const;
    bool is_blurred(const Pictures& pictures) const;
    double moved_px(const Pictures& from, const Pictures& to) const;
    bool is_different(const Pictures& pictures) const;
    void follow_stillness(const Pictures& pictures);
    void take(const Pictures& pictures);
    std::optional<Pose> pose(std::size_t camera, const BoardSighting& board) const;
    const std::string& wish(TimeNs time);

    Board board_;
    GuideOptions options_;
    std::vector<glm::dvec2> corners_m_;
    std::vector<Eye> eyes_;
    std::vector<Pictures> views_;
    Pictures last_;    ///< the last frame in which all cameras saw the board
    Pictures anchor_;  ///< where it was when it came to rest
    int still_ = 0;
    int missed_ = 0;
    GuideState last_state_ = GuideState::no_board;
    std::optional<GuideCoverage::Want> want_;
    TimeNs want_since_ = 0;
};

/// The state for a person: "hold still".
[[nodiscard]] const char* words_of(GuideState state);

}  // namespace kino
