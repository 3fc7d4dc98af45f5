#pragma once

#include <memory>
#include <string>
#include <vector>

#include "apps/demo/solid.h"
#include "apps/stage/director.h"

namespace kino::demo {

/// A scene as the demo uses it.
struct Act {
    std::string name;
    std::unique_ptr<Director> director;
    std::vector<Solid> solids;
    RoomBox room;
};

constexpr int kDemoLights = 1024;  ///< local ones, without those of balls

/// Opens a scene and takes out what the demo does itself: trails, and lights at many joints.
/// Swarms only fill the lights up to kDemoLights. Fails as open_stage() does, and where the
/// `more_materials` that the demo brings find no place.
[[nodiscard]] Result<Act> open_act(const std::string& name_or_file, std::size_t more_materials);

/// Of an empty list: those that come with the program and suit the demo, in its order.
[[nodiscard]] std::vector<std::string> acts_or_default(std::vector<std::string> names);

}  // namespace kino::demo
