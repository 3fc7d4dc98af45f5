#include "apps/viewer/budget_log.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "sensor/file_bytes.h"

namespace kino {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kMostBytes = std::size_t{64} << 20;  ///< a summary of a day
constexpr double kMostLod = 8;
constexpr std::int64_t kMostZoomLogged = 8;

const Json* member(const Json* json, const char* name) {
    if (json == nullptr || !json->is_object()) return nullptr;
    const auto found = json->find(name);
    return found == json->end() ? nullptr : &*found;
}

const Json* find_levels(const Json& json) {
    if (const Json* own = member(&json, "levels")) return own;
    const Json* sources = member(member(&json, "deterministic"), "sources");
    if (sources == nullptr || !sources->is_array() || sources->empty()) return nullptr;
    return member(&sources->front(), "levels");
}

}  // namespace

nlohmann::ordered_json budget_log_json(const std::vector<FrameBudget::Logged>& log) {
    auto levels = nlohmann::ordered_json::array();
    for (const FrameBudget::Logged& line : log) {
        levels.push_back({{"frame", line.frame},
                          {"lod", line.lod},
                          {"zoom", line.zoom},
                          {"bilinear", line.bilinear}});
    }
    return levels;
}

Result<std::vector<FrameBudget::Logged>> parse_budget_log(const std::string& text,
                                                          const std::string& where) {
    const Json json = Json::parse(text, nullptr, false);
    if (json.is_discarded()) return fail("is no JSON", where);
    const Json* levels = find_levels(json);
    if (levels == nullptr || !levels->is_array()) {
        return fail("has no \"levels\"", where, "a summary.json of a headless run has them");
    }
    std::vector<FrameBudget::Logged> log;
    for (const Json& line : *levels) {
        const Json* frame = member(&line, "frame");
        const Json* lod = member(&line, "lod");
        const Json* zoom = member(&line, "zoom");
        const Json* bilinear = member(&line, "bilinear");
        const std::string at = fmt::format("{}#/levels/{}", where, log.size());
        if (frame == nullptr || !frame->is_number_integer() || lod == nullptr ||
            !lod->is_number() || zoom == nullptr || !zoom->is_number_integer() ||
            (bilinear != nullptr && !bilinear->is_boolean())) {
            return fail("is no level: frame, lod, zoom and bilinear", at);
        }
        const FrameBudget::Logged read{.frame = frame->get<std::int64_t>(),
                                       .lod = lod->get<double>(),
                                       .zoom = 1,
                                       .bilinear = bilinear != nullptr && bilinear->get<bool>()};
        const auto wanted_zoom = zoom->get<std::int64_t>();
        if (!(read.lod >= 1 && read.lod <= kMostLod) || wanted_zoom < 1 ||
            wanted_zoom > kMostZoomLogged) {
            return fail("lod and zoom are from 1 to 8", at);
        }
        if (read.frame < 0 || (!log.empty() && read.frame <= log.back().frame)) {
            return fail("frames come one after the other", at);
        }
        log.push_back(read);
        log.back().zoom = static_cast<int>(wanted_zoom);
    }
    return log;
}

Result<std::vector<FrameBudget::Logged>> read_budget_log(const std::filesystem::path& path) {
    KINO_ASSIGN(const std::string text, read_file_text(path, kMostBytes));
    return parse_budget_log(text, path.string());
}

}  // namespace kino
