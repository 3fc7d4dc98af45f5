#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "calibration/rig.h"
#include "sensor/convert/convert.h"
#include "sensor/convert/frame_sink.h"
#include "sensor/recording_source.h"
#include "sensor/session/byte_source.h"
#include "tests/support/temp_dir.h"

namespace kino::test {

/// Frames kept in memory, as a recording.
struct Clip {
    std::vector<std::shared_ptr<const DepthFrame>> depth;
    std::vector<std::shared_ptr<const ColorFrame>> color;
    std::vector<std::shared_ptr<const InfraredFrame>> infrared;
    std::vector<Pose> poses;  ///< none, or one a depth frame
    RigParameters rig;
};

struct ClipStyle {
    int frames = 5;
    int width = 32;
    int height = 24;
    int color_width = 32;
    int color_height = 24;
    DepthUnit unit = DepthUnit::linear;
    double metres_per_unit = 0.0002;
    PixelFormat color = PixelFormat::rgba8;
    bool with_color = true;
    bool with_infrared = false;
    bool with_poses = false;
};

/// Depth of every value that the unit allows, holes included; colour 4 ms later than depth; times
/// odd to the nanosecond; what `i` gives is always the same.
[[nodiscard]] Clip make_clip(const ClipStyle& style = {});

/// With a timeline and without a tap, as sources of folders are.
[[nodiscard]] std::unique_ptr<Source> source_of(const Clip& clip);

/// By the Rig; points without colour.
class TestGeometry final : public ConvertGeometry {
  public:
    explicit TestGeometry(const RigParameters& rig);
    Result<void> metres(const DepthFrame& frame, Image<float>& out) override;
    Result<void> points(const FrameSet& set, std::vector<CloudPoint>& out) override;

  private:
    Rig rig_;
    RegisteredDepth registered_;
};

/// Every set of a source whose streams it subscribes to.
[[nodiscard]] std::vector<FrameSet> read_all(Source& source);

[[nodiscard]] bool same_pixels(const DepthFrame& a, const DepthFrame& b);
/// As RGBA, whatever the formats are.
[[nodiscard]] bool same_picture(const ColorFrame& a, const ColorFrame& b);

/// Bytes that live as long as the source made of them.
[[nodiscard]] std::unique_ptr<ByteSource> owned_bytes(std::vector<std::uint8_t> bytes);

/// The names inside a folder.
[[nodiscard]] std::vector<std::string> names_in(const std::filesystem::path& folder);

}  // namespace kino::test
