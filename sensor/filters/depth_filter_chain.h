#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "base/camera_model.h"
#include "base/error.h"
#include "sensor/filters/depth_filter.h"

namespace kino {

/// Filters one after the other, written as a person would:
///
///     flying,spatial:radius=3,temporal:alpha=0.2:persistence=4,holes
///
/// Names by commas, settings of a filter by colons; "temporal:preset=librealsense" starts from
/// published defaults. The order is the caller's; the order that makes sense is
/// flying, decimate, spatial, temporal, holes: what is wrong goes before it is averaged, and filled
/// pixels are nobody's evidence. Depth comes and goes in metres whatever the device's unit, so all
/// filters know one kind of picture; those that average do it in inverse depth, where other
/// libraries convert to disparity and back.
class DepthFilterChain {
  public:
    /// The chain that does nothing.
    DepthFilterChain() = default;

    /// "" is the chain that does nothing. Fails for unknown names, settings and values, and names
    /// what there is; for a filter named twice; for anything empty between separators.
    [[nodiscard]] static Result<DepthFilterChain> parse(std::string_view specification,
                                                        FilterOptions options = {});
    /// Lines for a help text: every filter with its settings, defaults, ranges and units.
    [[nodiscard]] static std::string help();

    [[nodiscard]] bool empty() const { return filters_.empty(); }
    /// A specification that parses to this chain, with what differs from the defaults.
    [[nodiscard]] const std::string& specification() const { return specification_; }

    /// Metres in, metres out, 0 = no reading; `out` must not be `in`. The size changes by
    /// reduction(). The chain that does nothing copies. After the first frame of a size nothing is
    /// allocated.
    void apply(const Image<float>& in, Image<float>& out);

    /// Forgets earlier frames: after a seek, a loop or a source that came back.
    void reset();

    /// Pixels a side that become one in all: 1 without decimation.
    [[nodiscard]] int reduction() const;
    /// The depth camera that sees the filtered picture; the Rig must be built for this one.
    [[nodiscard]] CameraModel camera(const CameraModel& depth) const;

  private:
    std::string specification_;
    std::vector<std::unique_ptr<DepthFilter>> filters_;
    Image<float> between_[2];
};

}  // namespace kino
