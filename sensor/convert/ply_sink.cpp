#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <optional>
#include <string>
#include <system_error>
#include <utility>

#include "sensor/convert/folder_frames.h"
#include "sensor/convert/sinks.h"
#include "sensor/convert/staged_output.h"
#include "sensor/file_bytes.h"

namespace kino {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kPointBytes = 15;

void append_float(std::string& out, float value) {
    const auto bits = std::bit_cast<std::uint32_t>(value);
    for (int shift = 0; shift < 32; shift += 8) out.push_back(static_cast<char>(bits >> shift));
}

std::string ply_text(const std::vector<CloudPoint>& points) {
    std::string out = fmt::format(
        "ply\nformat binary_little_endian 1.0\ncomment metres, y up\nelement vertex {}\n"
        "property float x\nproperty float y\nproperty float z\n"
        "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n",
        points.size());
    out.reserve(out.size() + points.size() * kPointBytes);
    for (const CloudPoint& point : points) {
        for (const float value : {point.x, point.y, point.z}) append_float(out, value);
        for (const std::uint8_t channel : {point.color.r, point.color.g, point.color.b}) {
            out.push_back(static_cast<char>(channel));
        }
    }
    return out;
}

/// "%05d" taken apart: what stands before it and behind it, and how many digits at least.
struct Pattern {
    std::string before;
    std::string after;
    int digits = 0;

    [[nodiscard]] std::string name(std::int64_t index) const {
        return fmt::format("{}{:0{}}{}", before, index, digits, after);
    }
};

/// None where the name holds no %; an error where what follows is no plain number format.
Result<std::optional<Pattern>> parse_pattern(const std::string& name) {
    const std::size_t percent = name.find('%');
    if (percent == std::string::npos) return std::optional<Pattern>();
    std::size_t at = percent + 1;
    Pattern out;
    out.before = name.substr(0, percent);
    while (at < name.size() && name[at] >= '0' && name[at] <= '9' && out.digits < 20) {
        out.digits = out.digits * 10 + (name[at++] - '0');
    }
    if (at >= name.size() || name[at] != 'd' || out.digits > 20 ||
        name.find('%', at) != std::string::npos) {
        return fail("the pattern must hold one %d or %05d and no other %", name);
    }
    out.after = name.substr(at + 1);
    return std::optional(out);
}

class PlySink final : public FrameSink {
  public:
    PlySink(StagedOutput folder, ConvertInput input, const SinkOptions& options)
        : folder_(std::move(folder)), input_(std::move(input)), options_(options) {}

    /// Files go to their own names in finish(), the folder stays behind and is taken away.
    void scatter(fs::path parent, std::optional<Pattern> pattern, std::string single) {
        parent_ = std::move(parent);
        pattern_ = std::move(pattern);
        single_ = std::move(single);
        scattered_ = true;
    }

    bool takes_sets() const override { return true; }

    Result<void> put(const FrameSet& set) override {
        if (!set.depth) {
            losses_.add("moments without depth");
            return {};
        }
        if (scattered_ && !pattern_ && !names_.empty()) {
            return fail(fmt::format("\"{}\" is the name of one frame, there are more", single_), {},
                        "a folder, a pattern like cloud_%05d.ply, or --from N --count 1");
        }
        KINO_TRY(input_.geometry->points(set, points_));
        const std::int64_t index = options_.first_index + written(StreamKind::depth);
        const std::string name = !scattered_ ? fmt::format("{:05}.ply", index)
                                 : pattern_  ? pattern_->name(index)
                                             : single_;
        const std::string text = ply_text(points_);
        KINO_TRY(write_file_bytes(folder_.path() / name, text.data(), text.size()));
        names_.push_back(name);
        count(StreamKind::depth);
        losses_.state("a cloud holds points in metres: raw depth, calibration and time are gone");
        if (set.infrared) add_unheld(StreamKind::infrared, losses_);
        if (set.bodies) add_unheld(StreamKind::bodies, losses_);
        if (set.motion) add_unheld(StreamKind::motion, losses_);
        return {};
    }

    Result<void> finish() override {
        if (names_.empty()) {
            return fail("there is no depth frame to write", folder_.target().string());
        }
        if (!scattered_) return folder_.commit();
        std::error_code error;
        for (const std::string& name : names_) {
            const fs::path target = parent_ / name;
            if (!options_.replace && fs::exists(fs::symlink_status(target, error))) {
                return fail("the file exists already", target.string(), "--force replaces it");
            }
        }
        for (std::size_t i = 0; i < names_.size(); ++i) {
            fs::rename(folder_.path() / names_[i], parent_ / names_[i], error);
            if (!error) continue;
            const std::string reason = error.message();
            for (std::size_t k = 0; k < i; ++k) fs::remove(parent_ / names_[k], error);
            return fail(reason, (parent_ / names_[i]).string());
        }
        return {};
    }

  private:
    StagedOutput folder_;
    ConvertInput input_;
    SinkOptions options_;
    bool scattered_ = false;
    fs::path parent_;
    std::optional<Pattern> pattern_;
    std::string single_;
    std::vector<std::string> names_;
    std::vector<CloudPoint> points_;
};

}  // namespace

Result<std::unique_ptr<FrameSink>> make_ply_sink(const fs::path& out, const ConvertInput& input,
                                                 const SinkOptions& options) {
    const std::string name = out.filename().string();
    KINO_ASSIGN(auto pattern, parse_pattern(name));
    const bool single = out.extension() == ".ply";
    if (!pattern && !single) {
        KINO_ASSIGN(StagedOutput folder, StagedOutput::folder(out, options.replace));
        return std::make_unique<PlySink>(std::move(folder), input, options);
    }
    const fs::path parent = out.has_parent_path() ? out.parent_path() : fs::path(".");
    std::error_code error;
    if (!fs::is_directory(parent, error)) {
        return fail("there is no such folder", parent.string(), "make it first");
    }
    const fs::path first = parent / (pattern ? pattern->name(options.first_index) : name);
    if (!options.replace && fs::exists(fs::symlink_status(first, error))) {
        return fail("the file exists already", first.string(), "--force replaces it");
    }
    KINO_ASSIGN(StagedOutput folder, StagedOutput::folder(parent / (name + ".files"), false));
    auto sink = std::make_unique<PlySink>(std::move(folder), input, options);
    sink->scatter(parent, std::move(pattern), name);
    return sink;
}

}  // namespace kino
