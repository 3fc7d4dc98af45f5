#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "apps/viewer/picture_levels.h"
#include "apps/viewer/picture_work.h"
#include "viz/graph/executor.h"
#include "viz/quality/governor/cost_model.h"

namespace kino {

/// What pictures take, learnt from those that were drawn. A frame is the sum of its groups of
/// passes: light grows with the samples that are shaded and the lights over them, reconstruction
/// and what else is done for every pixel with the pixels that are drawn, the rest with neither.
/// Until every group was measured on its own, a line through whole frames' times stands for them.
class PictureCost {
  public:
    /// Milliseconds that a frame at this level is expected to take; 0 before anything was learnt.
    [[nodiscard]] double ms(const PictureLevel& level, glm::ivec2 size,
                            const PictureWork& work = {}) const;
    /// One frame: its groups in order (FrameReport::groups; negative times: not measured) and the
    /// whole of it. `at_once`: what it says is known to be no hiccup, and replaces what was known.
    void learn(const PictureLevel& drawn, glm::ivec2 size, const PictureWork& work,
               std::span<const graph::GroupTime> groups, double frame_ms, bool at_once = false);
    /// Every group of the last frame was measured at least once.
    [[nodiscard]] bool knows_groups() const { return knows_groups_; }

    /// ms() in its parts: light, reconstruction, the other groups by name, and the rest.
    struct Part {
        std::string name;
        double ms = 0;
    };
    [[nodiscard]] std::vector<Part> parts(const PictureLevel& level, glm::ivec2 size,
                                          const PictureWork& work = {}) const;

  private:
    enum class Grows : std::uint8_t {
        with_shaded,
        with_drawn,
        picked,       ///< with the shaded samples, and only where light is resized
        resized,      ///< with the drawn pixels, and only where light is resized
        not_resized,  ///< and only where it is not
        when_zoomed,  ///< runs only then
        never
    };
    /// Of a group's time at full size `part` grows with what it grows with, and the rest does not.
    struct Group {
        std::string name;
        Grows grows = Grows::never;
        Reconstruction reconstruction = Reconstruction::geometry_aware;  ///< of resized ones
        double part = 1;
        PictureWork work;                 ///< of the newest point
        double x = 1, ms = 0;             ///< newest point: share of pixels, time
        double then_x = -1, then_ms = 0;  ///< the last one at another share; below 0: none
        std::int64_t then_frame = 0;
        int points = 0;  ///< since then

        [[nodiscard]] double at(double share) const;
        void add(double share, double measured_ms, bool at_once, std::int64_t frame);
    };
    struct Key {
        std::string text;
        Grows grows = Grows::never;
    };

    [[nodiscard]] static Key key_of(std::string_view group, int occurrence,
                                    const PictureLevel& level);
    /// Share of the picture's pixels that a group works on; below 0: it does not run.
    [[nodiscard]] static double share_for(const Group& group, const PictureLevel& level,
                                          glm::ivec2 size);
    /// How much longer a group takes with this work than with that of its newest measurement, where
    /// so many times the lights take so many times the time to the power of `lights_power`.
    [[nodiscard]] static double burden(const Group& group, const PictureWork& work,
                                       double lights_power);
    /// Rather too much than too little: what is wrong then is put right without a late frame.
    [[nodiscard]] static double safe_burden(const Group& group, const PictureWork& work);
    [[nodiscard]] static double ms_of(const Group& group, const PictureLevel& level,
                                      glm::ivec2 size, const PictureWork& work);
    [[nodiscard]] double unmeasured_ms(const PictureLevel& level, glm::ivec2 size) const;
    [[nodiscard]] double line_ms(const PictureLevel& level, glm::ivec2 size,
                                 const PictureWork& work) const;
    /// Shaded samples, as dear as they are with this work.
    [[nodiscard]] double shaded(const PictureShare& share, const PictureWork& work) const;
    void learn_line(const PictureLevel& drawn, glm::ivec2 size, const PictureWork& work,
                    double frame_ms);

    std::map<std::string, Group> groups_;
    double first_lights_ = 1;  ///< of the line
    bool knows_groups_ = false;
    double rest_ms_ = -1;  ///< host and hand-over; below 0: not learnt yet
    double frame_ms_ = 0;  ///< of the last frame
    std::int64_t frame_ = 0;
    CostModel line_{0, 0};
    bool has_line_ = false;
};

}  // namespace kino
