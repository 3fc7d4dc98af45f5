#pragma once

#include <algorithm>
#include <cmath>

#include "base/image.h"

namespace kino::test {

/// recordings/person was decoded by a guess: 0.85 m where the picture is bright, 4 m where it is
/// dark. This undoes the guess. libfreenect's viewer shows (raw / 2048)^3 * 36 * 256 as a colour;
/// the clip's ramp white, cyan, blue, black is 768 steps of that, so dark is raw 894 or 1.71 m.
/// With z = 0.1236 tan(raw / 2842.5 + 1.1863) the man's head is 0.155 m wide, and the sheet in his
/// hands 0.21 m. A picture without anything beyond 1.75 m is metric already and is left alone.
inline void clip_metres(Image<float>& depth_m) {
    const auto far = std::max_element(depth_m.pixels().begin(), depth_m.pixels().end());
    if (far == depth_m.pixels().end() || *far < 1.75f) return;
    for (float& z : depth_m.pixels()) {
        if (!(z > 0)) continue;
        const double dark = std::clamp((static_cast<double>(z) - 0.85) / (4.0 - 0.85), 0.0, 1.0);
        const double raw = 2048 * std::cbrt(768 * dark / 9216);
        z = static_cast<float>(0.1236 * std::tan(raw / 2842.5 + 1.1863));
    }
}

}  // namespace kino::test
