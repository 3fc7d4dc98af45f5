#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"

namespace kino::bench {

/// Entries that are run one after the other, each as a program of its own: one that fails, aborts
/// or takes too long does not keep the others from running.
struct AllOptions {
    std::string program;                 ///< this program's file
    std::vector<std::string> arguments;  ///< after the entry's name: --quick, --docs DIR ...
    double most_minutes = 40;  ///< of all together; what has not begun by then is left out
    bool quick = false;
};
struct AllReport {
    std::string csv;                  ///< of all that worked, with one header
    std::vector<std::string> failed;  ///< "raster: ended with status 1"
};
[[nodiscard]] AllReport run_all(std::span<const std::string_view> names, const AllOptions& options);

/// What an entry takes on two cores at 2 GHz, for the remaining time; a minute where nobody
/// measured it.
[[nodiscard]] double typical_seconds(std::string_view name, bool quick);

}  // namespace kino::bench
