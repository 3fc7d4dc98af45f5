#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/camera_model.h"
#include "base/error.h"
#include "base/frame.h"

namespace kino {

/// How a picture's colours code depth.
enum class ClipCode : std::uint8_t {
    luma,    ///< v = (Y - 16) / 219, limited-range luma
    rgb_sum  ///< v = (r + g + b) / 765 along the ramp black, blue, cyan, white
};

/// What a clip's v means.
enum class ClipScale : std::uint8_t {
    linear,  ///< depth runs evenly from dark_m at v = 0 to bright_m at v = 1
    /// The viewer of libfreenect shows a raw disparity as the step 9216 (raw / 2048)^3 of a ramp of
    /// colours; white, cyan, blue, black are its first 768 steps, so v = 1 - step / 768. Depth is
    /// 0.1236 m tan(raw / 2842.5 + 1.1863): 0.31 m at v = 1, 1.71 m at v = 0.
    freenect_viewer
};

/// A video whose brightness v in 0..1 codes depth.
struct ClipDescription {
    std::string file;  ///< VP8 in WebM, relative to the folder
    ClipCode code = ClipCode::luma;
    ClipScale scale = ClipScale::linear;
    double bright_m = 0.5;        ///< linear: depth at v = 1
    double dark_m = 4.0;          ///< linear: depth at v = 0
    double invalid_below = 0.04;  ///< darker is no reading
    /// Pixels between two surfaces of a 5x5 neighbourhood whose v differ by more than this are a
    /// codec's smear and dropped (sensor/clip_depth.h); 0 keeps everything.
    double edge_span = 0.08;
    double smooth_span = 0.015;  ///< differences in v that are the code's noise; 0: no smoothing
};

/// What kinoscope.json says about a folder. A folder of frames:
///   {"kinoscope": 1, "name": "..", "licence": "..", "note": "..", "serial": "..",
///    "people": "standing" | "seated",           of whom only head, shoulders and arms are seen
///    "fps": 30                       or "times_ns": [0, 33333333, ..], one a depth frame,
///    "depth": {"dir": "depth", "unit": "millimetres" | "kinect_disparity11"
///                              or "per_metre": 5000},
///    "color": {"dir": "color"},
///    "cameras": .., "color_from_depth": .., "depth_is_registered_to_color": true,
///    "disparity": .., "range_m": ..}            as in sensor/rig_json.h
/// Depth frames are the PNGs of depth.dir sorted by name; a colour frame belongs to the depth
/// frame of the same file name. Or a clip: in place of depth, color, fps and times_ns (a video has
/// its own times)
///    "clip": {"file": "a.webm", "code": "rgb_sum" | "luma",
///             "bright_m": .., "dark_m": ..   or "scale": "freenect_viewer",
///             "invalid_below": .., "edge_span": .., "smooth_span": ..}
struct Description {
    std::string name;
    std::string licence;
    std::string note;
    bool seated_people = false;
    RigParameters rig;

    std::string depth_dir;  ///< empty for a clip
    DepthUnit unit = DepthUnit::linear;
    double depth_per_metre = 1000;
    std::string color_dir;  ///< empty: no colour
    double fps = 30;
    std::vector<TimeNs> times;  ///< empty: fps counts

    std::optional<ClipDescription> clip;
};

/// Unknown keys, wrong types and values out of range are errors that name a JSON pointer in
/// `where`.
[[nodiscard]] Result<Description> parse_description(std::string_view text,
                                                    const std::string& where);

}  // namespace kino
