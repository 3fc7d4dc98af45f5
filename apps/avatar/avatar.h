#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/avatar/avatar_rig.h"
#include "base/body.h"
#include "base/pose.h"
#include "viz/scene/scene.h"

namespace kino {

struct AvatarOptions {
    /// The left limb of the person moves the right one of the avatar, which then is a mirror image
    /// seen face to face: reflected in the upright plane through AvatarMoment::middle_m that
    /// contains `facing`.
    bool mirror = false;
    /// Bones take the person's lengths; false: the rig keeps its own, and feet may leave the
    /// joints.
    bool scale_bones = true;
    SkinBlend skin = SkinBlend::dual_quaternion;
    /// An avatar of whom nobody sees anything shrinks into the floor for so long and is gone; one
    /// who comes back nearby before that goes on.
    double hand_over_s = 0.6;
    /// With nobody there for `idle_after_s`, one avatar stands at the middle and moves by itself.
    bool idle = true;
    double idle_after_s = 1;
};

struct AvatarMoment {
    double dt_s = 0;  ///< since the last one; brought into 0 to 0.1
    /// Depth-camera space; between two depth frames, the last one again. Null: nobody.
    const BodyFrame* bodies = nullptr;
    Pose world_from_depth;
    std::optional<double> floor_y_m;  ///< world; empty: feet are where joints say
    glm::dvec3 middle_m{0};           ///< world, on the floor: where the idle one stands
    glm::dvec3 facing{0, 0, 1};       ///< world, level: where the idle one looks
};

/// Up to six rigged characters that move as people do. The same moments give the same bits. What
/// it puts into a scene is finite whatever joints are. Who is who is decided by place first and by
/// Body::id second, so identities that swap do not. docs/avatars.md.
class AvatarTroupe {
  public:
    static constexpr std::size_t kPlaces = 6;

    AvatarTroupe(std::shared_ptr<const AvatarRig> rig, const AvatarOptions& options);
    ~AvatarTroupe();
    AvatarTroupe(AvatarTroupe&&) noexcept;
    AvatarTroupe& operator=(AvatarTroupe&&) noexcept;

    void reset();
    void step(const AvatarMoment& moment);
    /// Appends nodes (ids from `first_id`, rig().parts.size() for each place) and the rig's
    /// materials. Nothing is appended while no avatar is shown.
    void fill(Scene& scene, std::uint32_t first_id) const;

    /// Shown now, the idle one included.
    [[nodiscard]] std::size_t shown() const;
    [[nodiscard]] bool idling() const;
    [[nodiscard]] const AvatarRig& rig() const;
    void set_options(const AvatarOptions& options);

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace kino
