#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"

namespace kino {

/// The little of YAML that calibration files use: mappings by indentation, whose values are plain
/// or quoted scalars, flow lists of scalars (over several lines), or mappings again. Comments,
/// "%YAML", "---" and tags are skipped. Block lists, anchors and everything else are errors.
struct YamlNode {
    std::string scalar;             ///< of a scalar; empty otherwise
    std::vector<std::string> list;  ///< of a flow list
    std::map<std::string, YamlNode, std::less<>> map;
    bool is_list = false;
    int line = 0;  ///< where it starts, from 1

    [[nodiscard]] const YamlNode* find(std::string_view key) const;
};

/// Fails with the line. At most 1 MB, 10000 lines, 16 levels.
[[nodiscard]] Result<YamlNode> parse_plain_yaml(std::string_view text, const std::string& where);

}  // namespace kino
