#include "sensor/live/composite.h"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <system_error>
#include <utility>

#include "sensor/live/composite_parts.h"

namespace kino {
namespace {

constexpr const char* kOpenerName = "two sources as one";

bool known(const std::string& uri) {
    const auto& openers = source_openers();
    return std::any_of(openers.begin(), openers.end(), [&](const SourceOpener& opener) {
        return opener.name != kOpenerName && opener.probe && opener.probe(uri);
    });
}

struct Split {
    std::string first;
    std::string second;
};

std::optional<Split> split(const std::string& uri) {
    std::error_code error;
    if (std::filesystem::exists(uri, error)) return std::nullopt;
    std::optional<Split> half_known;
    for (std::size_t plus = uri.find('+'); plus != std::string::npos;
         plus = uri.find('+', plus + 1)) {
        Split parts{uri.substr(0, plus), uri.substr(plus + 1)};
        if (parts.first.empty() || parts.second.empty()) continue;
        const bool first = known(parts.first);
        const bool second = known(parts.second);
        if (first && second) return parts;
        if (first != second && !half_known) half_known = std::move(parts);
    }
    // Opening it says which half is wrong, unless the whole means something to somebody.
    if (half_known && !known(uri)) return half_known;
    return std::nullopt;
}

}  // namespace

bool has_stream(const Source& source, StreamKind kind) {
    const auto& streams = source.info().streams;
    return std::any_of(streams.begin(), streams.end(),
                       [&](const StreamInfo& s) { return s.id.kind == kind; });
}

SourceInfo CompositeParts::info() const {
    SourceInfo info = depth->info();
    const SourceInfo& other = color->info();
    info.uri += "+" + other.uri;
    info.name += " with " + other.name;
    if (info.note.empty()) info.note = other.note;
    if (info.licence.empty()) info.licence = other.licence;
    std::erase_if(info.streams, [](const StreamInfo& s) { return s.id.kind == StreamKind::color; });
    for (const StreamInfo& stream : other.streams) {
        if (stream.id.kind == StreamKind::color) info.streams.push_back(stream);
    }
    return info;
}

Result<RigParameters> CompositeParts::calibration() const {
    KINO_ASSIGN(RigParameters rig, depth->calibration());
    const auto other = color->calibration();
    if (!rig.color) rig.color_from_depth = Pose{};
    rig.color.reset();
    if (other) rig.color = other->color;
    if (rig.note.empty()) rig.note = "the two cameras are not calibrated to each other";
    return rig;
}

Result<std::unique_ptr<Source>> make_composite_source(std::unique_ptr<Source> first,
                                                      std::unique_ptr<Source> second,
                                                      const SetBuilderOptions& options) {
    CompositeParts parts{std::move(first), std::move(second)};
    if (!has_stream(*parts.depth, StreamKind::depth)) std::swap(parts.depth, parts.color);
    const std::string both = parts.depth->info().uri + "+" + parts.color->info().uri;
    if (!has_stream(*parts.depth, StreamKind::depth)) return fail("neither has depth", both);
    if (!has_stream(*parts.color, StreamKind::color)) {
        return fail("the second source has no colour", both);
    }
    const bool recorded = parts.depth->timeline() != nullptr;
    if (recorded != (parts.color->timeline() != nullptr)) {
        return fail("a device and a recording have no time in common", both);
    }
    if (recorded) return make_recorded_composite(std::move(parts));
    return make_live_composite(std::move(parts), options);
}

SourceOpener composite_opener() {
    SourceOpener opener;
    opener.name = kOpenerName;
    opener.uri_pattern = "a+b: depth of one, colour of the other";
    opener.probe = [](const std::string& uri) { return split(uri).has_value(); };
    opener.open = [](const std::string& uri) -> Result<std::unique_ptr<Source>> {
        const auto parts = split(uri);
        if (!parts) return fail("not two sources", uri);
        KINO_ASSIGN(auto first, open_source(parts->first));
        KINO_ASSIGN(auto second, open_source(parts->second));
        return make_composite_source(std::move(first), std::move(second));
    };
    return opener;
}

}  // namespace kino
