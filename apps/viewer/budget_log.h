#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "apps/viewer/frame_budget.h"
#include "base/error.h"

namespace kino {

/// [{"frame": 0, "lod": 2, "zoom": 1, "bilinear": false}, ...]
[[nodiscard]] nlohmann::ordered_json budget_log_json(const std::vector<FrameBudget::Logged>& log);

/// The choices of a run: of the first source of a summary.json, or of what a window wrote with
/// --json. Fails for files without, for levels that there are not (lod 1 to 8, zoom 1 to 8), and
/// for frames that do not come one after the other.
[[nodiscard]] Result<std::vector<FrameBudget::Logged>> read_budget_log(
    const std::filesystem::path& path);
/// The same from text; `where` is named in errors.
[[nodiscard]] Result<std::vector<FrameBudget::Logged>> parse_budget_log(const std::string& text,
                                                                        const std::string& where);

}  // namespace kino
