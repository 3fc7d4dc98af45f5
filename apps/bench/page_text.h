#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace kino::bench {

/// Text for HTML and attributes.
[[nodiscard]] std::string escape_html(std::string_view text);

/// The number that the whole text is; empty if it is none.
[[nodiscard]] std::optional<double> number_of(std::string_view text);

/// Three digits, for a label.
[[nodiscard]] std::string short_number(double value);

}  // namespace kino::bench
