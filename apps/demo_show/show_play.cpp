#include "apps/demo_show/show_play.h"

namespace kino {

Result<DemoPlay> make_play(const ShowOptions& options) {
    DemoOptions play{
        .scenes = options.scenes, .live_body = options.shows_body(), .mirror = options.mirror};
    if (options.avatar != "none") {
        KINO_ASSIGN(play.avatar, open_avatar(options.avatar));
    }
    return DemoPlay::create(std::move(play));
}

PlayOptions show_play_options(const ShowOptions& options, LoopMode loop) {
    return {.mode = loop, .bodies = options.bodies, .calibration = options.calibration};
}

}  // namespace kino
