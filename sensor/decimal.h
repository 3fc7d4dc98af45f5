#pragma once

#include <optional>
#include <string_view>

#include "base/time.h"

namespace kino {

/// Seconds as decimal digits ("1305031453.374112") to nanoseconds without passing through a
/// double, which would lose 100 ns at such sizes. Digits past the ninth are cut off. None: empty,
/// a sign, an exponent, anything else, or more than 2^63 ns.
[[nodiscard]] std::optional<TimeNs> parse_time(std::string_view text);

/// A finite decimal number that fills the whole text; independent of the locale.
[[nodiscard]] std::optional<double> parse_number(std::string_view text);

/// Cuts the next word (no spaces, tabs or commas) off the front of `rest`; empty at the end.
[[nodiscard]] std::string_view next_word(std::string_view& rest);

}  // namespace kino
