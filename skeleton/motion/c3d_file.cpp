#include "skeleton/motion/c3d_file.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <initializer_list>
#include <string_view>

#include "base/check.h"

namespace kino::motion_export {
namespace {

constexpr std::size_t kBlock = 512;
constexpr char kC3dMagic = 0x50;
constexpr char kPcProcessor = 84;  // 83 + 1: little endian, IEEE floats
constexpr float kScale = -1;       // negative: the data are floats
constexpr int kPoint = 1, kAnalog = 2, kTrial = 3;

void put_u16(std::string& out, std::size_t value) {
    out += static_cast<char>(value & 0xff);
    out += static_cast<char>(value >> 8 & 0xff);
}

std::string float_bytes(float value) {
    const auto bits = std::bit_cast<std::uint32_t>(value);
    std::string out;
    put_u16(out, bits & 0xffff);
    put_u16(out, bits >> 16);
    return out;
}

std::string u16_bytes(std::size_t value) {
    std::string out;
    put_u16(out, value);
    return out;
}

void fill_block(std::string& out) {
    out.resize((out.size() + kBlock - 1) / kBlock * kBlock, '\0');
}

/// The parameter section's records. Each names how far it is to the next; the last names 0.
class Parameters {
  public:
    void group(int id, std::string_view name, std::string_view description) {
        begin(-id, name);
        text(description);
    }
    void integer(int group, std::string_view name, std::size_t value) {
        parameter(group, name, 2, {}, u16_bytes(value));
    }
    void integers(int group, std::string_view name, std::size_t a, std::size_t b) {
        parameter(group, name, 2, {2}, u16_bytes(a) + u16_bytes(b));
    }
    void real(int group, std::string_view name, float value) {
        parameter(group, name, 4, {}, float_bytes(value));
    }
    void string(int group, std::string_view name, std::string_view value) {
        parameter(group, name, -1, {value.size()}, std::string(value));
    }
    void joint_names(int group, std::string_view name) {
        std::size_t width = 0;
        for (std::size_t j = 0; j < kJointCount; ++j) {
            width = std::max(width, std::string_view(joint_name(static_cast<Joint>(j))).size());
        }
        std::string all;
        for (std::size_t j = 0; j < kJointCount; ++j) {
            std::string label = joint_name(static_cast<Joint>(j));
            label.resize(width, ' ');
            all += label;
        }
        parameter(group, name, -1, {width, kJointCount}, all);
    }
    /// Ends the section, which is then whole blocks.
    std::string finish() {
        fill_block(bytes_);
        bytes_[2] = static_cast<char>(bytes_.size() / kBlock);
        return std::move(bytes_);
    }

  private:
    void begin(int group, std::string_view name) {
        link();
        bytes_ += static_cast<char>(name.size());
        bytes_ += static_cast<char>(group);
        bytes_ += name;
        last_ = bytes_.size();
        put_u16(bytes_, 0);
    }
    void link() {
        if (last_ == 0) return;
        const std::string distance = u16_bytes(bytes_.size() - last_);
        bytes_.replace(last_, 2, distance);
    }
    void text(std::string_view description) {
        bytes_ += static_cast<char>(description.size());
        bytes_ += description;
    }
    void parameter(int group, std::string_view name, int type,
                   std::initializer_list<std::size_t> dimensions, const std::string& data) {
        begin(group, name);
        bytes_ += static_cast<char>(type);
        bytes_ += static_cast<char>(dimensions.size());
        for (const std::size_t d : dimensions) bytes_ += static_cast<char>(d);
        bytes_ += data;
        text({});
    }

    std::string bytes_{'\1', kC3dMagic, '\0', kPcProcessor};
    std::size_t last_ = 0;
};

std::string parameters(std::size_t frames, double rate_hz, std::size_t data_block) {
    Parameters p;
    p.group(kPoint, "POINT", "joints");
    p.integer(kPoint, "USED", kJointCount);
    p.integer(kPoint, "FRAMES", frames);
    p.integer(kPoint, "DATA_START", data_block);
    p.real(kPoint, "SCALE", kScale);
    p.real(kPoint, "RATE", static_cast<float>(rate_hz));
    p.string(kPoint, "UNITS", "mm");
    p.string(kPoint, "X_SCREEN", "+X");
    p.string(kPoint, "Y_SCREEN", "+Y");
    p.joint_names(kPoint, "LABELS");
    p.joint_names(kPoint, "DESCRIPTIONS");
    p.group(kAnalog, "ANALOG", "none");
    p.integer(kAnalog, "USED", 0);
    p.group(kTrial, "TRIAL", "frames");
    p.integers(kTrial, "ACTUAL_START_FIELD", 1, 0);
    p.integers(kTrial, "ACTUAL_END_FIELD", frames, 0);
    return p.finish();
}

}  // namespace

std::string c3d_bytes(const JointTrack& track, double rate_hz) {
    const std::size_t frames = track.frames.size();
    KINO_CHECK_LE(frames, kC3dMostFrames);
    const std::size_t parameter_blocks = parameters(frames, rate_hz, 0).size() / kBlock;
    const std::size_t data_block = 2 + parameter_blocks;  // blocks count from 1

    std::string out{'\2', kC3dMagic};
    put_u16(out, kJointCount);
    put_u16(out, 0);  // analog values a frame
    put_u16(out, 1);
    put_u16(out, frames);
    put_u16(out, 0);  // longest gap interpolated
    out += float_bytes(kScale);
    put_u16(out, data_block);
    put_u16(out, 0);  // analog samples a frame
    out += float_bytes(static_cast<float>(rate_hz));
    fill_block(out);
    out += parameters(frames, rate_hz, data_block);
    for (const TrackFrame& frame : track.frames) {
        for (std::size_t j = 0; j < kJointCount; ++j) {
            const glm::dvec3 mm = frame.seen[j] ? frame.world_m[j] * 1000.0 : glm::dvec3(0);
            out += float_bytes(static_cast<float>(mm.x));
            out += float_bytes(static_cast<float>(mm.y));
            out += float_bytes(static_cast<float>(mm.z));
            out += float_bytes(frame.seen[j] ? 0.0F : -1.0F);
        }
    }
    fill_block(out);
    return out;
}

}  // namespace kino::motion_export
