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

/// What became of one entry.
struct EntryOutcome {
    std::string name;
    double seconds = 0;
    std::size_t rows = 0;
    int claims_hold = 0;
    std::vector<std::string> claims_missed;  ///< findings, no failures
    std::string failure;                     ///< "ended with status 1"; empty: it worked
};
struct AllReport {
    std::string csv;  ///< of all that worked, with one header
    std::vector<EntryOutcome> outcomes;
    double seconds = 0;
    double most_minutes = 0;
    [[nodiscard]] std::size_t failures() const;
    [[nodiscard]] std::size_t claims_missed() const;
};
[[nodiscard]] AllReport run_all(std::span<const std::string_view> names, const AllOptions& options);

/// A line an entry with its time, rows and claims; then what failed; then, apart from that, the
/// claims that do not hold.
[[nodiscard]] std::string summary_table(const AllReport& report);

/// What an entry takes on two cores at 2 GHz, for the remaining time; a minute (--quick: ten
/// seconds) where nobody measured it.
[[nodiscard]] double typical_seconds(std::string_view name, bool quick);

}  // namespace kino::bench
