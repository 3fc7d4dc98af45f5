#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace kino {

/// The known word that somebody who typed `word` most likely meant: few letters are wrong, missing,
/// too many or swapped. Empty where none is near.
[[nodiscard]] std::string nearest_word(std::string_view word,
                                       const std::vector<std::string>& known);

}  // namespace kino
