#include <memory>

#include "skeleton/actors/actor_sequence.h"
#include "tests/skeleton/tracking/eval/take.h"

namespace kino::test {

Result<Take> actor_take(const ActorTake& options) {
    KINO_ASSIGN(std::shared_ptr<ActorSequence> sequence, ActorSequence::create(options));
    KINO_ASSIGN(Rig rig, Rig::create(sequence->rig()));
    Take take;
    take.name = options.motion + ":" + std::to_string(options.seed);
    take.rays = rig.depth_rays();
    take.frames = sequence->frames();
    take.render = [sequence, frame = ActorFrame{}](int index, TakeFrame& out) mutable {
        sequence->render(index, frame);
        out.time = frame.time + 1;
        out.depth_m = frame.depth_m;
        out.part = frame.part;
        out.actor = frame.actor;
        out.truth = frame.truth;
    };
    return take;
}

}  // namespace kino::test
