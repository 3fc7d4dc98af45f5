#include "skeleton/actors/pose_draw.h"

#include <cmath>
#include <glm/gtc/quaternion.hpp>

#include "skeleton/actors/pose_library.h"
#include "skeleton/actors/recorded_motion.h"
#include "skeleton/synthetic/motion.h"

namespace kino {

DrawnPose draw_pose(ActorRandom& random) {
    DrawnPose drawn;
    const double kind = random.unit();
    if (kind < 0.18) {
        // The long recording has most to show.
        const double which = random.unit();
        const char* name = which < 0.75   ? "cmu_01_01"
                           : which < 0.93 ? "makehuman_walk1"
                           : which < 0.96 ? "makehuman_dance1"
                                          : "makehuman_tpose";
        const auto motion = built_in_motion(name);
        drawn.pose = motion->pose(
            static_cast<int>(random.below(static_cast<std::uint64_t>(motion->frames()))));
        drawn.pose.lift_m = 0;
        // Facing is drawn elsewhere.
        drawn.pose =
            turned(drawn.pose, -std::atan2(drawn.pose.pelvis[2].x, drawn.pose.pelvis[2].z));
    } else if (kind < 0.30) {
        const auto& motions = all_motions();
        BodyPose pose =
            pose_at(motions[random.below(motions.size())], random.in(0, kMotionPeriodS));
        pose.yaw_rad = 0;
        drawn.pose = actor_pose(pose_body(pose));
    } else {
        const Stance stance = random_stance(random);
        drawn.seated = stance == Stance::sitting;
        BodyPose pose = random_pose(random, stance);
        drawn.pose = actor_pose(pose_body(pose));
        if (!drawn.seated && random.chance(0.035)) {  // lying, on the back, the belly or a side
            const double roll = random.chance(0.5)   ? random.normal(0, 0.2)
                                : random.chance(0.5) ? M_PI
                                                     : random.in(-M_PI, M_PI);
            drawn.pose =
                turned(drawn.pose, glm::angleAxis(random.in(-M_PI, M_PI), glm::dvec3(0, 1, 0)) *
                                       glm::angleAxis(-M_PI / 2, glm::dvec3(1, 0, 0)) *
                                       glm::angleAxis(roll, glm::dvec3(0, 1, 0)));
        }
    }
    for (double& curl : drawn.pose.curl) curl = random.unit() * random.unit();
    drawn.pose.place_m = {0, 0};
    if (random.chance(0.5)) drawn.pose = mirrored(drawn.pose);
    return drawn;
}

}  // namespace kino
