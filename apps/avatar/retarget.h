#pragma once

#include <array>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <optional>
#include <vector>

#include "apps/avatar/rest_body.h"

namespace kino {

/// Where a person's joints are, world space, metres. Positions that are not seen mean nothing.
struct BodyAim {
    PerJoint<glm::dvec3> joint_m{};
    PerJoint<bool> seen{};
};

struct RetargetOptions {
    bool scale_bones = true;
    std::optional<double> floor_y_m;
};

/// What limits motion. Angles in rad, rates a second.
struct RetargetLimits {
    double turn_rate = 25;           ///< of a segment against its parent; faster than any limb
    double returning_turn_rate = 4;  ///< of one that was lost, at first
    double return_s = 0.5;           ///< until it may turn at the full rate again
    double move_rate_m = 8;          ///< of the whole body
    double hold_s = 0.5;             ///< a lost segment stays as it was, then goes to stand at ease
    double ease_rate = 1.5;
    double scale_time_s = 0.5;                  ///< of the exponential mean over bone lengths
    double scale_low = 0.35, scale_high = 2.5;  ///< of the whole body
    double ratio_low = 0.7, ratio_high = 1.4;   ///< of one bone on top of that
};

/// Makes one rigged body stand as a person stands: each bone by the shortest arc from where it
/// points at rest to where the person's points, in its parent's frame; twist of upper arms and
/// thighs by the plane of elbow and knee; pelvis and chest by three joints each. In double.
class Retarget {
  public:
    explicit Retarget(std::shared_ptr<const RestBody> rest, const RetargetLimits& limits = {});

    /// One step on. The first one that sees a trunk takes the pose at once.
    void step(const BodyAim& aim, const RetargetOptions& options, double dt_s);
    /// Whether a trunk was ever seen; nothing below means anything before.
    [[nodiscard]] bool placed() const { return placed_; }

    /// World positions of the body's joints as the rig has them now.
    [[nodiscard]] const PerJoint<glm::dvec3>& joint_m() const { return joint_m_; }
    /// world_from_segment of a segment's rotation: from the rest pose's axes.
    [[nodiscard]] const glm::dquat& turn(Joint segment) const { return turn_[index_of(segment)]; }
    [[nodiscard]] double scale() const { return scale_; }
    /// Length of the bone that ends in `joint`, over scale() times its length at rest.
    [[nodiscard]] double ratio(Joint joint) const { return ratio_[index_of(joint)]; }
    /// The lowest point of a sole, world y.
    [[nodiscard]] double sole_y_m(int side) const;

    /// Of the object space whose origin is `origin_m` in the world, scaled by scale().
    [[nodiscard]] std::vector<glm::mat4> object_from_bind(const glm::dvec3& origin_m) const;

  private:
    struct Segment {
        glm::dquat local{1, 0, 0, 0};  ///< parent's turn times this is the segment's
        double twist_rad = 0;          ///< of its end, in `local` already
        double lost_s = 0;
        double back_s = 1e9;  ///< since it came back
    };

    void estimate_lengths(const BodyAim& aim, const RetargetOptions& options, double dt_s);
    [[nodiscard]] std::optional<glm::dvec3> root_of(const BodyAim& aim) const;
    void solve(const BodyAim& aim, double dt_s, bool at_once);
    void solve_trunk(const BodyAim& aim, double dt_s, bool at_once);
    void solve_arm(const BodyAim& aim, int side, double dt_s, bool at_once);
    void solve_leg(const BodyAim& aim, int side, double dt_s, bool at_once);
    /// Takes `wanted` (empty: not seen), which has `twist_rad` in it, as far as limits allow.
    void settle(Joint segment, const glm::dquat& parent, const std::optional<glm::dquat>& wanted,
                double dt_s, bool at_once, double twist_rad = 0);
    /// The local rotation that points the bone along `way` (parent's frame).
    [[nodiscard]] glm::dquat swing(Joint segment, const glm::dvec3& way) const;
    [[nodiscard]] std::optional<glm::dvec3> bone(const BodyAim& aim, Joint from, Joint to) const;
    void place(Joint joint, const glm::dquat& turn);
    void stand_on(const BodyAim& aim, double floor_y_m, double dt_s, bool at_once);
    void bend_leg(int side, const glm::dvec3& ankle_m);
    void remember_ease();

    std::shared_ptr<const RestBody> rest_;
    RetargetLimits limits_;
    bool placed_ = false;
    glm::dvec3 root_m_{0};  ///< of the person, held while nobody sees it
    double root_lost_s_ = 0, root_back_s_ = 1e9;
    double lift_m_ = 0;  ///< of the root, so that the soles meet the floor
    double scale_ = 1;
    bool scaled_ = false;
    PerJoint<double> ratio_{};
    PerJoint<bool> measured_{};
    PerJoint<Segment> segment_{};
    PerJoint<glm::dquat> ease_{};  ///< locals of standing at ease
    PerJoint<glm::dquat> turn_{};
    PerJoint<glm::dvec3> joint_m_{};
};

}  // namespace kino
