#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>

#include "base/time.h"

namespace kino {

struct HeadPredictorOptions {
    double noise_m2_s3 = 4;       ///< of the acceleration that moves a head about, q
    double near_sigma_m = 0.005;  ///< of a measurement, plus depth_sigma times its depth squared
    double depth_sigma = 0.0031;  ///< per metre: a step of the sensor's depth
    double gate_sigmas = 5;       ///< what is farther off is no measurement of this head
    int reseed_after = 3;         ///< that many refused in a row are the head, elsewhere
    TimeNs longest_gap = kNsPerSecond / 2;  ///< after it the head is lost, and begins anew
    double fastest_m_s = 3;
    TimeNs farthest = kNsPerSecond / 5;  ///< no prediction reaches farther
};

enum class HeadMeasurement : std::uint8_t {
    seeded,  ///< the first one, or the first after a gap or a jump
    taken,
    refused,  ///< beyond the gate
    skipped   ///< not later than the last one, or not a number
};

/// Where a head is and will be: a constant-velocity Kalman filter for each axis, with state (p, v),
/// transition [[1, dt], [0, 1]] and process noise q [[dt^3/3, dt^2/2], [dt^2/2, dt]] (Bar-Shalom,
/// Li, Kirubarajan, "Estimation with Applications to Tracking and Navigation", 6.2.2). Measurements
/// may come at any times. Any metric frame, always the same.
class HeadPredictor {
  public:
    explicit HeadPredictor(const HeadPredictorOptions& options = {}) : options_(options) {}

    /// `depth_m`: distance from the sensor along its axis, for the measurement's noise.
    HeadMeasurement measure(TimeNs time, const glm::dvec3& position_m, double depth_m);
    void reset() { seeded_ = false; }

    /// Where the head is at `time`, at most options.farthest after the last measurement. The last
    /// known place where none came for long; empty before the first.
    [[nodiscard]] std::optional<glm::dvec3> at(TimeNs time) const;
    /// No faster than options.fastest_m_s; 0 before the second measurement.
    [[nodiscard]] glm::dvec3 velocity_m_s() const;
    /// No measurement for longer than a gap, or none at all.
    [[nodiscard]] bool lost(TimeNs time) const;
    [[nodiscard]] TimeNs last_time() const { return time_; }

  private:
    struct Axis {
        double p = 0, v = 0;
        double pp = 0, pv = 0, vv = 0;  ///< covariance
    };
    void seed(TimeNs time, const glm::dvec3& position_m, double variance);

    HeadPredictorOptions options_;
    std::array<Axis, 3> axes_;
    TimeNs time_ = 0;       ///< of the last measurement taken
    TimeNs last_seen_ = 0;  ///< of the last one that was not skipped
    int refused_ = 0;
    bool seeded_ = false;
};

}  // namespace kino
