#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "base/error.h"
#include "skeleton/actors/actor_pose.h"

namespace kino {

/// What a motion needs on its stage.
struct ActorProps {
    bool seat = false;
    bool box = false;      ///< in both hands
    bool wall = false;     ///< at the left hand
    bool partner = false;  ///< a second actor plays the same from the other side
};

/// A motion without a body, 30 poses a second, starting at about the world's origin and facing
/// about +z.
class ActorMotion {
  public:
    virtual ~ActorMotion() = default;
    [[nodiscard]] virtual int frames() const = 0;
    [[nodiscard]] virtual ActorPose pose(int frame) const = 0;
    [[nodiscard]] virtual ActorProps props() const { return {}; }
};
constexpr double kActorRateHz = 30;

/// One of actor_motions(), or "log:FILE". `seed` decides what the name leaves open.
[[nodiscard]] Result<std::shared_ptr<const ActorMotion>> make_actor_motion(const std::string& name,
                                                                           std::uint64_t seed);

}  // namespace kino
