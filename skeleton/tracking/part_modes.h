#pragma once

#include <array>
#include <glm/vec3.hpp>
#include <vector>

#include "skeleton/tracking/part_points.h"

namespace kino {

/// Where a part's points gather.
struct PartMode {
    glm::vec3 surface_m{0};  ///< depth-camera space
    glm::vec3 center_m{0};   ///< pushed inwards along the view by PartPlace::inward_m
    float weight_m2 = 0;     ///< area that gathers there, across the view
};

struct ModeOptions {
    float bandwidth_m = 0.065f;
    float least_share = 0.14f;  ///< of a point that may start
    int modes = 3;              ///< per part
    int rounds = 12;
    float apart_m = 0.10f;  ///< another start lies at least so far from the modes found
    float stop_m = 0.0005f;
    int points_per_part = 96;  ///< thinned to about so many
    /// A mode goes if the other side's same part has one within so much that weighs so much more:
    /// there is one limb, and the forest is not sure which.
    float mirror_m = 0.12f, mirror_ratio = 1.2f;
};

/// The modes of each part, the heaviest first: weighted mean shift (Comaniciu & Meer 2002) with a
/// Gaussian kernel over the points, weighted by P(part | point) z^2, as Shotton et al. (CVPR 2011,
/// section 4) propose joints. Reuses its memory.
class PartModes {
  public:
    /// `cell_tangent`: distance between neighbouring points at one metre, metres.
    void find(const PartPoints& points, float cell_tangent, const ModeOptions& options = {});
    [[nodiscard]] const std::vector<PartMode>& of(BodyPart part) const {
        return modes_[static_cast<std::size_t>(part)];
    }

  private:
    struct Weighted {
        glm::vec3 at;
        float weight;
        bool start;
    };
    void drop_mirrored(const ModeOptions& options);

    std::array<std::vector<PartMode>, kBodyPartCount> modes_;
    std::array<std::vector<Weighted>, kBodyPartCount> points_;
};

}  // namespace kino
