#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "base/check.h"
#include "sensor/color_conversion.h"
#include "sensor/description.h"
#include "sensor/png_io.h"
#include "sensor/rig_json.h"
#include "sensor/trajectory.h"
#include "sensor/tum_list.h"

/// What a parser promises for any bytes at all: no crash, and whatever it accepts is sound. Shared
/// by the libFuzzer drivers beside this file and by mutation_test.cpp.
namespace kino::fuzz {

using Bytes = std::span<const std::uint8_t>;

inline std::string_view text_of(Bytes bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// The two kinds of lists of a TUM folder.
inline void tum_lists(Bytes bytes) {
    const ParsedList list = parse_tum_list(text_of(bytes));
    for (std::size_t i = 0; i < list.files.size(); ++i) {
        KINO_CHECK(!list.files[i].name.empty());
        KINO_CHECK(i == 0 || list.files[i].time > list.files[i - 1].time);
    }
    const ParsedTrajectory parsed = parse_tum_trajectory(text_of(bytes));
    const Trajectory& track = parsed.trajectory;
    for (std::size_t i = 0; i < track.times.size(); ++i) {
        KINO_CHECK(is_valid(track.poses[i]));
        KINO_CHECK(i == 0 || track.times[i] > track.times[i - 1]);
        const auto between = track.at(track.times[i] - 1);
        KINO_CHECK(!between || is_valid(*between));
    }
}

/// kinoscope.json, the description of a clip in it, and a rig's own file.
inline void descriptions(Bytes bytes) {
    const auto description = parse_description(text_of(bytes), "fuzz");
    if (description) {
        KINO_CHECK(validate(description->rig).has_value());
        KINO_CHECK(description->clip.has_value() == description->depth_dir.empty());
    }
    const auto rig = rig_from_json(text_of(bytes), "fuzz");
    if (rig) {
        const auto again = rig_from_json(rig_to_json(*rig), "fuzz");
        KINO_CHECK(again.has_value() && *again == *rig);
    }
}

inline void png(Bytes bytes) {
    const auto depth = decode_png_gray16(bytes, "fuzz");
    KINO_CHECK(!depth || (depth->width() > 0 && depth->width() <= kMaxPngSize));
    const auto picture = decode_png_rgba8(bytes, "fuzz");
    KINO_CHECK(!picture || (picture->height() > 0 && picture->height() <= kMaxPngSize));
}

/// A colour frame whose layout the first bytes state.
inline void color(Bytes bytes) {
    if (bytes.size() < 6) return;
    ColorFrame frame;
    frame.format = static_cast<PixelFormat>(bytes[0] % 7);
    frame.width = bytes[1];
    frame.height = bytes[2];
    frame.pitch = bytes[3] * 4 - 16;
    frame.matrix = static_cast<YuvMatrix>(bytes[4] % 2);
    frame.range = static_cast<YuvRange>(bytes[5] % 2);
    frame.bytes.assign(bytes.begin() + 6, bytes.end());
    Image<Rgba8> out;
    if (to_rgba8(frame, out)) KINO_CHECK_EQ(out.width(), frame.width);
}

}  // namespace kino::fuzz
