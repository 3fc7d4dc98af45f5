#pragma once

#include <span>
#include <string_view>

namespace kino::bench {

/// What the program does if not asked, in the words of the tables.
struct DefaultLevel {
    std::string_view bench, knob, level;
    std::string_view only_case{};  ///< part of the case's name; empty: every case
};
[[nodiscard]] std::span<const DefaultLevel> default_levels();

[[nodiscard]] bool is_default_level(std::string_view bench, std::string_view knob,
                                    std::string_view level, std::string_view case_name);

}  // namespace kino::bench
