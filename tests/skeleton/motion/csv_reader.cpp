#include "tests/skeleton/motion/csv_reader.h"

#include <stdexcept>

namespace kino::test {
namespace {

std::vector<std::string> cells_of(const std::string& line) {
    std::vector<std::string> cells(1);
    for (const char c : line) {
        if (c == ',') {
            cells.emplace_back();
        } else {
            cells.back() += c;
        }
    }
    return cells;
}

}  // namespace

std::vector<std::map<std::string, std::string>> read_csv(const std::string& text) {
    std::vector<std::string> names;
    std::vector<std::map<std::string, std::string>> rows;
    for (std::size_t at = 0; at < text.size();) {
        const std::size_t end = text.find('\n', at);
        if (end == std::string::npos) throw std::runtime_error("the last line has no end");
        const std::vector<std::string> cells = cells_of(text.substr(at, end - at));
        at = end + 1;
        if (names.empty()) {
            names = cells;
            continue;
        }
        if (cells.size() != names.size()) throw std::runtime_error("a row of another length");
        std::map<std::string, std::string> row;
        for (std::size_t i = 0; i < names.size(); ++i) row[names[i]] = cells[i];
        rows.push_back(std::move(row));
    }
    return rows;
}

}  // namespace kino::test
