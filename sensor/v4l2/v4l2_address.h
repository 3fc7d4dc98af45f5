#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "sensor/source.h"
#include "sensor/v4l2/video_system.h"

namespace kino {

/// What follows "v4l2:":
///   UNIT[?node=1.0.0&as=depth|infrared|color&format=Z16&size=640x480&fps=30&calibration=FILE]
/// UNIT is empty (the first camera), a path ("/dev/video0", "/dev/v4l/by-id/..."), a serial (the
/// device's or udev's ID_SERIAL) or a port (udev's ID_PATH). `node` chooses among the nodes of one
/// unit. In values, % and two hex digits stand for a byte, so that '&' and '+' can be said.
struct V4l2Address {
    std::string unit;
    std::string node;
    std::optional<StreamKind> as;
    std::string format;       ///< a name that find_video_format() knows; empty: the best one
    int width = 0;            ///< px; 0: near 640x480
    int height = 0;           ///< px
    double fps = 0;           ///< 0: as the device has it
    std::string calibration;  ///< file of sensor/rig_json.h; empty: none
    friend bool operator==(const V4l2Address&, const V4l2Address&) = default;

    /// What parse_v4l2_address() reads back as the same.
    [[nodiscard]] std::string to_string() const;
};

/// Fails for unknown keys, kinds and formats, and for sizes and rates that are none.
[[nodiscard]] Result<V4l2Address> parse_v4l2_address(const std::string& text);

/// The nodes that the address may mean, in their order; a path always gives one, known to sysfs or
/// not.
[[nodiscard]] std::vector<VideoNode> matching_nodes(const V4l2Address& address,
                                                    VideoSystem& system);

/// The address that names this node wherever it is plugged in next: by serial where no other of
/// `nodes` (those there are now) has the same, else by port, else by path; with all the choices of
/// `asked`.
[[nodiscard]] V4l2Address lasting_address(const V4l2Address& asked, const VideoNode& node,
                                          const std::vector<VideoNode>& nodes);

}  // namespace kino
