#pragma once

#include <array>
#include <glm/vec3.hpp>
#include <memory>
#include <string>
#include <string_view>

#include "base/body.h"
#include "base/error.h"

namespace kino {

/// What every filter does alike about joints that come and go.
struct JointGate {
    /// A joint back within this time goes on where it was; after it the joint starts anew.
    double max_gap_s = 0.2;
    /// predict() looks no further ahead of the last reading, s.
    double max_prediction_s = 0.2;
    /// Readings further from the sensor than this, or not finite, count as lost, m.
    double max_distance_m = 100;
};

/// Steadies the 20 joints of one person. Positions in depth-camera space, metres, or in any frame
/// that stands still. What comes out is finite whatever goes in.
///
/// A joint that is lost keeps the state `lost` and confidence 0; its position is where the filter
/// expects it for max_gap_s and then stays. An inferred joint is filtered more strongly and stays
/// inferred. Not thread-safe; one object for each person.
class BodyFilter {
  public:
    virtual ~BodyFilter() = default;

    /// The filtered body at `time`. A time that is not after the last one is a jump of the
    /// recording: the same time repeats the last result, an earlier one starts anew, as does
    /// another body's id.
    Body update(const Body& measured, TimeNs time);

    /// Where the joints are expected at `time`: at or after the last update, at most
    /// max_prediction_s ahead. Before the first update: a body that is lost.
    [[nodiscard]] Body predict(TimeNs time) const;

    void reset() { started_ = false; }

  protected:
    explicit BodyFilter(const JointGate& gate) : gate_(gate) {}
    BodyFilter(const BodyFilter&) = default;
    BodyFilter& operator=(const BodyFilter&) = default;

    /// Forgets joint `j`, which is now at `at`.
    virtual void start(std::size_t j, const glm::dvec3& at) = 0;
    /// A reading dt_s > 0 after the last one; returns the filtered position.
    virtual glm::dvec3 step(std::size_t j, const glm::dvec3& at, bool inferred, double dt_s) = 0;
    /// Expected position ahead_s >= 0 after the last reading.
    [[nodiscard]] virtual glm::dvec3 ahead(std::size_t j, double ahead_s) const = 0;

  private:
    [[nodiscard]] bool usable(const JointPosition& joint) const;
    void coast(std::size_t j, TimeNs time);

    JointGate gate_;
    bool started_ = false;
    TimeNs time_ = 0;
    Body last_;
    std::array<bool, kJointCount> live_{};
    std::array<TimeNs, kJointCount> seen_{};
};

/// "none", "holt:default", "holt:somewhat-latent", "holt:very-smooth", "one-euro:default",
/// "one-euro:calm", "one-euro:quick", "kalman:default", "kalman:calm", "kalman:quick"; the name
/// alone means its default. "none" gives null. Unknown names are errors that list what there is.
[[nodiscard]] Result<std::unique_ptr<BodyFilter>> make_body_filter(std::string_view name);

}  // namespace kino
