#include "viz/frame/learning/light_table.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/check.h"

namespace kino {
namespace {

using nlohmann::json;

constexpr int kTableVersion = 1;
constexpr double kMostTableNumber = 1e12;

double* rate_of(PartRates& rates, std::string_view name) {
    if (name == light_part_name(kShadowedLights)) return &rates.shadowed;
    if (name == light_part_name(kPlainLights)) return &rates.plain;
    return name == light_part_name(kBouncedLights) ? &rates.bounced : nullptr;
}

Result<double> number_in(const json& object, const char* key, double least, double most,
                         std::string_view where) {
    const auto found = object.find(key);
    if (found == object.end() || !found->is_number()) {
        return fail(std::string("has no number \"") + key + "\"", std::string(where));
    }
    const double value = found->get<double>();
    if (!(value >= least && value <= most)) {
        return fail(std::string("has a \"") + key + "\" out of range", std::string(where));
    }
    return value;
}

}  // namespace

bool operator==(const LightTable& a, const LightTable& b) {
    const auto same = [](const LodComponent& x, const LodComponent& y) {
        return x.name == y.name && x.cost_ns == y.cost_ns && x.error == y.error &&
               x.exponent == y.exponent;
    };
    return a.reconstruction_ns == b.reconstruction_ns && a.other_ns == b.other_ns &&
           a.width == b.width && a.height == b.height && a.poses == b.poses &&
           std::equal(a.parts.begin(), a.parts.end(), b.parts.begin(), b.parts.end(), same);
}

const char* light_part_name(std::uint32_t part) {
    if (part == kShadowedLights) return "shadowed";
    return part == kPlainLights ? "plain" : "bounced";
}

LightChoice choose_rates(const LightTable& table, double budget_ns) {
    LightChoice choice;
    choice.plan = plan_nested_lod(table.parts, budget_ns, table.reconstruction_ns);
    for (std::size_t i = 0; i < table.parts.size(); ++i) {
        double* rate = rate_of(choice.rates, table.parts[i].name);
        KINO_CHECK(rate != nullptr);
        *rate = choice.plan.r[i];
    }
    return choice;
}

std::string light_table_to_json(const LightTable& table) {
    json parts = json::array();
    for (const LodComponent& part : table.parts) {
        parts.push_back({{"name", part.name},
                         {"cost_ns", part.cost_ns},
                         {"error", part.error},
                         {"exponent", part.exponent}});
    }
    const json file = {{"kinoscope_light_table", kTableVersion},
                       {"width", table.width},
                       {"height", table.height},
                       {"poses", table.poses},
                       {"reconstruction_ns", table.reconstruction_ns},
                       {"other_ns", table.other_ns},
                       {"parts", std::move(parts)}};
    return file.dump(2) + "\n";
}

Result<LightTable> light_table_from_json(std::string_view text, std::string_view where) {
    const json file = json::parse(text, nullptr, false);
    if (file.is_discarded() || !file.is_object()) {
        return fail("is no JSON object", std::string(where));
    }
    KINO_TRY(number_in(file, "kinoscope_light_table", kTableVersion, kTableVersion, where));
    LightTable table;
    const auto whole = [&](const char* key, int& into) -> Result<void> {
        KINO_ASSIGN(const double value, number_in(file, key, 1, 1 << 15, where));
        into = static_cast<int>(value);
        return {};
    };
    KINO_TRY(whole("width", table.width));
    KINO_TRY(whole("height", table.height));
    KINO_TRY(whole("poses", table.poses));
    KINO_ASSIGN(table.reconstruction_ns,
                number_in(file, "reconstruction_ns", 0, kMostTableNumber, where));
    KINO_ASSIGN(table.other_ns, number_in(file, "other_ns", 0, kMostTableNumber, where));
    const auto parts = file.find("parts");
    if (parts == file.end() || !parts->is_array()) {
        return fail("has no list \"parts\"", std::string(where));
    }
    PartRates seen;
    for (const json& part : *parts) {
        const auto name = part.is_object() ? part.find("name") : part.end();
        if (!part.is_object() || name == part.end() || !name->is_string()) {
            return fail("has a part without a name", std::string(where));
        }
        LodComponent component{.name = name->get<std::string>()};
        double* once = rate_of(seen, component.name);
        if (once == nullptr || *once != 0) {
            return fail("has a part that is unknown or there twice", std::string(where),
                        "parts are shadowed, plain and bounced");
        }
        *once = 1;
        KINO_ASSIGN(component.cost_ns, number_in(part, "cost_ns", 0, kMostTableNumber, where));
        KINO_ASSIGN(component.error, number_in(part, "error", 0, kMostTableNumber, where));
        KINO_ASSIGN(component.exponent, number_in(part, "exponent", 0.01, 16, where));
        table.parts.push_back(std::move(component));
    }
    return table;
}

}  // namespace kino
