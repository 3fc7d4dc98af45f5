#pragma once

#include <string>

namespace kino {

/// Reads "1280x720", sides from 16 to 8192, of an option called --size; an error text, or empty.
[[nodiscard]] std::string read_size(const std::string& text, int& width, int& height);

/// As CLI::Range, which lets NaN through: it is neither below nor above. An error text, or empty.
[[nodiscard]] std::string check_number(const std::string& word, double least, double most);

}  // namespace kino
