#pragma once

#include <optional>
#include <string_view>

#include "skeleton/filters/body_filter.h"

namespace kino {

/// The five knobs of the Kinect SDK's TransformSmoothParameters (documented by Microsoft,
/// jj131024).
struct HoltParameters {
    double smoothing = 0.5;         ///< 0 (raw) to below 1
    double correction = 0.5;        ///< 0..1: how fast the trend follows
    double prediction = 0.5;        ///< frames looked ahead in what update() gives, >= 0
    double jitter_radius_m = 0.05;  ///< smaller moves are damped in proportion; 0 switches off
    double max_deviation_m = 0.04;  ///< the result is no further from the reading than this
    double inferred_scale = 2;      ///< both radii grow by this for inferred joints, >= 1
    JointGate gate;
};

/// "default", "somewhat-latent" and "very-smooth" with the values of the SDK's samples.
[[nodiscard]] std::optional<HoltParameters> holt_preset(std::string_view name);

/// Holt's double exponential smoothing (Holt 1957): level s = a r + (1-a)(s' + b'), trend
/// b = g (s - s') + (1-g) b', result s + m b; before it readings within the jitter radius are
/// pulled to s', after it the result is pulled to within max_deviation_m of the reading. Counts
/// frames, not seconds, as the SDK does: its response depends on the frame rate.
class HoltFilter : public BodyFilter {
  public:
    explicit HoltFilter(const HoltParameters& parameters = {});

  protected:
    void start(std::size_t j, const glm::dvec3& at) override;
    glm::dvec3 step(std::size_t j, const glm::dvec3& at, bool inferred, double dt_s) override;
    [[nodiscard]] glm::dvec3 ahead(std::size_t j, double ahead_s) const override;

  private:
    struct Track {
        glm::dvec3 level{0}, trend{0}, result{0};
        double dt_s = 0;  // of the last step; 0: none yet
    };
    HoltParameters parameters_;
    std::array<Track, kJointCount> tracks_;
};

}  // namespace kino
