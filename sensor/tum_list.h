#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "base/time.h"

namespace kino {

struct TimedFile {
    TimeNs time = 0;
    std::string name;  ///< relative to the recording's folder
};

struct ParsedList {
    std::vector<TimedFile> files;  ///< times strictly rising
    std::size_t skipped = 0;       ///< lines that said nothing usable
};

/// Lines "seconds file-name", # starts a comment; names may hold blanks. Lines without a time or
/// a name, and times that do not rise, are skipped and counted.
[[nodiscard]] ParsedList parse_tum_list(std::string_view text);

/// Files whose names are their times ("1305031453.374112.png"), sorted by time. Others, and equal
/// times, are skipped and counted.
[[nodiscard]] ParsedList list_from_names(const std::vector<std::string>& names);

}  // namespace kino
