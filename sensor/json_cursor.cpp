#include "sensor/json_cursor.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

namespace kino {

using nlohmann::json;

tl::unexpected<Error> JsonCursor::error(std::string what, std::string hint) const {
    return fail(std::move(what), where_ + "#" + (pointer_.empty() ? "/" : pointer_),
                std::move(hint));
}

Result<void> JsonCursor::only(std::initializer_list<std::string_view> keys) const {
    if (!value_->is_object()) return error("must be an object");
    for (const auto& [key, value] : value_->items()) {
        if (std::find(keys.begin(), keys.end(), key) == keys.end()) {
            return error(fmt::format("unknown key \"{}\"", key),
                         fmt::format("known: {}", fmt::join(keys, ", ")));
        }
    }
    return {};
}

std::optional<JsonCursor> JsonCursor::find(const char* key) const {
    if (!value_->is_object()) return std::nullopt;
    const auto found = value_->find(key);
    if (found == value_->end()) return std::nullopt;
    return JsonCursor(*found, where_, pointer_ + "/" + key);
}

Result<JsonCursor> JsonCursor::member(const char* key) const {
    auto found = find(key);
    if (!found) return error(fmt::format("\"{}\" is missing", key));
    return *std::move(found);
}

Result<std::vector<JsonCursor>> JsonCursor::items(std::size_t least, std::size_t most) const {
    if (!value_->is_array() || value_->size() < least || value_->size() > most) {
        return error(least == most ? fmt::format("must be a list of {}", least)
                                   : fmt::format("must be a list of {} to {}", least, most));
    }
    std::vector<JsonCursor> cursors;
    cursors.reserve(value_->size());
    for (std::size_t i = 0; i < value_->size(); ++i) {
        cursors.emplace_back((*value_)[i], where_, fmt::format("{}/{}", pointer_, i));
    }
    return cursors;
}

Result<double> JsonCursor::number() const {
    if (!value_->is_number()) return error("must be a number");
    const double number = value_->get<double>();
    if (!std::isfinite(number)) return error("must be a finite number");
    return number;
}

Result<std::int64_t> JsonCursor::integer(std::int64_t least, std::int64_t most) const {
    const bool fits =
        value_->is_number_integer() &&
        (!value_->is_number_unsigned() || value_->get<std::uint64_t>() <= std::uint64_t{INT64_MAX});
    if (!fits || value_->get<std::int64_t>() < least || value_->get<std::int64_t>() > most) {
        return error(fmt::format("must be a whole number from {} to {}", least, most));
    }
    return value_->get<std::int64_t>();
}

Result<std::string> JsonCursor::text() const {
    if (!value_->is_string()) return error("must be a text");
    return value_->get<std::string>();
}

Result<bool> JsonCursor::boolean() const {
    if (!value_->is_boolean()) return error("must be true or false");
    return value_->get<bool>();
}

Result<void> JsonCursor::read(const char* key, double& out) const {
    if (const auto value = find(key)) {
        KINO_ASSIGN(out, value->number());
    }
    return {};
}

Result<void> JsonCursor::read(const char* key, std::string& out) const {
    if (const auto value = find(key)) {
        KINO_ASSIGN(out, value->text());
    }
    return {};
}

Result<void> JsonCursor::read(const char* key, bool& out) const {
    if (const auto value = find(key)) {
        KINO_ASSIGN(out, value->boolean());
    }
    return {};
}

Result<json> parse_json(std::string_view text, const std::string& where) {
    try {
        return json::parse(text);
    } catch (const json::exception& problem) {
        std::string reason = problem.what();
        // The library opens its messages with "[json.exception.parse_error.101] ".
        if (const auto end = reason.find("] "); end != std::string::npos) reason.erase(0, end + 2);
        return fail(fmt::format("not valid JSON: {}", reason), where);
    }
}

}  // namespace kino
