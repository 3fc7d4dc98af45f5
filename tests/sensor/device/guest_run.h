#pragma once

#include <map>
#include <string>
#include <vector>

namespace kino::guest {

/// What the guest machine reported, read on the host.
struct GuestRun {
    int status = -1;       ///< of the scenarios' program; 125: the guest never ran it to its end
    std::string messages;  ///< of the boot: why there was no guest
    std::string output;    ///< of the program in the guest, as it came
    std::map<std::string, std::map<std::string, double>> values;  ///< by scenario and key
    std::map<std::string, std::vector<std::string>> failures;     ///< by scenario
};

/// The lines of Report, wherever they stand among others.
[[nodiscard]] GuestRun parse_report(const std::string& output);

/// Boots the guest and runs `program` in it; `folder` is the run's own and keeps the kernel.
[[nodiscard]] GuestRun boot_guest(const std::string& script, const std::string& folder,
                                  const std::string& program, int seconds_at_most);

}  // namespace kino::guest
