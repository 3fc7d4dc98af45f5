#include "sensor/tum_list.h"

#include <algorithm>
#include <filesystem>
#include <utility>

#include "sensor/decimal.h"

namespace kino {
namespace {

void add_rising(ParsedList& list, TimeNs time, std::string name) {
    if (!list.files.empty() && time <= list.files.back().time) {
        ++list.skipped;
        return;
    }
    list.files.push_back({time, std::move(name)});
}

std::string_view trim(std::string_view text) {
    constexpr std::string_view kBlank = " \t\r";
    const std::size_t first = text.find_first_not_of(kBlank);
    if (first == std::string_view::npos) return {};
    return text.substr(first, text.find_last_not_of(kBlank) - first + 1);
}

}  // namespace

ParsedList parse_tum_list(std::string_view text) {
    ParsedList list;
    while (!text.empty()) {
        const std::size_t end = std::min(text.find('\n'), text.size());
        std::string_view line = text.substr(0, end);
        text.remove_prefix(std::min(end + 1, text.size()));
        const std::string_view first = next_word(line);
        if (first.empty() || first.front() == '#') continue;
        const std::optional<TimeNs> time = parse_time(first);
        const std::string_view name = trim(line);
        if (!time || name.empty()) {
            ++list.skipped;
            continue;
        }
        add_rising(list, *time, std::string(name));
    }
    return list;
}

ParsedList list_from_names(const std::vector<std::string>& names) {
    ParsedList list;
    std::vector<TimedFile> files;
    for (const std::string& name : names) {
        if (const auto time = parse_time(std::filesystem::path(name).stem().native())) {
            files.push_back({*time, name});
        } else {
            ++list.skipped;
        }
    }
    std::stable_sort(files.begin(), files.end(),
                     [](const TimedFile& a, const TimedFile& b) { return a.time < b.time; });
    for (TimedFile& file : files) add_rising(list, file.time, std::move(file.name));
    return list;
}

}  // namespace kino
