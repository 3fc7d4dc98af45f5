#include "sensor/source.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <system_error>

#include "sensor/openers.h"

namespace kino {
namespace {

std::vector<SourceOpener>& openers() {
    static std::vector<SourceOpener> list = {tum_folder_opener(), described_folder_opener()};
    return list;
}

/// "synthetic" of "synthetic:room"; empty for paths. A scheme has at least two characters.
std::string scheme_of(const std::string& uri) {
    const std::size_t colon = uri.find(':');
    if (colon == std::string::npos || colon < 2) return {};
    const bool plain =
        std::all_of(uri.begin(), uri.begin() + static_cast<std::ptrdiff_t>(colon), [](char c) {
            return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '+' || c == '-';
        });
    return plain ? uri.substr(0, colon) : std::string();
}

std::string known_kinds() {
    std::vector<std::string> names;
    for (const SourceOpener& opener : openers()) names.push_back(opener.name);
    return fmt::format("{}", fmt::join(names, ", "));
}

std::string known_schemes() {
    std::vector<std::string> schemes;
    for (const SourceOpener& opener : openers()) {
        const std::string scheme = scheme_of(opener.uri_pattern);
        const bool of_two = scheme.find('+') != std::string::npos;  // "a+b: ..."
        if (!scheme.empty() && !of_two) schemes.push_back(scheme + ":");
    }
    return fmt::format("{}", fmt::join(schemes, ", "));
}

}  // namespace

const char* stream_name(StreamKind kind) {
    switch (kind) {
        case StreamKind::depth:
            return "depth";
        case StreamKind::color:
            return "colour";
        case StreamKind::infrared:
            return "infrared";
        case StreamKind::bodies:
            return "bodies";
        case StreamKind::motion:
            return "motion";
    }
    return "unknown";
}

void register_source(SourceOpener opener) {
    openers().push_back(std::move(opener));
}

const std::vector<SourceOpener>& source_openers() {
    return openers();
}

Result<std::unique_ptr<Source>> open_source(const std::string& uri) {
    if (uri.empty() || uri.find('\0') != std::string::npos) {
        return fail("no recording or device is named", {}, "known: " + known_kinds());
    }
    for (auto opener = openers().rbegin(); opener != openers().rend(); ++opener) {
        if (opener->probe && opener->probe(uri)) return opener->open(uri);
    }
    std::error_code error;
    if (std::filesystem::exists(uri, error)) {
        return fail("not a kind of recording that is known", uri, "looked for: " + known_kinds());
    }
    if (const std::string scheme = scheme_of(uri); !scheme.empty()) {
        return fail(fmt::format("nothing opens \"{}:\"", scheme), uri, "known: " + known_schemes());
    }
    return fail("no such file or folder", uri);
}

Result<void> subscribe_all(Source& source) {
    for (const StreamInfo& stream : source.info().streams) KINO_TRY(source.subscribe(stream.id));
    return {};
}

}  // namespace kino
