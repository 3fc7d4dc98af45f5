#include "sensor/kinect1/factory_data.h"

#include <bit>
#include <cmath>
#include <cstring>

namespace kino::kinect1 {
namespace {

using usb::Failure;
using usb::Outcome;
using ByteView = std::span<const std::uint8_t>;

// Every block but the fixed parameters starts with a word of status.
constexpr std::size_t kStatusBytes = 2;
constexpr std::size_t kZeroPlaneOffset = 94;
constexpr std::size_t kRegistrationWords = 29;
constexpr std::uint16_t kRegistrationId = 0x40;
constexpr std::uint16_t kPaddingId = 0x41;
constexpr std::uint16_t kConstShiftId = 0x00;

std::uint16_t u16_at(ByteView data, std::size_t offset) {
    return static_cast<std::uint16_t>(data[offset] | data[offset + 1] << 8);
}

std::uint32_t u32_at(ByteView data, std::size_t offset) {
    return static_cast<std::uint32_t>(u16_at(data, offset)) |
           static_cast<std::uint32_t>(u16_at(data, offset + 2)) << 16;
}

double float_at(ByteView data, std::size_t offset) {
    return std::bit_cast<float>(u32_at(data, offset));
}

bool between(double value, double low, double high) {
    return value >= low && value <= high;  // false for NaN
}

}  // namespace

std::optional<ZeroPlane> parse_zero_plane(ByteView data) {
    if (data.size() < kZeroPlaneOffset + 16) return std::nullopt;
    const ZeroPlane plane{float_at(data, kZeroPlaneOffset), float_at(data, kZeroPlaneOffset + 4),
                          float_at(data, kZeroPlaneOffset + 8),
                          float_at(data, kZeroPlaneOffset + 12)};
    // Twice and half of what every known unit says.
    if (!between(plane.emitter_distance_cm, 3.75, 15) ||
        !between(plane.color_distance_cm, 1.1, 5) ||
        !between(plane.reference_distance_cm, 60, 240) ||
        !between(plane.reference_pixel_size_mm, 0.05, 0.21)) {
        return std::nullopt;
    }
    return plane;
}

std::optional<RegistrationBlock> parse_registration(ByteView data) {
    if (data.size() != kStatusBytes + 4 * kRegistrationWords) return std::nullopt;
    std::array<std::int32_t, kRegistrationWords> words{};
    bool any = false;
    for (std::size_t i = 0; i < words.size(); ++i) {
        words[i] = static_cast<std::int32_t>(u32_at(data, kStatusBytes + 4 * i));
        any |= words[i] != 0;
    }
    if (!any) return std::nullopt;
    static_assert(sizeof(RegistrationBlock) == sizeof words);
    return std::bit_cast<RegistrationBlock>(words);
}

std::optional<RegistrationPadding> parse_padding(ByteView data) {
    if (data.size() != kStatusBytes + 6) return std::nullopt;
    const RegistrationPadding padding{u16_at(data, 2), u16_at(data, 4), u16_at(data, 6)};
    if (padding.start_lines > 480) return std::nullopt;
    return padding;
}

std::optional<std::uint16_t> parse_const_shift(ByteView data) {
    if (data.size() != kStatusBytes + 2) return std::nullopt;
    const std::uint16_t shift = u16_at(data, kStatusBytes);
    // 200 in every known unit.
    if (shift < 100 || shift > 400) return std::nullopt;
    return shift;
}

Outcome<FactoryData> read_factory_data(CameraCommands& commands) {
    FactoryData out;
    const auto note = [&out](const char* part, const std::string& why) {
        out.problems += (out.problems.empty() ? "" : "; ") + std::string(part) + ": " + why;
    };
    // {id, format, resolution 1 = 640x480, 30 Hz, offset}: the tables for the usual picture.
    const auto block = [&](std::uint16_t id) {
        const std::array<std::uint16_t, 5> words = {id, 0, 1, 30, 0};
        return commands.send(Command::algorithm_parameters, words);
    };
    const auto take = [&](auto reply, const char* part, auto parse, auto& into) -> bool {
        if (!reply) {
            note(part, reply.error().what);
            return reply.error().kind != Failure::no_device;
        }
        if (auto value = parse(ByteView(*reply))) {
            into = *value;
        } else {
            note(part, "what the device says cannot be used");
        }
        return true;
    };
    constexpr std::array<std::uint16_t, 5> kFromTheStart = {};
    const bool present =
        take(commands.send(Command::fixed_parameters, kFromTheStart), "zero plane",
             parse_zero_plane, out.zero_plane) &&
        take(block(kRegistrationId), "registration", parse_registration, out.registration) &&
        take(block(kPaddingId), "padding", parse_padding, out.padding) &&
        take(block(kConstShiftId), "shift", parse_const_shift, out.const_shift);
    if (!present) return usb::fault(Failure::no_device, "the sensor has gone: " + out.problems);
    return out;
}

DisparityParameters disparity_of(const FactoryData& data) {
    DisparityParameters out;
    if (data.const_shift) out.const_shift = *data.const_shift;
    if (data.zero_plane) {
        out.reference_pixel_size_mm = data.zero_plane->reference_pixel_size_mm;
        out.reference_distance_cm = data.zero_plane->reference_distance_cm;
        out.emitter_distance_cm = data.zero_plane->emitter_distance_cm;
    }
    return out;
}

}  // namespace kino::kinect1
