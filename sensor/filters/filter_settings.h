#pragma once

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <string>
#include <string_view>
#include <type_traits>

#include "base/error.h"

namespace kino::filters {

/// One knob of a filter: its name in a specification, the field it sets and the range it may have.
/// One table a filter serves checking, parsing, printing and the help text.
template <class Parameters>
struct Setting {
    std::string_view key;
    double (*get)(const Parameters&);
    void (*set)(Parameters&, double);
    bool whole;
    double minimum = 0;
    double maximum = 1;
    std::string_view meaning;  ///< for a person, with the unit

    [[nodiscard]] std::string range() const {
        return fmt::format("{}{} to {}", whole ? "a whole number from " : "", minimum, maximum);
    }
    [[nodiscard]] bool allows(double value) const {
        return value >= minimum && value <= maximum && (!whole || value == std::floor(value));
    }
};

/// setting<&Parameters::field>("key", minimum, maximum, "meaning, unit").
template <auto kField>
struct SettingOf;
template <class Parameters, class Value, Value Parameters::*kField>
struct SettingOf<kField> {
    static constexpr Setting<Parameters> make(std::string_view key, double minimum, double maximum,
                                              std::string_view meaning) {
        return {key,
                [](const Parameters& p) { return static_cast<double>(p.*kField); },
                [](Parameters& p, double value) { p.*kField = static_cast<Value>(value); },
                !std::is_floating_point_v<Value>,
                minimum,
                maximum,
                meaning};
    }
};
template <auto kField>
constexpr auto setting(std::string_view key, double minimum, double maximum,
                       std::string_view meaning) {
    return SettingOf<kField>::make(key, minimum, maximum, meaning);
}

/// Refuses NaN and values outside their range; says which.
template <class Parameters>
Result<void> check_settings(std::string_view filter, const Parameters& parameters) {
    for (const auto& knob : Parameters::settings()) {
        const double value = knob.get(parameters);
        if (!knob.allows(value)) {
            return fail(fmt::format("{} cannot be {}", knob.key, value), std::string(filter),
                        fmt::format("{} is {}", knob.key, knob.range()));
        }
    }
    return {};
}

/// Sets the field named `key` from its text.
template <class Parameters>
Result<void> apply_setting(std::string_view filter, std::string_view key, std::string_view text,
                           Parameters& parameters) {
    std::string known;
    for (const auto& knob : Parameters::settings()) {
        known += fmt::format("{}{}", known.empty() ? "" : ", ", knob.key);
        if (knob.key != key) continue;
        double value = 0;
        const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
        if (code != std::errc{} || end != text.data() + text.size() || !knob.allows(value)) {
            return fail(fmt::format("{} cannot be \"{}\"", key, text), std::string(filter),
                        fmt::format("{} is {}", key, knob.range()));
        }
        knob.set(parameters, value);
        return {};
    }
    return fail(fmt::format("there is no \"{}\" to set", key), std::string(filter),
                "it has " + known);
}

/// ":key=value" for everything that differs from `from`.
template <class Parameters>
std::string settings_text(const Parameters& parameters, const Parameters& from = {}) {
    std::string text;
    for (const auto& knob : Parameters::settings()) {
        const double value = knob.get(parameters);
        if (value != knob.get(from)) text += fmt::format(":{}={}", knob.key, value);
    }
    return text;
}

}  // namespace kino::filters
