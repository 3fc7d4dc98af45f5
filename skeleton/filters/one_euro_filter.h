#pragma once

#include <optional>
#include <string_view>

#include "skeleton/filters/body_filter.h"

namespace kino {

struct OneEuroParameters {
    double min_cutoff_hz = 1.2;          ///< > 0: lower is calmer when still
    double beta_hz_per_mps = 4.0;        ///< >= 0: higher lags less when fast
    double speed_cutoff_hz = 2.0;        ///< > 0: of the speed's own low-pass
    double inferred_cutoff_scale = 0.5;  ///< the cutoff is multiplied by this for inferred joints
    JointGate gate;
};

/// "default"; "calm": stiller, more lag; "quick": less lag, less still.
[[nodiscard]] std::optional<OneEuroParameters> one_euro_preset(std::string_view name);

/// The 1-Euro filter (Casiez, Roussel & Vogel, CHI 2012): a low-pass whose cutoff is
/// min + beta * |speed|, one cutoff for the three axes so that directions are kept. The weight of a
/// reading is 1 - exp(-2 pi cutoff dt), the exact step response of the low-pass, in place of the
/// paper's first-order 1 / (1 + tau / dt): frame rates and uneven frame times then change nothing.
/// What update() gives lies in the hull of the readings.
class OneEuroFilter : public BodyFilter {
  public:
    explicit OneEuroFilter(const OneEuroParameters& parameters = {});

  protected:
    void start(std::size_t j, const glm::dvec3& at) override;
    glm::dvec3 step(std::size_t j, const glm::dvec3& at, bool inferred, double dt_s) override;
    [[nodiscard]] glm::dvec3 ahead(std::size_t j, double ahead_s) const override;

  private:
    struct Track {
        glm::dvec3 raw{0}, level{0}, speed_mps{0};
    };
    OneEuroParameters parameters_;
    std::array<Track, kJointCount> tracks_;
};

}  // namespace kino
