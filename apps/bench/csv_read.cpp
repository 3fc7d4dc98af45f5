#include "apps/bench/csv_read.h"

#include <fmt/format.h>

#include <charconv>
#include <string>

#include "apps/bench/table.h"

namespace kino::bench {
namespace {

constexpr std::size_t kFields = 10;

/// Splits RFC 4180 text; quotes may hold commas, line ends and doubled quotes.
std::vector<std::vector<std::string>> split_csv(std::string_view text) {
    std::vector<std::vector<std::string>> lines;
    std::vector<std::string> line;
    std::string field;
    bool quoted = false;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (quoted) {
            if (c != '"') {
                field += c;
            } else if (i + 1 < text.size() && text[i + 1] == '"') {
                field += text[++i];
            } else {
                quoted = false;
            }
        } else if (c == '"') {
            quoted = true;
        } else if (c == ',' || c == '\n') {
            line.push_back(std::move(field));
            field.clear();
            if (c == '\n') {
                lines.push_back(std::move(line));
                line.clear();
            }
        } else if (c != '\r') {
            field += c;
        }
    }
    if (!field.empty() || !line.empty()) {
        line.push_back(std::move(field));
        lines.push_back(std::move(line));
    }
    return lines;
}

bool read_number(const std::string& field, double& value) {
    value = kNotMeasured;
    if (field.empty()) return true;
    const auto [end, code] = std::from_chars(field.data(), field.data() + field.size(), value);
    return code == std::errc{} && end == field.data() + field.size();
}

}  // namespace

Result<std::vector<BenchRow>> read_csv(std::string_view text) {
    if (!text.starts_with(csv_header())) return fail("is no table of this program");
    text.remove_prefix(csv_header().size());
    std::vector<BenchRow> rows;
    for (std::vector<std::string>& fields : split_csv(text)) {
        const std::string where = fmt::format("row {}", rows.size() + 1);
        if (fields.size() != kFields) return fail("has another number of fields", where);
        BenchRow row{.case_name = std::move(fields[1]),
                     .knob = std::move(fields[2]),
                     .level = std::move(fields[3]),
                     .metric = std::move(fields[7]),
                     .baseline = std::move(fields[8])};
        if (!read_number(fields[4], row.ms_median) || !read_number(fields[5], row.ms_p95) ||
            !read_number(fields[6], row.error) || !read_number(fields[9], row.speedup)) {
            return fail("has a number that is none", where);
        }
        rows.push_back(std::move(row));
    }
    return rows;
}

}  // namespace kino::bench
