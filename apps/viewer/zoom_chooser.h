#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "apps/viewer/zoom_work.h"
#include "base/time.h"
#include "viz/frame/renderer.h"
#include "viz/quality/zoom/cost_model.h"
#include "viz/quality/zoom/zoom_choice.h"
#include "viz/scene/scene_file.h"

namespace kino {

/// "reactive"; "fixed" where nobody chooses.
[[nodiscard]] const char* zoom_by_name(SceneZoomBy by);

struct ZoomChooserOptions {
    SceneZoomBy by = SceneZoomBy::fixed;  ///< fixed: nobody chooses
    double target_ms = 1000.0 / 30;       ///< of a picture; not for `head`
    int most = 4;
};

/// Chooses how coarse whole pictures are, where a frame budget does not: from the last frames'
/// times, from work that is counted before the frame, or from how fast the viewer moves.
class ZoomChooser {
  public:
    explicit ZoomChooser(const ZoomChooserOptions& options) { set(options); }

    /// The zoom of the frame that is about to be drawn at `now`, and has groups of passes measured
    /// as far as it wants to know them (frame.timing). `head_m_s`: velocity of the viewer's head,
    /// where one is followed; else the camera's own motion counts. Sets nothing where it is off.
    int begin_frame(const Scene& scene, const View& view, TimeNs now,
                    const std::optional<glm::dvec3>& head_m_s, FrameOptions& frame);
    /// `frame_ms`: the whole of it. `says_nothing`: a cut, a resize, a screenshot.
    void frame_took(const FrameResult& result, double frame_ms, bool says_nothing = false);

    [[nodiscard]] bool on() const { return options_.by != SceneZoomBy::fixed; }
    [[nodiscard]] const ZoomChooserOptions& options() const { return options_; }
    /// Learns anew.
    void set(const ZoomChooserOptions& options);
    void set_target(double ms);
    [[nodiscard]] const ZoomChoice& choice() const { return choice_; }
    /// What the last frame was expected to take; 0: not known.
    [[nodiscard]] double predicted_ms() const { return predicted_ms_; }
    /// "1/2, 28.1 ms of 33 expected", of the last choice, for people.
    [[nodiscard]] std::string words() const;

  private:
    /// One group of passes of a frame, by name and occurrence. What part of it goes with pixels is
    /// learnt from the measurements before and after a change of z, if the load stayed.
    struct Group {
        double ms = 0;           ///< newest measurement
        int z = 1;               ///< it was made at
        double part = 1;         ///< of its time at z = 1, that goes with 1/z^2
        bool part_known = true;  ///< else a guess that the first change replaces
        double mean_ms = 0;      ///< of measurements at z that are much alike
        int points = 0;          ///< in the mean
        std::int64_t frame = 0;  ///< of the newest
        double then_ms = -1;     ///< mean before the last change of z; below 0: says nothing
        int then_z = 1;
        double part_then = 1;
        [[nodiscard]] double ms_at(int zoom) const;
        void measured(double new_ms, int zoom, std::int64_t now);
    };

    [[nodiscard]] ZoomRules rules() const;
    void react(const FrameResult& result, double frame_ms);
    void learn(const FrameResult& result, double frame_ms);
    void calibrate(const FrameResult& result, double frame_ms);
    [[nodiscard]] double enlarging_ms() const;
    [[nodiscard]] int step_head(const View& view, TimeNs now,
                                const std::optional<glm::dvec3>& head_m_s);

    ZoomChooserOptions options_;
    ZoomChoice choice_;
    double predicted_ms_ = 0;
    std::int64_t frames_ = 0;        ///< since set() or the last change of the picture's size
    std::int64_t since_change_ = 0;  ///< of z
    int late_in_a_row_ = 0;
    std::optional<glm::ivec2> size_;

    std::optional<ReactiveZoom> reactive_;
    std::map<std::string, Group> groups_;
    double rest_ms_ = -1;  ///< of a frame, beside its groups; below 0: not known

    std::optional<PredictiveZoom> predictive_;  ///< once calibrated
    WorkCounter counter_;
    FrameWork work_;
    int calibrated_ = 0;  ///< frames
    ZoomWorkCosts start_;
    bool was_surprised_ = false;
    double copy_ms_ = -1;  ///< measured; below 0: not yet

    std::optional<HeadSpeedZoom> head_;
    std::optional<View> last_view_;
    TimeNs last_time_ = 0;
};

}  // namespace kino
