#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "sensor/file_bytes.h"
#include "viz/scene/scene_check.h"
#include "viz/scene/scene_fields.h"

namespace kino {
namespace {

using nlohmann::json;

std::optional<SceneColor> parse_hex_color(std::string_view text) {
    if (text.size() != 7 || text[0] != '#') return std::nullopt;
    std::uint32_t value = 0;
    for (const char c : text.substr(1)) {
        const int digit = c >= '0' && c <= '9'   ? c - '0'
                          : c >= 'a' && c <= 'f' ? c - 'a' + 10
                          : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                                 : -1;
        if (digit < 0) return std::nullopt;
        value = value << 4 | static_cast<std::uint32_t>(digit);
    }
    return SceneColor{static_cast<std::uint8_t>(value >> 16), static_cast<std::uint8_t>(value >> 8),
                      static_cast<std::uint8_t>(value)};
}

/// A JSON pointer's names escape what pointers are made of (RFC 6901).
std::string pointer_name(const std::string& key) {
    std::string out;
    for (const char c : key.substr(0, 100))
        out += c == '~' ? "~0" : c == '/' ? "~1" : std::string(1, c);
    return out;
}

/// Reads the members of one object. The first thing that is wrong is kept, and nothing is read
/// after it.
class FieldReader {
  public:
    template <class T>
    [[nodiscard]] static Result<void> read(const json& value, const std::string& place, T& out) {
        if (!value.is_object()) return fail("must be an object", place);
        FieldReader reader(value, place);
        scene_fields::visit(reader, out);
        // A misspelt key explains most other mistakes.
        for (const auto& [key, unused] : value.items()) {
            if (reader.known_.contains(key)) continue;
            return fail(fmt::format("unknown key \"{}\"", key.substr(0, 100)),
                        place + "/" + pointer_name(key),
                        fmt::format("known: {}", fmt::join(reader.order_, ", ")));
        }
        return reader.result_;
    }

    void number(const char* key, double& out, double least, double most, const char*) {
        with(key, [&](const json& value, const std::string& place) {
            return read_number(value, place, least, most, out);
        });
    }
    void integer(const char* key, int& out, int least, int most, const char*) {
        with(key, [&](const json& value, const std::string& place) -> Result<void> {
            if (read_integer(value, least, most, out)) return {};
            return fail(fmt::format("must be a whole number from {} to {}", least, most), place);
        });
    }
    template <class Words, class Value>
    void number_or(const char* key, double& out, Value& by, const Words& words, double least,
                   double most, const char*) {
        with(key, [&](const json& value, const std::string& place) -> Result<void> {
            if (read_number(value, place, least, most, out)) return {};
            if (read_choice(value, place, words, by)) return {};
            return fail(fmt::format("must be a number from {} to {}, or {}", least, most,
                                    fmt::join(allowed(words), ", ")),
                        place);
        });
    }
    template <class Words, class Value>
    void integer_or(const char* key, int& out, Value& by, const Words& words, int least, int most,
                    const char*) {
        with(key, [&](const json& value, const std::string& place) -> Result<void> {
            if (read_integer(value, least, most, out)) return {};
            if (read_choice(value, place, words, by)) return {};
            return fail(fmt::format("must be a whole number from {} to {}, or {}", least, most,
                                    fmt::join(allowed(words), ", ")),
                        place);
        });
    }
    template <class Numbers>
    void one_of(const char* key, int& out, const Numbers& numbers, const char*) {
        with(key, [&](const json& value, const std::string& place) -> Result<void> {
            int number = 0;
            if (read_integer(value, *std::begin(numbers), *std::rbegin(numbers), number) &&
                std::find(std::begin(numbers), std::end(numbers), number) != std::end(numbers)) {
                out = number;
                return {};
            }
            return fail(fmt::format("must be one of {}", fmt::join(numbers, ", ")), place);
        });
    }
    void required_integer(const char* key, int& out, int least, int most, const char* about) {
        if (!value_.contains(key) && result_) {
            result_ =
                fail(fmt::format("\"{}\" is missing", key), place_, "the version of the format, 1");
        }
        integer(key, out, least, most, about);
    }
    void vector(const char* key, glm::dvec3& out, double least, double most, const char*) {
        with(key, [&](const json& value, const std::string& place) -> Result<void> {
            return read_numbers(value, place, 3, least, most, &out.x);
        });
    }
    void span(const char* key, glm::dvec2& out, double least, double most, const char*) {
        with(key, [&](const json& value, const std::string& place) -> Result<void> {
            KINO_TRY(read_numbers(value, place, 2, least, most, &out.x));
            if (out.x > out.y) return fail("must not fall: the smaller number is first", place);
            return {};
        });
    }
    void color(const char* key, SceneColor& out, const char*) {
        with(key, [&](const json& value, const std::string& place) {
            return read_color(value, place, out);
        });
    }
    void flag(const char* key, bool& out, const char*) {
        with(key, [&](const json& value, const std::string& place) -> Result<void> {
            if (!value.is_boolean()) return fail("must be true or false", place);
            out = value.get<bool>();
            return {};
        });
    }
    void text(const char* key, std::string& out, std::size_t longest, const char*) {
        with(key, [&](const json& value, const std::string& place) {
            return read_text(value, place, longest, out);
        });
    }
    template <class Words, class Value>
    void choice(const char* key, Value& out, const Words& words, const char*) {
        with(key, [&](const json& value, const std::string& place) {
            return read_choice(value, place, words, out);
        });
    }
    template <class T>
    void object(const char* key, T& out, const char*) {
        with(key,
             [&](const json& value, const std::string& place) { return read(value, place, out); });
    }
    template <class T>
    void optional(const char* key, std::optional<T>& out, const char*) {
        with(key, [&](const json& value, const std::string& place) {
            return read(value, place, out.emplace());
        });
    }
    template <class T>
    void list(const char* key, std::vector<T>& out, std::size_t most, const char*) {
        each(key, out, most, [](const json& value, const std::string& place, T& item) {
            return read(value, place, item);
        });
    }
    void texts(const char* key, std::vector<std::string>& out, std::size_t most,
               std::size_t longest, const char*) {
        each(key, out, most, [longest](const json& value, const std::string& place, auto& item) {
            return read_text(value, place, longest, item);
        });
    }
    void colors(const char* key, std::vector<SceneColor>& out, std::size_t most, const char*) {
        each(key, out, most, read_color);
    }
    template <class Words, class Value>
    void choices(const char* key, std::vector<Value>& out, const Words& words, std::size_t most,
                 const char*) {
        each(key, out, most, [&](const json& value, const std::string& place, Value& item) {
            return read_choice(value, place, words, item);
        });
    }

  private:
    FieldReader(const json& value, const std::string& place) : value_(value), place_(place) {}

    template <class Read>
    void with(const char* key, Read&& read_value) {
        known_.insert(key);
        order_.emplace_back(key);
        if (!result_) return;
        const auto found = value_.find(key);
        if (found != value_.end()) result_ = read_value(*found, place_ + "/" + key);
    }
    template <class T, class Read>
    void each(const char* key, std::vector<T>& out, std::size_t most, Read&& read_item) {
        with(key, [&](const json& value, const std::string& place) -> Result<void> {
            if (!value.is_array() || value.size() > most) {
                return fail(fmt::format("must be a list of at most {}", most), place);
            }
            out.clear();
            for (std::size_t i = 0; i < value.size(); ++i) {
                KINO_TRY(read_item(value[i], fmt::format("{}/{}", place, i), out.emplace_back()));
            }
            return {};
        });
    }

    static bool read_integer(const json& value, int least, int most, int& out) {
        const bool whole =
            value.is_number_integer() &&
            (!value.is_number_unsigned() || value.get<std::uint64_t>() <= std::uint64_t{INT64_MAX});
        if (!whole || value.get<std::int64_t>() < least || value.get<std::int64_t>() > most) {
            return false;
        }
        out = static_cast<int>(value.get<std::int64_t>());
        return true;
    }
    template <class Words>
    static std::vector<std::string_view> allowed(const Words& words) {
        std::vector<std::string_view> names;
        for (const auto& [word, meant] : words) names.push_back(word);
        return names;
    }
    static Result<void> read_number(const json& value, const std::string& place, double least,
                                    double most, double& out) {
        // Written so that what is not a number fails, too.
        const double number = value.is_number() ? value.get<double>() : NAN;
        if (!(number >= least && number <= most)) {
            return fail(fmt::format("must be a number from {} to {}", least, most), place);
        }
        out = number;
        return {};
    }
    static Result<void> read_numbers(const json& value, const std::string& place, std::size_t count,
                                     double least, double most, double* out) {
        if (!value.is_array() || value.size() != count) {
            return fail(fmt::format("must be a list of {} numbers", count), place);
        }
        for (std::size_t i = 0; i < count; ++i) {
            KINO_TRY(read_number(value[i], fmt::format("{}/{}", place, i), least, most, out[i]));
        }
        return {};
    }
    static Result<void> read_color(const json& value, const std::string& place, SceneColor& out) {
        const auto color =
            value.is_string() ? parse_hex_color(value.get_ref<const std::string&>()) : std::nullopt;
        if (!color) return fail("must be a colour", place, "\"#rrggbb\", as \"#ff8000\"");
        out = *color;
        return {};
    }
    static Result<void> read_text(const json& value, const std::string& place, std::size_t longest,
                                  std::string& out) {
        if (!value.is_string() || value.get_ref<const std::string&>().size() > longest) {
            return fail(fmt::format("must be a text of at most {} bytes", longest), place);
        }
        out = value.get<std::string>();
        return {};
    }
    template <class Words, class Value>
    static Result<void> read_choice(const json& value, const std::string& place, const Words& words,
                                    Value& out) {
        for (const auto& [word, meant] : words) {
            if (value.is_string() && value.get_ref<const std::string&>() == word) {
                out = meant;
                return {};
            }
        }
        return fail(fmt::format("must be one of {}", fmt::join(allowed(words), ", ")), place);
    }

    const json& value_;
    const std::string& place_;
    std::set<std::string, std::less<>> known_;
    std::vector<std::string> order_;
    Result<void> result_;
};

/// Brackets within brackets, at most; texts are passed over.
int bracket_depth(std::string_view text) {
    int depth = 0, deepest = 0;
    bool in_text = false;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (in_text) {
            if (c == '\\') ++i;
            if (c == '"') in_text = false;
        } else if (c == '"') {
            in_text = true;
        } else if (c == '[' || c == '{') {
            deepest = std::max(deepest, ++depth);
        } else if (c == ']' || c == '}') {
            --depth;
        }
    }
    return deepest;
}

/// One JSON value. A key that is there twice is an error: one of them would be lost.
Result<json> parse_document(std::string_view text, const std::string& where) {
    std::vector<std::set<std::string>> keys;
    std::string twice;
    const auto watch = [&](int, json::parse_event_t event, json& parsed) {
        if (event == json::parse_event_t::object_start) {
            keys.emplace_back();
        } else if (event == json::parse_event_t::object_end) {
            keys.pop_back();
        } else if (event == json::parse_event_t::key) {
            const auto& key = parsed.get_ref<const std::string&>();
            if (!keys.back().insert(key).second && twice.empty()) twice = key;
        }
        return true;
    };
    try {
        json document = json::parse(text, watch);
        if (!twice.empty()) {
            return fail(fmt::format("the key \"{}\" is there twice", twice.substr(0, 100)), where);
        }
        return document;
    } catch (const json::exception& problem) {
        std::string reason = problem.what();
        // The library opens its messages with "[json.exception.parse_error.101] ".
        if (const auto end = reason.find("] "); end != std::string::npos) reason.erase(0, end + 2);
        return fail(fmt::format("not valid JSON: {}", reason), where);
    }
}

}  // namespace

Result<SceneFile> scene_file_from_json(std::string_view text, const std::string& where) {
    if (text.size() > kMaxSceneFileBytes) {
        return fail(fmt::format("is longer than {} bytes", kMaxSceneFileBytes), where);
    }
    if (bracket_depth(text) > kMaxSceneFileDepth) {
        return fail(fmt::format("nests deeper than {} brackets", kMaxSceneFileDepth), where);
    }
    KINO_ASSIGN(const json document, parse_document(text, where));
    SceneFile file;
    KINO_TRY(FieldReader::read(document, where + "#", file));
    KINO_TRY(check_scene_file(file, where));
    return file;
}

Result<SceneFile> read_scene_file(const std::filesystem::path& path) {
    KINO_ASSIGN(const std::string text, read_file_text(path, kMaxSceneFileBytes));
    return scene_file_from_json(text, path.string());
}

}  // namespace kino
