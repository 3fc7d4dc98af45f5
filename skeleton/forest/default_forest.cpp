#include "skeleton/forest/default_forest.h"

#include <cstdlib>
#include <string>
#include <system_error>

#include "skeleton/forest/body_part.h"
#include "skeleton/forest/forest_file.h"

namespace kino {
namespace {

constexpr const char* kName = "bodies.forest";

}  // namespace

std::vector<std::filesystem::path> default_forest_places() {
    std::vector<std::filesystem::path> places;
    const char* named = std::getenv("KINOSCOPE_DATA");
    if (named != nullptr && *named != '\0') places.push_back(std::filesystem::path(named) / kName);
    std::error_code error;
    const auto program = std::filesystem::read_symlink("/proc/self/exe", error);
    if (!error)
        places.push_back(program.parent_path().parent_path() / "share" / "kinoscope" / kName);
    places.push_back(std::filesystem::path(KINO_SOURCE_DATA) / kName);
    return places;
}

Result<std::shared_ptr<const Forest>> default_forest() {
    std::string looked_at;
    for (const auto& place : default_forest_places()) {
        std::error_code error;
        if (!std::filesystem::exists(place, error)) {
            looked_at += (looked_at.empty() ? "" : ", ") + place.string();
            continue;
        }
        KINO_ASSIGN(Forest forest, read_forest(place));
        bool ours = forest.labels.size() == kBodyPartCount;
        for (std::size_t l = 0; ours && l < forest.labels.size(); ++l)
            ours = forest.labels[l] == body_part_name(static_cast<BodyPart>(l));
        if (!ours) return fail("the forest knows other parts than ours", place.string());
        return std::make_shared<const Forest>(std::move(forest));
    }
    return fail("the forest of body parts is not there", looked_at,
                "set KINOSCOPE_DATA to the folder that holds bodies.forest");
}

}  // namespace kino
