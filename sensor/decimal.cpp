#include "sensor/decimal.h"

#include <charconv>
#include <cmath>
#include <limits>

namespace kino {
namespace {

bool is_digit(char c) {
    return c >= '0' && c <= '9';
}
bool is_space(char c) {
    return c == ' ' || c == '\t' || c == '\r' || c == ',';
}

}  // namespace

std::optional<TimeNs> parse_time(std::string_view text) {
    constexpr TimeNs kMaxSeconds = std::numeric_limits<TimeNs>::max() / kNsPerSecond - 1;
    std::size_t i = 0;
    TimeNs seconds = 0;
    for (; i < text.size() && is_digit(text[i]); ++i) {
        seconds = seconds * 10 + (text[i] - '0');
        if (seconds > kMaxSeconds) return std::nullopt;
    }
    if (i == 0) return std::nullopt;
    TimeNs fraction = 0;
    if (i < text.size()) {
        if (text[i++] != '.') return std::nullopt;
        TimeNs weight = kNsPerSecond / 10;
        for (; i < text.size() && is_digit(text[i]); ++i) {
            fraction += (text[i] - '0') * weight;
            weight /= 10;
        }
        if (i != text.size()) return std::nullopt;
    }
    return seconds * kNsPerSecond + fraction;
}

std::optional<double> parse_number(std::string_view text) {
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) {
        return std::nullopt;
    }
    return value;
}

std::string_view next_word(std::string_view& rest) {
    while (!rest.empty() && is_space(rest.front())) rest.remove_prefix(1);
    std::size_t length = 0;
    while (length < rest.size() && !is_space(rest[length])) ++length;
    const std::string_view word = rest.substr(0, length);
    rest.remove_prefix(length);
    return word;
}

}  // namespace kino
