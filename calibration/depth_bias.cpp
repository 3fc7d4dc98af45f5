#include "calibration/depth_bias.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <system_error>
#include <tuple>
#include <utility>

#include "base/check.h"
#include "sensor/file_bytes.h"
#include "sensor/json_cursor.h"

namespace kino {
namespace {

using nlohmann::ordered_json;

constexpr double kFarthestBiasedM = 100;
constexpr std::int64_t kMostCells = 256;  // a side
constexpr std::size_t kMaxBiasBytes = std::size_t{4} << 20;

Result<std::pair<int, int>> two_sizes(const JsonCursor& object, const char* key,
                                      std::int64_t most) {
    KINO_ASSIGN(const JsonCursor list, object.member(key));
    KINO_ASSIGN(const auto items, list.items(2, 2));
    KINO_ASSIGN(const std::int64_t first, items[0].integer(1, most));
    KINO_ASSIGN(const std::int64_t second, items[1].integer(1, most));
    return std::pair(static_cast<int>(first), static_cast<int>(second));
}

}  // namespace

double DepthBias::at(double x, double y) const {
    const double u = std::clamp((x + 0.5) / width * columns - 0.5, 0.0, columns - 1.0);
    const double v = std::clamp((y + 0.5) / height * rows - 0.5, 0.0, rows - 1.0);
    const int left = std::min(static_cast<int>(u), std::max(0, columns - 2));
    const int top = std::min(static_cast<int>(v), std::max(0, rows - 2));
    const auto cell = [&](int c, int r) {
        return static_cast<double>(per_m[static_cast<std::size_t>(std::min(r, rows - 1) * columns +
                                                                  std::min(c, columns - 1))]);
    };
    const double fu = u - left;
    const double fv = v - top;
    return (cell(left, top) * (1 - fu) + cell(left + 1, top) * fu) * (1 - fv) +
           (cell(left, top + 1) * (1 - fu) + cell(left + 1, top + 1) * fu) * fv;
}

void DepthBias::correct(Image<float>& depth_m) const {
    KINO_CHECK_EQ(depth_m.width(), width);
    KINO_CHECK_EQ(depth_m.height(), height);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            float& z = depth_m.at(x, y);
            if (!(z > 0)) continue;
            const double corrected = 1 / (1 / static_cast<double>(z) - at(x, y));
            z = corrected > 0 && corrected < kFarthestBiasedM ? static_cast<float>(corrected) : 0;
        }
    }
}

BiasTable::BiasTable(const DepthBias& bias, int width, int height) : per_m_(width, height) {
    const double sx = static_cast<double>(bias.width) / width;
    const double sy = static_cast<double>(bias.height) / height;
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            per_m_.at(x, y) =
                static_cast<float>(bias.at((x + 0.5) * sx - 0.5, (y + 0.5) * sy - 0.5));
        }
    }
}

void BiasTable::correct(Image<float>& depth_m) const {
    KINO_CHECK_EQ(depth_m.width(), per_m_.width());
    KINO_CHECK_EQ(depth_m.height(), per_m_.height());
    float* z = depth_m.data();
    const float* bias = per_m_.data();
    const std::size_t count = depth_m.size();
    constexpr auto kFar = static_cast<float>(kFarthestBiasedM);
    for (std::size_t i = 0; i < count; ++i) {
        const float corrected = z[i] / (1 - z[i] * bias[i]);
        // Comparisons with NaN are false, so that stays no reading.
        z[i] = corrected > 0 && corrected < kFar ? corrected : 0.0f;
    }
}

std::string bias_to_json(const DepthBias& bias, const std::string& serial) {
    const ordered_json out = {{"kinoscope_depth_bias", 1},
                              {"serial", serial},
                              {"size", {bias.width, bias.height}},
                              {"cells", {bias.columns, bias.rows}},
                              {"per_m", bias.per_m}};
    return out.dump(-1, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

Result<DepthBias> bias_from_json(std::string_view text, const std::string& serial,
                                 const std::string& where) {
    KINO_ASSIGN(const nlohmann::json document, parse_json(text, where));
    const JsonCursor object(document, where);
    KINO_TRY(object.only({"kinoscope_depth_bias", "serial", "size", "cells", "per_m"}));
    KINO_ASSIGN(const JsonCursor version, object.member("kinoscope_depth_bias"));
    KINO_TRY(version.integer(1, 1));
    std::string own;
    KINO_TRY(object.read("serial", own));
    if (!own.empty() && !serial.empty() && own != serial) {
        return fail(fmt::format("this is the depth bias of {}, not of {}", own, serial), where);
    }
    DepthBias bias;
    KINO_ASSIGN(const auto size, two_sizes(object, "size", 16384));
    KINO_ASSIGN(const auto cells, two_sizes(object, "cells", kMostCells));
    std::tie(bias.width, bias.height) = size;
    std::tie(bias.columns, bias.rows) = cells;
    const auto count = static_cast<std::size_t>(bias.columns * bias.rows);
    KINO_ASSIGN(const JsonCursor list, object.member("per_m"));
    KINO_ASSIGN(const auto items, list.items(count, count));
    for (const JsonCursor& item : items) {
        KINO_ASSIGN(const double value, item.number());
        if (!(std::abs(value) <= 1)) return item.error("a bias lies between -1 and 1 per metre");
        bias.per_m.push_back(static_cast<float>(value));
    }
    return bias;
}

Result<void> write_bias_file(const std::filesystem::path& path, const DepthBias& bias,
                             const std::string& serial) {
    const std::string text = bias_to_json(bias, serial);
    return write_file_bytes(path, text.data(), text.size());
}

Result<DepthBias> read_bias_file(const std::filesystem::path& path, const std::string& serial) {
    KINO_ASSIGN(const std::string text, read_file_text(path, kMaxBiasBytes));
    return bias_from_json(text, serial, path.string());
}

std::filesystem::path bias_file_beside(const std::filesystem::path& calibration) {
    std::filesystem::path out = calibration;
    return out.replace_extension(".bias.json");
}

Result<std::optional<DepthBias>> bias_beside(const std::filesystem::path& calibration,
                                             const std::string& serial) {
    const std::filesystem::path file = bias_file_beside(calibration);
    std::error_code error;
    if (calibration.empty() || !std::filesystem::exists(file, error)) return std::nullopt;
    KINO_ASSIGN(DepthBias bias, read_bias_file(file, serial));
    return bias;
}

}  // namespace kino
