#include "calibration/files/plain_yaml.h"

#include <fmt/format.h>

#include <algorithm>

namespace kino {
namespace {

constexpr std::size_t kMaxBytes = std::size_t{1} << 20;
constexpr std::size_t kMaxLines = 10000;
constexpr int kMaxLevels = 16;

struct Line {
    int number = 0;
    std::size_t indent = 0;
    std::string_view text;  // without indentation, comment and space at the end
};

std::string_view trim(std::string_view text) {
    constexpr std::string_view kSpace = " \t\r";
    const std::size_t from = text.find_first_not_of(kSpace);
    if (from == std::string_view::npos) return {};
    return text.substr(from, text.find_last_not_of(kSpace) - from + 1);
}

// A '#' starts a comment at the front or after a space, outside quotes.
std::string_view without_comment(std::string_view text) {
    char quote = 0;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (quote != 0) {
            if (c == quote) quote = 0;
        } else if (c == '"' || c == '\'') {
            quote = c;
        } else if (c == '#' && (i == 0 || text[i - 1] == ' ' || text[i - 1] == '\t')) {
            return text.substr(0, i);
        }
    }
    return text;
}

class Parser {
  public:
    Parser(std::string_view text, std::string where) : where_(std::move(where)) { split(text); }

    Result<YamlNode> run() {
        if (lines_.size() > kMaxLines) return error(0, "too many lines");
        KINO_ASSIGN(YamlNode root, mapping(0, 0));
        if (at_ != lines_.size()) return error(lines_[at_].number, "wrongly indented");
        return root;
    }

  private:
    tl::unexpected<Error> error(int line, const std::string& what) const {
        return fail(what, line > 0 ? fmt::format("{}, line {}", where_, line) : where_);
    }

    void split(std::string_view text) {
        int number = 0;
        while (!text.empty() && lines_.size() <= kMaxLines) {
            ++number;
            const std::size_t end = std::min(text.find('\n'), text.size());
            const std::string_view whole = text.substr(0, end);
            text.remove_prefix(std::min(end + 1, text.size()));
            const std::string_view content = trim(without_comment(whole));
            const std::size_t indent = whole.find_first_not_of(" \t");
            // Directives and document marks stand at the front.
            const bool mark =
                indent == 0 && (content.starts_with('%') || content == "---" || content == "...");
            if (!content.empty() && !mark) lines_.push_back({number, indent, content});
        }
    }

    Result<YamlNode> mapping(std::size_t indent, int level) {
        YamlNode out;
        if (level > kMaxLevels) return error(lines_[at_].number, "nested too deeply");
        if (at_ < lines_.size()) out.line = lines_[at_].number;
        while (at_ < lines_.size() && lines_[at_].indent == indent) {
            const Line line = lines_[at_];
            const std::size_t colon = line.text.find(':');
            const bool pair = colon != std::string_view::npos && colon > 0 &&
                              (colon + 1 == line.text.size() || line.text[colon + 1] == ' ');
            if (!pair) return error(line.number, "not \"key: value\"");
            const std::string key(unquoted(trim(line.text.substr(0, colon))));
            ++at_;
            KINO_ASSIGN(YamlNode node, value(line, trim(line.text.substr(colon + 1)), level));
            if (!out.map.emplace(key, std::move(node)).second) {
                return error(line.number, fmt::format("\"{}\" is there twice", key));
            }
        }
        return out;
    }

    Result<YamlNode> value(const Line& line, std::string_view text, int level) {
        if (text.starts_with("!")) text = trim(text.substr(std::min(text.find(' '), text.size())));
        YamlNode out;
        if (text.empty()) {
            if (at_ < lines_.size() && lines_[at_].indent > line.indent) {
                KINO_ASSIGN(out, mapping(lines_[at_].indent, level + 1));
            }
            out.line = line.number;
            return out;
        }
        out.line = line.number;
        if (!text.starts_with('[')) {
            out.scalar = unquoted(text);
            return out;
        }
        out.is_list = true;
        std::string joined(text);
        while (joined.find(']') == std::string::npos) {
            if (at_ == lines_.size()) return error(line.number, "the list does not end");
            joined += ' ';
            joined += lines_[at_++].text;
        }
        if (joined.find(']') + 1 != joined.size()) {
            return error(line.number, "something follows the list");
        }
        std::string_view rest = std::string_view(joined).substr(1, joined.size() - 2);
        while (!trim(rest).empty()) {
            const std::size_t comma = std::min(rest.find(','), rest.size());
            const std::string_view item = trim(rest.substr(0, comma));
            if (item.empty()) return error(line.number, "an item of the list is empty");
            out.list.emplace_back(unquoted(item));
            rest.remove_prefix(std::min(comma + 1, rest.size()));
        }
        return out;
    }

    static std::string_view unquoted(std::string_view text) {
        const bool quoted = text.size() >= 2 && text.front() == text.back() &&
                            (text.front() == '"' || text.front() == '\'');
        return quoted ? text.substr(1, text.size() - 2) : text;
    }

    std::string where_;
    std::vector<Line> lines_;
    std::size_t at_ = 0;
};

}  // namespace

const YamlNode* YamlNode::find(std::string_view key) const {
    const auto at = map.find(key);
    return at == map.end() ? nullptr : &at->second;
}

Result<YamlNode> parse_plain_yaml(std::string_view text, const std::string& where) {
    if (text.size() > kMaxBytes) return fail("too long for a calibration file", where);
    return Parser(text, where).run();
}

}  // namespace kino
