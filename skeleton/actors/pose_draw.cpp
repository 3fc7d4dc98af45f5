#include "skeleton/actors/pose_draw.h"

#include "skeleton/actors/pose_library.h"
#include "skeleton/synthetic/motion.h"

namespace kino {

DrawnPose draw_pose(ActorRandom& random) {
    DrawnPose drawn;
    const double kind = random.unit();
    if (kind < 0.15) {
        const auto& motions = all_motions();
        BodyPose pose =
            pose_at(motions[random.below(motions.size())], random.in(0, kMotionPeriodS));
        pose.yaw_rad = 0;
        drawn.pose = actor_pose(pose_body(pose));
    } else {
        const Stance stance = random_stance(random);
        drawn.seated = stance == Stance::sitting;
        drawn.pose = actor_pose(pose_body(random_pose(random, stance)));
    }
    for (double& curl : drawn.pose.curl) curl = random.unit() * random.unit();
    drawn.pose.place_m = {0, 0};
    if (random.chance(0.5)) drawn.pose = mirrored(drawn.pose);
    return drawn;
}

}  // namespace kino
