#pragma once

#include <optional>
#include <string_view>

#include "skeleton/filters/body_filter.h"

namespace kino {

struct KalmanParameters {
    /// Strength of the random acceleration, m^2/s^3: the square root of how many m/s a joint's
    /// speed strays in one second.
    double acceleration_density = 4.0;
    /// Standard deviation of a reading at 30 readings a second, m. It is taken as a density (its
    /// square times the time between readings is fixed), so the response has one shape at every
    /// frame rate.
    double noise_m = 0.015;
    double inferred_noise_scale = 4;     ///< on noise_m for inferred joints
    double start_speed_sigma_mps = 1.0;  ///< how unsure the speed is at a start
    JointGate gate;
};

/// "default"; "calm": stiller, more overshoot; "quick": closer to the readings.
[[nodiscard]] std::optional<KalmanParameters> kalman_preset(std::string_view name);

/// Constant-velocity Kalman filter of each joint, white noise acceleration with the exact
/// discretisation Q = q [dt^3/3 dt^2/2; dt^2/2 dt] (Bar-Shalom, Li & Kirubarajan 2001, 6.2.2). The
/// axes are independent and share one covariance.
class KalmanFilter : public BodyFilter {
  public:
    explicit KalmanFilter(const KalmanParameters& parameters = {});

    /// One-sigma uncertainty of joint `j`'s position `ahead_s` >= 0 after its last reading, m.
    [[nodiscard]] double sigma_m(Joint j, double ahead_s = 0) const;

  protected:
    void start(std::size_t j, const glm::dvec3& at) override;
    glm::dvec3 step(std::size_t j, const glm::dvec3& at, bool inferred, double dt_s) override;
    [[nodiscard]] glm::dvec3 ahead(std::size_t j, double ahead_s) const override;

  private:
    struct Track {
        glm::dvec3 position_m{0}, velocity_mps{0};
        double pp = 0, pv = 0, vv = 0;  // covariance
    };
    [[nodiscard]] Track moved(const Track& track, double dt_s) const;

    KalmanParameters parameters_;
    std::array<Track, kJointCount> tracks_;
};

}  // namespace kino
