#include "skeleton/actors/joint_recording.h"

#include <fmt/format.h>

#include <charconv>
#include <string>

#include "sensor/file_bytes.h"

namespace kino {
namespace {

constexpr std::string_view kHeader = "kinoscope joints,1,";
constexpr int kFarMm = 20000;
constexpr std::size_t kMaxFrames = 200000;

std::string_view next_line(std::string_view& text) {
    const std::size_t end = text.find('\n');
    std::string_view line = text.substr(0, end);
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    return line;
}

// A whole number and the comma behind it, if any.
bool next_number(std::string_view& line, int& value) {
    const auto [end, error] = std::from_chars(line.data(), line.data() + line.size(), value);
    if (error != std::errc{}) return false;
    line.remove_prefix(static_cast<std::size_t>(end - line.data()));
    return true;
}

bool parse_frame(std::string_view line, std::array<glm::dvec3, kJointCount>& frame) {
    for (std::size_t i = 0; i < 3 * kJointCount; ++i) {
        if (i > 0) {
            if (line.empty() || line.front() != ',') return false;
            line.remove_prefix(1);
        }
        int mm = 0;
        if (!next_number(line, mm) || mm < -kFarMm || mm > kFarMm) return false;
        frame[i / 3][static_cast<int>(i % 3)] = mm / 1000.0;
    }
    return line.empty();
}

}  // namespace

Result<JointRecording> parse_joint_recording(std::string_view text, const std::string& where) {
    std::string_view first = next_line(text);
    if (!first.starts_with(kHeader)) {
        return fail("this is no joint recording", where,
                    fmt::format("the first line must be \"{}RATE\"", kHeader));
    }
    first.remove_prefix(kHeader.size());
    int rate = 0;
    if (!next_number(first, rate) || !first.empty() || rate < 1 || rate > 1000) {
        return fail("the rate is not a whole number from 1 to 1000", where);
    }
    JointRecording out;
    out.rate_hz = rate;
    for (int line_number = 2; !text.empty(); ++line_number) {
        const std::string_view line = next_line(text);
        if (line.empty() || line.front() == '#') continue;
        if (out.frames.size() == kMaxFrames) {
            return fail(fmt::format("there are more than {} frames", kMaxFrames), where);
        }
        if (!parse_frame(line, out.frames.emplace_back())) {
            return fail(fmt::format("line {} is not 60 whole millimetres within 20 m", line_number),
                        where);
        }
    }
    if (out.frames.empty()) return fail("there are no frames", where);
    return out;
}

Result<JointRecording> read_joint_recording(const std::filesystem::path& path) {
    constexpr std::size_t kMostBytes = std::size_t{256} << 20;
    KINO_ASSIGN(const std::string text, read_file_text(path, kMostBytes));
    return parse_joint_recording(text, path.string());
}

}  // namespace kino
