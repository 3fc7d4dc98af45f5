#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "base/body.h"

namespace kino {

/// Error of one joint of one frame with a person in it.
struct JointError {
    float mm = 0;       ///< 300 if the joint is lost or the person was missed
    float range_m = 0;  ///< of the true joint, along the axis
    std::uint8_t joint = 0;
    bool visible = false;   ///< its flesh is seen
    std::uint8_t seen = 0;  ///< joints of the same body that are visible
};

struct ErrorFigures {
    std::size_t n = 0;
    double mean_mm = 0;
    double within_100 = 0, within_150 = 0, lost = 0;  ///< shares, 0..1
};

class BodyScore {
  public:
    static constexpr float kLostMm = 300;
    /// Each true body is compared with the found one whose hip centre is nearest, within 1 m.
    void add(const BodyFrame& truth, const BodyFrame& found);

    void add(const BodyScore& other);

    [[nodiscard]] ErrorFigures figures(
        const std::function<bool(const JointError&)>& wanted = {}) const;

  private:
    std::vector<JointError> errors_;
};

/// Interval of a share at 95 % (Wilson 1927).
struct ShareInterval {
    double share = 0, low = 0, high = 0;
};
[[nodiscard]] ShareInterval wilson(std::size_t hits, std::size_t n);

}  // namespace kino
