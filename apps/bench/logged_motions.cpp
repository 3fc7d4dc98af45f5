#include "apps/bench/logged_motions.h"

#include <algorithm>
#include <filesystem>
#include <system_error>

namespace kino {

Result<std::vector<std::string>> logged_motions() {
    const std::filesystem::path folder = "tests/data/motion";
    std::vector<std::string> motions;
    std::error_code error;
    for (const auto& entry : std::filesystem::directory_iterator(folder, error))
        if (entry.path().extension() == ".csv") motions.push_back("log:" + entry.path().string());
    if (motions.empty())
        return fail("there are no recorded motions", folder.string(),
                    "start in the root of the source tree");
    std::sort(motions.begin(), motions.end());
    return motions;
}

}  // namespace kino
