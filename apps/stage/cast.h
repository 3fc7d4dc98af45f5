#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>

#include "base/body.h"
#include "base/pose.h"

namespace kino {

/// One joint of somebody on the stage.
struct CastJoint {
    glm::dvec3 world_m{0};  ///< where it is, or was last; finite
    bool known = false;     ///< it was seen at least once
    bool seen = false;      ///< in this step
};

struct CastMember {
    std::uint32_t id = 0;  ///< of the body; 0: this place is free
    bool present = false;  ///< in this step, with a joint or more
    double away_s = 0;     ///< since it was last present
    std::array<CastJoint, kJointCount> joints;

    [[nodiscard]] const CastJoint& operator[](Joint joint) const {
        return joints[static_cast<std::size_t>(joint)];
    }
};

/// Who is on the stage: bodies keep their place while they are seen and for some time after, so
/// that what follows them can fade where they were.
class Cast {
  public:
    static constexpr std::size_t kPlaces = 6;
    static constexpr double kKeptS = 3;  ///< a place is kept so long for who is not seen

    /// `bodies` may be null: nobody. Joints that are lost, not finite or absurdly far stay where
    /// they were.
    void step(double dt_s, const BodyFrame* bodies, const Pose& world_from_depth);
    void clear() { members_ = {}; }

    [[nodiscard]] std::span<const CastMember> members() const { return members_; }
    [[nodiscard]] bool anybody() const;

  private:
    CastMember* place_for(std::uint32_t id);

    std::array<CastMember, kPlaces> members_;
};

}  // namespace kino
