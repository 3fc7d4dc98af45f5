#include "apps/checked_words.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>

namespace kino {
namespace {

constexpr int kLeastSide = 16, kLargestSide = 8192;

}  // namespace

std::string read_size(const std::string& text, int& width, int& height) {
    int w = 0, h = 0;
    char x = 0, rest = 0;
    const int read = std::sscanf(text.c_str(), "%d%c%d%c", &w, &x, &h, &rest);
    if (read != 3 || x != 'x' || std::min(w, h) < kLeastSide || std::max(w, h) > kLargestSide) {
        return fmt::format("--size: {} is not WxH with sides from {} to {}", text, kLeastSide,
                           kLargestSide);
    }
    width = w;
    height = h;
    return {};
}

std::string check_number(const std::string& word, double least, double most) {
    double value = 0;
    const bool is_number = CLI::detail::lexical_cast(word, value);
    if (is_number && value >= least && value <= most) return {};
    return fmt::format("{} is not a number from {} to {}", word, least, most);
}

}  // namespace kino
