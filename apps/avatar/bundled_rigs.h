#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace kino {

/// The files of apps/avatar/data, compiled in, so that their names work anywhere.
struct BundledRig {
    std::string_view name;
    std::string_view about;
    std::span<const std::uint8_t> glb;
};
[[nodiscard]] std::vector<BundledRig> bundled_rigs();

}  // namespace kino
