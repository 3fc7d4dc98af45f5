#include <fmt/format.h>

#include "calibration/files/camera_text.h"
#include "calibration/files/yaml_numbers.h"
#include "sensor/decimal.h"

namespace kino {
namespace {

constexpr std::size_t kMaxLineBytes = 65536;

// "# size: 640 480"
std::optional<std::pair<int, int>> size_in(std::string_view comment) {
    comment.remove_prefix(1);
    if (next_word(comment) != "size:") return std::nullopt;
    const auto width = parse_number(next_word(comment));
    const auto height = parse_number(next_word(comment));
    const auto good = [](const std::optional<double>& v) {
        return v && *v >= 1 && *v <= 16384 && *v == static_cast<int>(*v);
    };
    if (!good(width) || !good(height)) return std::nullopt;
    return std::pair(static_cast<int>(*width), static_cast<int>(*height));
}

}  // namespace

Result<std::string> tum_intrinsics(const NamedCamera& named) {
    const CameraModel& c = named.camera;
    const auto distortion = distortion_numbers(c);
    if (distortion.size() > 5) {
        return fail("this format cannot hold the rational lens model", named.name,
                    "calibrate with --model brown5, or write another format");
    }
    std::string name = named.name;
    for (char& letter : name) {
        if (static_cast<unsigned char>(letter) < ' ') letter = ' ';
    }
    const std::array<double, 4> pinhole = {c.fx, c.fy, c.cx, c.cy};
    const auto spaced = [](std::span<const double> numbers) {
        return fmt::format("{}", fmt::join(numbers, " "));
    };
    return fmt::format("# {}\n# size: {} {}\n# fx fy cx cy k1 k2 p1 p2 k3\n{} {}\n", name, c.width,
                       c.height, spaced(pinhole), spaced(distortion));
}

Result<NamedCamera> read_tum_intrinsics(std::string_view text, const std::string& where,
                                        std::optional<std::pair<int, int>> size) {
    if (text.size() > kMaxLineBytes) return fail("too long for a line of numbers", where);
    NamedCamera out;
    std::vector<double> numbers;
    bool first = true;
    while (!text.empty()) {
        const std::size_t end = std::min(text.find('\n'), text.size());
        std::string_view line = text.substr(0, end);
        text.remove_prefix(std::min(end + 1, text.size()));
        if (line.ends_with('\r')) line.remove_suffix(1);
        if (line.starts_with('#')) {
            if (const auto stated = size_in(line)) {
                size = stated;
            } else if (first && line.size() > 2) {
                out.name = line.substr(2);
            }
            first = false;
            continue;
        }
        for (std::string_view word = next_word(line); !word.empty(); word = next_word(line)) {
            const auto value = parse_number(word);
            if (!value) return fail(fmt::format("\"{}\" is no number", word), where);
            if (numbers.size() == 9) return fail("more than nine numbers", where);
            numbers.push_back(*value);
        }
    }
    if (numbers.size() < 4) {
        return fail(fmt::format("{} numbers; fx fy cx cy at least", numbers.size()), where);
    }
    if (!size) {
        return fail("the file does not say how large the picture is", where, "state its size");
    }
    numbers.resize(9);
    out.camera = {.width = size->first,
                  .height = size->second,
                  .fx = numbers[0],
                  .fy = numbers[1],
                  .cx = numbers[2],
                  .cy = numbers[3]};
    KINO_TRY(set_distortion(out.camera, {numbers.begin() + 4, numbers.end()}, where));
    KINO_TRY(validate(out.camera, where));
    return out;
}

}  // namespace kino
