#pragma once

#include <filesystem>
#include <random>

#include "base/check.h"
#include "driver/test_frames.h"
#include "sensor/openni2/oni_writer.h"

namespace kino::test {

inline DepthFrame sample_depth(int index, int width = camera::kWidth,
                               int height = camera::kHeight) {
    DepthFrame frame;
    frame.header.device_time = from_seconds(100) + index * 33'333'333LL;
    frame.header.sequence = index;
    frame.raw = Image<std::uint16_t>(width, height);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) frame.raw.at(x, y) = camera::depth_at(x, y, index);
    }
    return frame;
}

inline ColorFrame sample_color(int index, int width = camera::kWidth,
                               int height = camera::kHeight) {
    ColorFrame frame;
    frame.header.device_time = from_seconds(100) + index * 33'333'333LL;
    frame.header.sequence = index;
    frame.format = PixelFormat::rgb8;
    frame.width = width;
    frame.height = height;
    frame.pitch = 3 * width;
    frame.bytes.resize(static_cast<std::size_t>(frame.pitch * height));
    for (int y = 0; y < height; ++y) {
        for (int b = 0; b < frame.pitch; ++b) {
            frame.bytes[static_cast<std::size_t>(y * frame.pitch + b)] =
                camera::color_at(b, y, index);
        }
    }
    return frame;
}

inline RigParameters sample_rig(bool color, int width = camera::kWidth,
                                int height = camera::kHeight) {
    RigParameters rig = default_kinect1_rig(width, height);
    if (color) {
        rig.color->fx *= static_cast<double>(width) / rig.color->width;
        rig.color->fy = rig.color->fx;
        rig.color->cx = (width - 1) / 2.0;
        rig.color->cy = (height - 1) / 2.0;
        rig.color->width = width;
        rig.color->height = height;
    } else {
        rig.color.reset();
    }
    return rig;
}

/// Frames 1 to `count`, colour at the same times as depth.
inline void write_sample(const std::filesystem::path& file, int count, bool color,
                         int width = camera::kWidth, int height = camera::kHeight) {
    auto writer = OniWriter::create(file, sample_rig(color, width, height));
    KINO_CHECK(writer.has_value());
    for (int i = 1; i <= count; ++i) {
        const ColorFrame picture = sample_color(i, width, height);
        KINO_CHECK((*writer)
                       ->write(sample_depth(i, width, height), color ? &picture : nullptr)
                       .has_value());
    }
    KINO_CHECK((*writer)->close().has_value());
}

}  // namespace kino::test
