#pragma once

#include <map>
#include <string>
#include <vector>

namespace kino::test {

/// Rows by the column names of the first line; throws std::runtime_error where a row has another
/// number of cells.
[[nodiscard]] std::vector<std::map<std::string, std::string>> read_csv(const std::string& text);

}  // namespace kino::test
