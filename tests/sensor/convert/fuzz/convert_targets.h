#pragma once

#include <cstdint>
#include <span>

#include "base/check.h"
#include "sensor/convert/bag_import.h"
#include "sensor/convert/k4a_mkv.h"

/// What the imports promise for any bytes at all: no crash, times that rise, frames of the size
/// that was announced, a sound rig. Shared by the libFuzzer drivers beside this file and by
/// convert_mutation_test.cpp. Answers how many frame sets could be read.
namespace kino::fuzz {

inline int play(Result<std::unique_ptr<Source>> opened) {
    if (!opened) {
        KINO_CHECK(!opened.error().what.empty());
        return 0;
    }
    Source& source = **opened;
    const auto rig = source.calibration();
    KINO_CHECK(rig.has_value() && validate(*rig).has_value());
    KINO_CHECK(subscribe_all(source).has_value());
    KINO_CHECK(source.set_tap([](StreamId, const StreamFrame&) {}));
    const Timeline& timeline = *source.timeline();
    for (std::int64_t i = 1; i < timeline.frame_count(); ++i) {
        KINO_CHECK(timeline.time_of(i) > timeline.time_of(i - 1));
    }
    int sets = 0;
    constexpr int kMost = 8;
    for (int i = 0; i < kMost && i < timeline.frame_count(); ++i) {
        const auto set = source.next(0);
        if (!set || !*set) continue;
        ++sets;
        if (const auto& depth = (*set)->depth) {
            KINO_CHECK(depth->raw.width() == rig->depth.width &&
                       depth->raw.height() == rig->depth.height);
            KINO_CHECK(depth->metres_per_unit > 0);
        }
        if (const auto& color = (*set)->color; color && color->format != PixelFormat::mjpeg) {
            KINO_CHECK(color->bytes.size() >= static_cast<std::size_t>(color->pitch) *
                                                  static_cast<std::size_t>(color->height));
        }
    }
    return sets;
}

inline int k4a(std::span<const std::uint8_t> bytes) {
    const auto source = memory_byte_source(bytes);
    (void)looks_like_k4a(*source);
    return play(make_k4a_source(memory_byte_source(bytes), "fuzz"));
}

inline int bag(std::span<const std::uint8_t> bytes) {
    return play(make_bag_source(memory_byte_source(bytes), "fuzz"));
}

}  // namespace kino::fuzz
