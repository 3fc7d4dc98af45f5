#include "sensor/kinect1/camera_mode.h"

#include <array>
#include <vector>

namespace kino::kinect1 {
namespace {

constexpr int kDepthPayload = 1748;
constexpr int kVideoPayload = 1908;
constexpr std::uint8_t kVideoEndpoint = 0x81;
constexpr std::uint8_t kDepthEndpoint = 0x82;

constexpr ModeTraits depth(int bits, const char* format) {
    return {StreamKind::depth,
            640,
            480,
            30,
            bits,
            1,
            kDepthEndpoint,
            kDepthPayload + kPacketHeaderBytes,
            format};
}
constexpr ModeTraits video(StreamKind kind, int width, int height, double hz, int bits, int group,
                           const char* format) {
    return {kind,  width, height,         hz,
            bits,  group, kVideoEndpoint, kVideoPayload + kPacketHeaderBytes,
            format};
}

constexpr std::array<ModeTraits, 6> kTraits = {
    depth(11, "11 bit Kinect disparity"),
    depth(10, "10 bit Kinect disparity"),
    video(StreamKind::color, 640, 480, 30, 8, 1, "Bayer GRBG"),
    video(StreamKind::color, 1280, 1024, 10, 8, 1, "Bayer GRBG"),
    video(StreamKind::color, 640, 480, 15, 16, 2, "UYVY"),
    video(StreamKind::infrared, 640, 488, 30, 10, 1, "10 bit"),
};

struct RegisterValue {
    std::uint16_t address;
    std::uint16_t value;
};

// libfreenect cameras.c, freenect_start_depth and freenect_start_video; the OpenKinect wiki names
// the registers: 0x05 and 0x06 switch, 0x0c.. colour, 0x12.. depth, 0x19.. infrared {format, size,
// rate}, 0x17, 0x47 and 0x48 mirror, 0x105 lets the projector pause by itself.
std::vector<RegisterValue> registers_of(CameraMode mode) {
    switch (mode) {
        case CameraMode::depth_11bit:
        case CameraMode::depth_10bit: {
            const std::uint16_t format = mode == CameraMode::depth_11bit ? 3 : 2;
            return {{0x105, 0}, {0x06, 0}, {0x12, format}, {0x13, 1},
                    {0x14, 30}, {0x06, 2}, {0x17, 0}};
        }
        case CameraMode::color_bayer:
            return {{0x0c, 0}, {0x0d, 1}, {0x0e, 30}, {0x05, 1}, {0x47, 0}};
        case CameraMode::color_bayer_high:
            return {{0x0c, 0}, {0x0d, 2}, {0x0e, 15}, {0x05, 1}, {0x47, 0}};
        case CameraMode::color_yuv:
            return {{0x0c, 5}, {0x0d, 1}, {0x0e, 15}, {0x05, 1}, {0x47, 0}};
        case CameraMode::infrared:
            return {{0x19, 0}, {0x1a, 1}, {0x1b, 30}, {0x105, 0}, {0x05, 3}, {0x48, 0}};
    }
    return {};
}

}  // namespace

const ModeTraits& traits(CameraMode mode) {
    return kTraits[static_cast<std::size_t>(mode)];
}

PacketLayout packet_layout(CameraMode mode) {
    const ModeTraits& t = traits(mode);
    PacketLayout layout;
    layout.flag_base = t.endpoint == kDepthEndpoint ? 0x70 : 0x80;
    layout.payload_bytes = t.packet_bytes - kPacketHeaderBytes;
    layout.frame_bytes = t.width * t.height * t.bits_per_pixel / 8;
    layout.longest_frame = static_cast<std::uint32_t>(0.96 * kTicksPerSecond / t.nominal_hz);
    return layout;
}

usb::Outcome<void> switch_on(CameraCommands& commands, CameraMode mode) {
    for (const RegisterValue& r : registers_of(mode)) {
        if (auto written = commands.write_register(r.address, r.value); !written) return written;
    }
    return {};
}

void switch_off(CameraCommands& commands, CameraMode mode) {
    const bool is_depth = traits(mode).kind == StreamKind::depth;
    (void)commands.write_register_once(is_depth ? 0x06 : 0x05, 0);
}

}  // namespace kino::kinect1
