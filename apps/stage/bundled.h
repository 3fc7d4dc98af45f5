#pragma once

#include <optional>
#include <string_view>
#include <vector>

namespace kino {

/// The scenes of scenes/, compiled in, so that their names work anywhere.
struct BundledScene {
    std::string_view name;
    std::string_view json;
};
[[nodiscard]] std::vector<BundledScene> bundled_scenes();
[[nodiscard]] std::optional<BundledScene> bundled_scene(std::string_view name);

/// A line a scene: name and sentence.
[[nodiscard]] std::string list_of_scenes();

}  // namespace kino
