#pragma once

#include <cstddef>
#include <span>
#include <string_view>

namespace kino {

/// Files of skeleton/actors/data, within the program.
[[nodiscard]] std::span<const std::byte> actor_body_file();
[[nodiscard]] std::string_view actor_motion_file(std::string_view name);

}  // namespace kino
