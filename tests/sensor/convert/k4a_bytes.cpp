#include "k4a_bytes.h"

#include <cstring>

namespace kino::test {
namespace {

void append(Bytes& out, const Bytes& more) {
    out.insert(out.end(), more.begin(), more.end());
}

Bytes big(std::uint64_t value, int bytes) {
    Bytes out;
    for (int i = bytes - 1; i >= 0; --i) out.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
    return out;
}

Bytes little(std::uint64_t value, int bytes) {
    Bytes out;
    for (int i = 0; i < bytes; ++i) out.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
    return out;
}

Bytes id_of(std::uint32_t id) {
    int bytes = 1;
    while (bytes < 4 && id >> (8 * bytes) != 0) ++bytes;
    return big(id, bytes);
}

/// Sizes always in four bytes.
Bytes element(std::uint32_t id, const Bytes& content) {
    Bytes out = id_of(id);
    append(out, big(0x10000000u | content.size(), 4));
    append(out, content);
    return out;
}

Bytes number(std::uint32_t id, std::uint64_t value) {
    return element(id, big(value, 8));
}

Bytes text(std::uint32_t id, const std::string& value) {
    return element(id, Bytes(value.begin(), value.end()));
}

template <class... Parts>
Bytes join(const Parts&... parts) {
    Bytes out;
    (append(out, parts), ...);
    return out;
}

Bytes bitmap_info(int width, int height, int bits, const std::string& fourcc) {
    return join(little(40, 4), little(static_cast<std::uint64_t>(width), 4),
                little(static_cast<std::uint64_t>(height), 4), little(1, 2),
                little(static_cast<std::uint64_t>(bits), 2), Bytes(fourcc.begin(), fourcc.end()),
                Bytes(20, 0));
}

Bytes video_track(std::uint64_t track, const std::string& name, int width, int height, int bits,
                  const std::string& fourcc) {
    return element(0xAE,
                   join(number(0xD7, track), number(0x73C5, 1000 + track), number(0x83, 1),
                        text(0x86, "V_MS/VFW/FOURCC"), text(0x536E, name),
                        element(0x63A2, bitmap_info(width, height, bits, fourcc)),
                        number(0x23E383, 33'333'333),
                        element(0xE0, join(number(0xB0, static_cast<std::uint64_t>(width)),
                                           number(0xBA, static_cast<std::uint64_t>(height))))));
}

Bytes tag(const std::string& name, const std::string& value) {
    return element(0x7373, join(element(0x63C0, {}),
                                element(0x67C8, join(text(0x45A3, name), text(0x4487, value)))));
}

Bytes simple_block(std::uint8_t track, int relative_us, const Bytes& data) {
    return element(0xA3, join(Bytes{static_cast<std::uint8_t>(0x80 | track)},
                              big(static_cast<std::uint16_t>(relative_us), 2), Bytes{0x80}, data));
}

/// Two samples with fixed-size lacing.
Bytes motion_group(std::uint8_t track, int relative_us) {
    Bytes samples{1};
    for (int s = 0; s < 2; ++s) {
        append(samples, little(1000, 8));
        for (const float value : {1.0f, -2.0f, 9.0f + 2.0f * static_cast<float>(s)}) {
            std::uint32_t bits = 0;
            std::memcpy(&bits, &value, 4);
            append(samples, little(bits, 4));
        }
        append(samples, Bytes(20, 0));
    }
    constexpr std::uint8_t kFixedLacing = 0x04;
    return element(0xA0, element(0xA1, join(Bytes{static_cast<std::uint8_t>(0x80 | track)},
                                            big(static_cast<std::uint16_t>(relative_us), 2),
                                            Bytes{kFixedLacing}, samples)));
}

Bytes pixels_16(int width, int height, int frame, std::uint16_t (*value)(std::size_t, int)) {
    Bytes out;
    for (std::size_t p = 0; p < static_cast<std::size_t>(width * height); ++p) {
        append(out, big(value(p, frame), 2));
    }
    return out;
}

}  // namespace

std::uint16_t k4a_depth(std::size_t pixel, int frame) {
    return static_cast<std::uint16_t>(pixel * 7 % 5000 + static_cast<std::size_t>(frame) * 3);
}

std::uint16_t k4a_infrared(std::size_t pixel, int frame) {
    return static_cast<std::uint16_t>(pixel * 11 + static_cast<std::size_t>(frame));
}

std::uint8_t k4a_color(std::size_t byte, int frame) {
    return static_cast<std::uint8_t>(byte * 3 + byte / 251 + static_cast<std::size_t>(frame));
}

Bytes k4a_color_frame(const K4aBytes& file, int frame) {
    const auto area = static_cast<std::size_t>(file.color_width * file.color_height);
    std::size_t bytes = 999 + static_cast<std::size_t>(frame);  // MJPG: any
    if (file.color_fourcc == "NV12") bytes = area * 3 / 2;
    if (file.color_fourcc == "YUY2") bytes = area * 2;
    if (file.color_fourcc == "BGRA") bytes = area * 4;
    Bytes out(bytes);
    for (std::size_t b = 0; b < bytes; ++b) out[b] = k4a_color(b, frame);
    return out;
}

TimeNs k4a_time(int frame) {
    return frame * 33'333'000LL + 66'000;
}

Bytes make_k4a(const K4aBytes& file) {
    const Bytes head = element(
        0x1A45DFA3, join(number(0x4286, 1), number(0x42F7, 1), number(0x42F2, 4), number(0x42F3, 8),
                         text(0x4282, "matroska"), number(0x4287, 2), number(0x4285, 2)));
    Bytes content = element(0xEC, Bytes(100, 0));
    append(content, element(0x1549A966, join(number(0x2AD7B1, 1000), text(0x7BA9, "Azure Kinect"),
                                             text(0x5741, "k4arecord-1.4.1"))));
    Bytes tracks = video_track(2, file.depth_name, file.depth_width, file.depth_height, 16, "b16g");
    if (!file.color_fourcc.empty()) {
        append(tracks,
               video_track(1, "COLOR", file.color_width, file.color_height, 24, file.color_fourcc));
    }
    if (file.infrared) {
        append(tracks, video_track(3, "IR", file.depth_width, file.depth_height, 16, "b16g"));
    }
    if (file.motion) {
        append(tracks, element(0xAE, join(number(0xD7, 4), number(0x73C5, 1004), number(0x83, 17),
                                          text(0x86, "S_K4A/IMU"), text(0x536E, "IMU"))));
    }
    append(content, element(0x1654AE6B, tracks));
    if (!file.calibration.empty()) {
        append(content,
               element(0x1941A469,
                       element(0x61A7, join(text(0x466E, "calibration.json"),
                                            text(0x4660, "application/octet-stream"),
                                            text(0x465C, file.calibration + std::string(1, '\0')),
                                            number(0x46AE, 77)))));
    }
    append(content, element(0x1254C367,
                            join(tag("K4A_DEPTH_MODE", "NFOV_2X2BINNED"),
                                 tag("K4A_DEVICE_SERIAL_NUMBER", "000123"),
                                 tag("K4A_START_OFFSET_NS", std::to_string(file.start_offset)))));
    for (int i = 0; i < file.frames; ++i) {
        const TimeNs us = k4a_time(i) / 1000;
        Bytes cluster = number(0xE7, static_cast<std::uint64_t>(us));
        append(cluster,
               simple_block(2, 0, pixels_16(file.depth_width, file.depth_height, i, k4a_depth)));
        if (file.infrared) {
            append(cluster,
                   simple_block(3, 0,
                                pixels_16(file.depth_width, file.depth_height, i, k4a_infrared)));
        }
        if (!file.color_fourcc.empty()) {
            append(cluster, simple_block(1, 2000, k4a_color_frame(file, i)));
        }
        if (file.motion) append(cluster, motion_group(4, -20));
        append(content, element(0x1F43B675, cluster));
    }
    Bytes out = head;
    append(out, id_of(0x18538067));
    append(out, big(0x0100000000000000u | (file.finished ? content.size() : 0), 8));
    append(out, content);
    return out;
}

std::string sample_k4a_calibration() {
    const std::string rt = R"("Rt":{"Rotation":[1,0,0,0,1,0,0,0,1],"Translation":[0,0,0]})";
    const std::string turned =
        R"("Rt":{"Rotation":[1,0,0,0,0.8,0.6,0,-0.6,0.8],"Translation":[-0.032,-0.002,0.004]})";
    const std::string model = R"("ModelType":"CALIBRATION_LensDistortionModelBrownConrady")";
    const std::string depth = R"({"Intrinsics":{"ModelParameterCount":14,"ModelParameters":)"
                              R"([0.5,0.25,0.49,0.48,0.1,0.2,0.3,0.4,0.5,0.6,0,0,0.007,0.008],)" +
                              model + R"(},"Location":"CALIBRATION_CameraLocationD0",)" + rt +
                              R"(,"SensorHeight":1024,"SensorWidth":1024})";
    const std::string color = R"({"Intrinsics":{"ModelParameterCount":14,"ModelParameters":)"
                              R"([0.51,0.52,0.47,0.63,0,0,0,0,0,0,0,0,-0.001,-0.002],)" +
                              model + R"(},"Location":"CALIBRATION_CameraLocationPV0",)" + turned +
                              R"(,"SensorHeight":3072,"SensorWidth":4096})";
    const std::string accelerometer =
        R"({"SensorType":"CALIBRATION_InertialSensorType_Accelerometer",)"
        R"("Rt":{"Rotation":[0,0,1,1,0,0,0,1,0],"Translation":[0,0,0]}})";
    return R"({"CalibrationInformation":{"Cameras":[)" + depth + "," + color +
           R"(],"InertialSensors":[)" + accelerometer + "]}}";
}

}  // namespace kino::test
