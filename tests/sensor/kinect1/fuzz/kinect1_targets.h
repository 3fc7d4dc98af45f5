#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

#include "base/check.h"
#include "sensor/kinect1/camera_commands.h"
#include "sensor/kinect1/factory_rig.h"
#include "sensor/kinect1/frame_maker.h"
#include "sensor/kinect1/motor.h"
#include "sensor/kinect1/registration_map.h"

/// What the parsers promise for any bytes at all. Shared by the libFuzzer drivers beside this file
/// and by mutation_test.cpp.
namespace kino::fuzz {

/// First byte: the mode. Then packets, each after its length in two bytes, little-endian.
inline void kinect1_packets(std::span<const std::uint8_t> bytes) {
    using namespace kinect1;
    if (bytes.empty()) return;
    const auto mode = static_cast<CameraMode>(bytes[0] % 6);
    const PacketLayout layout = packet_layout(mode);
    std::int64_t frames = 0;
    PacketAssembler assembler(layout, [&](const AssembledFrame& frame) {
        ++frames;
        KINO_CHECK_EQ(static_cast<int>(frame.bytes.size()), layout.frame_bytes);
        KINO_CHECK(frame.lost_before >= 0);
        int last = -1;
        int missing = 0;
        for (const ByteRange& range : frame.missing) {
            KINO_CHECK(range.first > last && range.end > range.first);
            KINO_CHECK_LE(range.end, layout.frame_bytes);
            last = range.end;
            missing += range.end - range.first;
        }
        KINO_CHECK_LE(missing, layout.frame_bytes / 4);
        (void)make_frame(mode, frame, {});
    });
    bytes = bytes.subspan(1);
    while (bytes.size() >= 2) {
        const std::size_t length =
            std::min<std::size_t>(bytes[0] | bytes[1] << 8, bytes.size() - 2);
        assembler.feed(bytes.subspan(2, length), 0);
        bytes = bytes.subspan(2 + length);
    }
    KINO_CHECK_EQ(frames, assembler.counts().frames);
}

/// A reply to each command, its data as every calibration block, and as the motor's state.
inline void kinect1_replies(std::span<const std::uint8_t> bytes) {
    using namespace kinect1;
    for (const Command command : {Command::read_register, Command::fixed_parameters,
                                  Command::algorithm_parameters, Command::color_sensor}) {
        const ParsedReply reply = parse_reply(bytes, command, 1);
        KINO_CHECK(reply.flaw == ReplyFlaw::none || reply.data.empty());
        KINO_CHECK(reply.data.size() <= bytes.size());
    }
    const auto data = bytes.size() > 8 ? bytes.subspan(8) : bytes;
    FactoryData factory;
    factory.zero_plane = parse_zero_plane(data);
    factory.registration = parse_registration(data);
    factory.const_shift = parse_const_shift(data);
    if (const auto padding = parse_padding(data)) factory.padding = *padding;
    KINO_CHECK(
        validate(factory_rig({.zero_plane = factory.zero_plane}, CameraMode::color_bayer, ""))
            .has_value());
    if (factory.registration) {
        const RegistrationMap map(*factory.registration, factory.padding, ZeroPlane{});
        KINO_CHECK(std::isfinite(map.at(639, 479, 1).x));
    }
    const auto state = parse_motor_state(bytes);
    KINO_CHECK(!state || std::isfinite(state->acceleration_m_s2[2]));
}

}  // namespace kino::fuzz
