#include "skeleton/actors/actor_sequence.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "base/check.h"
#include "skeleton/actors/actor_canvas.h"
#include "skeleton/actors/actor_motion.h"
#include "skeleton/actors/actor_stage.h"
#include "skeleton/actors/actor_truth.h"

namespace kino {
namespace {

using glm::dvec3;

struct Player {
    ActorBody body;
    std::shared_ptr<const ActorMotion> motion;
    double yaw_rad = 0;
    glm::dvec2 place_m{0};
    PosedBones bones;
    std::vector<glm::vec3> posed;

    void pose(int frame) {
        ActorPose pose = turned(motion->pose(frame), yaw_rad);
        pose.place_m += place_m;
        bones = pose_actor(body, pose, posed);
    }
};

const char* random_motion(ActorRandom& random) {
    const double kind = random.unit();
    return kind < 0.30   ? "arms"
           : kind < 0.55 ? "wander"
           : kind < 0.65 ? "sit"
           : kind < 0.70 ? "crouch"
           : kind < 0.75 ? "bend"
           : kind < 0.85 ? "walk"
           : kind < 0.90 ? "turn"
                         : "dance";
}

// As wide as the hands are apart.
Primitive box_between_hands(const PosedBones& bones) {
    const dvec3 left = bones.joint_m[static_cast<std::size_t>(Joint::hand_left)],
                right = bones.joint_m[static_cast<std::size_t>(Joint::hand_right)];
    const glm::dmat3& chest = bones.turn[bone_index(ActorBone::chest)];
    return box((left + right) / 2.0 + chest[2] * 0.05,
               {std::max(0.05, glm::distance(left, right) / 2 - 0.03), 0.17, 0.14}, kPartThing,
               Covering::wood, chest);
}

class StagedSequence : public ActorSequence {
  public:
    explicit StagedSequence(const ActorTake& take)
        : take_(take),
          rig_(default_kinect1_rig(take.width, take.height)),
          room_(rig_),
          canvas_(rig_),
          lead_in_(static_cast<int>(std::lround(take.lead_in_s * kActorRateHz))) {}

    Result<void> stage();

    [[nodiscard]] int frames() const override {
        return lead_in_ + players_.front().motion->frames();
    }
    [[nodiscard]] double rate_hz() const override { return kActorRateHz; }
    [[nodiscard]] const RigParameters& rig() const override { return rig_; }
    void render(int index, ActorFrame& out) override;

  private:
    void furnish(ActorRandom& random, double distance_m);

    ActorTake take_;
    RigParameters rig_;
    ActorCanvas room_, canvas_;
    int lead_in_;
    Pose view_from_world_;
    std::vector<Player> players_;
};

Result<void> StagedSequence::stage() {
    ActorRandom random{0x7A4E, take_.seed};
    const double distance = take_.distance_m.value_or(random.in(2.1, 3.4));
    for (int i = 0; i < take_.actors; ++i) {
        Player player;
        player.body = make_actor_body(random_look(random.bits()));
        const bool partner = i == 1 && !take_.script && players_[0].motion->props().partner;
        const std::string name =
            partner || (i == 0 && !take_.motion.empty()) ? take_.motion : random_motion(random);
        // An even seed: the named motion from its beginning.
        const std::uint64_t seed = i == 0 ? random.bits() & ~std::uint64_t{1} : random.bits();
        if (i == 0 && take_.script) {
            player.motion = take_.script;
        } else {
            KINO_ASSIGN(player.motion, make_actor_motion(name, seed));
        }
        player.place_m = {0, -distance};
        if (i == 0) {
            player.yaw_rad = take_.motion.empty() && !take_.script ? random.normal(0, 0.35)
                                                                   : random.normal(0, 0.1);
            player.place_m.x = random.in(-0.15, 0.15) * distance;
        } else {
            player.yaw_rad = random.normal(0, 0.6);
            const double side = (i % 2 == 0 ? -1.0 : 1.0) * random.in(0.6, 1.1);
            player.place_m += glm::dvec2(side, random.in(-0.5, 0.6));
        }
        if (partner) {
            player.yaw_rad = players_[0].yaw_rad + M_PI;
            player.place_m =
                players_[0].place_m - glm::dvec2(0, take_.motion == "cross" ? 0.6 : 0.0);
        }
        player.pose(0);
        players_.push_back(std::move(player));
    }
    const double height = random.in(0.6, 1.8);
    // At the middle of the first when it stands highest; it then fits from some 2.2 m on.
    Player& first = players_.front();
    double top = 0;
    for (int k = 0; k < 8; ++k) {
        first.pose(first.motion->frames() * k / 8);
        top =
            std::max(top, first.bones.joint_m[static_cast<std::size_t>(Joint::shoulder_center)].y);
    }
    first.pose(0);
    const double middle = 0.72 * top;
    const double aim = std::atan2(height - middle, distance) + random.normal(0, 0.03);
    view_from_world_ = inverse(camera_pose(height, std::clamp(aim, -0.52, 0.52)));
    furnish(random, distance);
    return {};
}

void StagedSequence::furnish(ActorRandom& random, double distance) {
    std::vector<Primitive> solids;
    const double back = -distance - random.in(0.9, 2.5), side = random.in(1.6, 3.0);
    add_room(-side, side * random.in(0.8, 1.2), back, 0.8, random.in(2.4, 3.0), solids);
    if (players_.front().motion->props().wall) {
        Player& first = players_.front();
        double reach = -10;
        for (int k = 0; k < 10; ++k) {
            first.pose(first.motion->frames() * k / 10);
            const dvec3 hand = first.bones.joint_m[static_cast<std::size_t>(Joint::hand_left)];
            reach = std::max(reach, hand.x);
        }
        first.pose(0);
        solids.push_back(
            box({reach + 0.125, 1.2, -distance}, {0.10, 1.5, 1.2}, kPartThing, Covering::wall));
    }
    for (const Player& player : players_) {
        if (!player.motion->props().seat) continue;
        const double seat = seat_height(player.body, player.posed);
        const dvec3 hip = player.bones.joint_m[0];
        if (seat > 0.15) add_chair(random, hip, player.bones.turn[0][2], seat, solids);
    }
    if (take_.furniture) {
        const int things = 2 + static_cast<int>(random.below(4));
        for (int i = 0; i < things; ++i) {
            // Along the walls and at the sides, where nobody walks.
            const bool at_back = random.chance(0.5);
            const double s = random.chance(0.5) ? 1 : -1;
            const dvec3 at = at_back ? dvec3(random.in(-side, side) * 0.9, 0, back + 0.3)
                                     : dvec3(s * (side - 0.3), 0, random.in(back + 0.3, -1.2));
            if (random.chance(0.4)) {
                add_table(random, at, at_back ? 0 : M_PI / 2, solids);
            } else {
                add_thing(random, at, solids);
            }
        }
        // Now and then something stands before the first, beside the middle.
        if (random.chance(0.2)) {
            const double s = random.chance(0.5) ? 1 : -1, t = random.in(0.45, 0.75);
            add_thing(random,
                      {players_.front().place_m.x * t + s * random.in(0.35, 0.6), 0, -distance * t},
                      solids);
        }
        if (players_.front().motion->props().seat && random.chance(0.3)) {
            add_table(random, {players_.front().place_m.x, 0, -distance + 0.75}, 0, solids);
        }
    }
    for (Primitive& solid : solids) solid = moved(solid, view_from_world_);
    room_.clear(room_.whole(), 20.0f);
    room_.draw(solids, kSceneId);
}

void StagedSequence::render(int index, ActorFrame& out) {
    KINO_CHECK(index >= 0 && index < frames());
    out.time = static_cast<TimeNs>(std::llround(index * 1e9 / kActorRateHz));
    out.truth.time = out.time;
    out.truth.bodies.clear();
    out.depth_m.resize(take_.width, take_.height);
    out.part.resize(take_.width, take_.height);
    out.actor.resize(take_.width, take_.height);
    canvas_.copy(room_);
    if (index >= lead_in_) {
        for (std::size_t i = 0; i < players_.size(); ++i) {
            Player& player = players_[i];
            // Those who play longer than the first are cut; who ends earlier starts again.
            player.pose((index - lead_in_) % player.motion->frames());
            to_view(view_from_world_, player.posed);
            canvas_.draw(player.body, player.posed, static_cast<int>(i) + 1);
            if (player.motion->props().box) {
                const Primitive held = moved(box_between_hands(player.bones), view_from_world_);
                canvas_.draw({&held, 1}, kSceneId);
            }
        }
        std::vector<char> seen(players_.size() + 1, 0);
        for (const std::int32_t id : canvas_.id().pixels())
            seen[static_cast<std::size_t>(actor_of(id))] = 1;
        for (std::size_t i = 0; i < players_.size(); ++i) {
            if (!seen[i + 1]) continue;
            out.truth.bodies.push_back(actor_truth(players_[i].bones, view_from_world_,
                                                   static_cast<int>(i) + 1, canvas_.z_m(),
                                                   canvas_.id(), rig_.depth));
        }
    }
    const CanvasNoise noise;
    canvas_.measure(
        take_.noise ? &noise : nullptr,
        static_cast<std::uint32_t>(take_.seed * 1000003u) + static_cast<std::uint32_t>(index),
        out.depth_m);
    for (std::size_t i = 0; i < out.part.size(); ++i) {
        const std::int32_t id = canvas_.id().pixels()[i];
        out.actor.pixels()[i] = static_cast<std::uint8_t>(actor_of(id));
        out.part.pixels()[i] =
            actor_of(id) == 0 ? kNotBody : static_cast<std::uint8_t>(part_of(id));
    }
}

}  // namespace

Result<std::unique_ptr<ActorSequence>> ActorSequence::create(const ActorTake& take) {
    const std::string where = "actor take";
    for (const int size : {take.width, take.height}) {
        if (size < 64 || size > 2048 || size % 8 != 0) {
            return fail("sizes of pictures are multiples of 8 from 64 to 2048", where);
        }
    }
    if (take.actors < 1 || take.actors > 6) return fail("one to six actors play", where);
    if (!(take.lead_in_s >= 0 && take.lead_in_s <= 60)) {
        return fail("an empty room is shown for 0 to 60 seconds", where);
    }
    if (take.distance_m && !(*take.distance_m >= 0.4 && *take.distance_m <= 8)) {
        return fail("actors start 0.4 to 8 m away", where);
    }
    auto sequence = std::make_unique<StagedSequence>(take);
    KINO_TRY(sequence->stage());
    return std::unique_ptr<ActorSequence>(std::move(sequence));
}

}  // namespace kino
