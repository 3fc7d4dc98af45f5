#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "viz/light/light_parts.h"
#include "viz/quality/lod_plan.h"

namespace kino {

/// What a scene's light costs and loses, learned from its own pictures (light_learning.h).
struct LightTable {
    /// Those that the scene has, of "shadowed", "plain" and "bounced". Errors are mean squares of
    /// the picture's values, 0 to 255.
    std::vector<LodComponent> parts;
    double reconstruction_ns = 0;  ///< of a full-size picture, with its pick, a pixel
    double other_ns = 0;           ///< what a picture takes beside its light, a pixel
    int width = 0, height = 0;     ///< of the pictures
    int poses = 0;
};
[[nodiscard]] bool operator==(const LightTable& a, const LightTable& b);

/// "shadowed", "plain" or "bounced".
[[nodiscard]] const char* light_part_name(std::uint32_t part);

/// What to resize, and how far, so that light costs at most `budget_ns` a pixel.
struct LightChoice {
    PartRates rates;  ///< 1 or more for every part of the table, 0 for others
    LodPlan plan;
};
[[nodiscard]] LightChoice choose_rates(const LightTable& table, double budget_ns);

[[nodiscard]] std::string light_table_to_json(const LightTable& table);
/// `where` names the source in errors.
[[nodiscard]] Result<LightTable> light_table_from_json(std::string_view text,
                                                       std::string_view where);

}  // namespace kino
