#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sensor/source.h"
#include "sensor/v4l2/video_device.h"

namespace kino {

/// The controls of a video node. Left out are those that are disabled, or have no number (buttons,
/// texts, arrays); those that can only be read are not listed, but get() knows them. Values are
/// always the device's, never remembered: automatic ones change by themselves.
///
/// Names that other devices share: white_balance_auto, white_balance, exposure_auto, exposure,
/// gain_auto, gain, brightness, contrast, saturation, hue, sharpness, gamma, focus_auto, focus,
/// zoom, mirror, flip; any other is made of the driver's own. exposure_auto is a toggle also where
/// the driver has a menu of one manual and several automatic modes.
class V4l2Controls final : public Controls {
  public:
    /// Asks the driver for all of them; a driver without any gives an empty list. `device` outlives
    /// this object.
    explicit V4l2Controls(const VideoDevice& device);

    [[nodiscard]] std::vector<Control> list() const override;
    [[nodiscard]] Result<double> get(const std::string& id) override;
    Result<void> set(const std::string& id, double value) override;

    /// Metres of a depth unit, where the driver has a control for it (in micrometres, as depth
    /// cameras of the RealSense family count); none if there is no such control.
    [[nodiscard]] std::optional<double> metres_per_unit();

  private:
    struct Knob {
        Control control;
        std::uint32_t id = 0;
        bool wide = false;  ///< 64 bits
        bool read_only = false;
        bool write_only = false;
        /// What each menu entry, or off and on of a toggle, is to the driver; empty: the same.
        std::vector<std::int64_t> values;
    };
    struct Range {
        std::uint32_t id = 0, type = 0, flags = 0;
        std::string name;
        std::int64_t minimum = 0, maximum = 0, step = 1, fallback = 0;
    };

    [[nodiscard]] std::optional<Range> query_extended(std::uint32_t after) const;
    [[nodiscard]] std::optional<Range> query_simple(std::uint32_t after) const;
    void add(const Range& range);
    bool add_menu(const Range& range, Knob& knob) const;
    [[nodiscard]] std::string free_id(std::string id) const;
    [[nodiscard]] const Knob* find(const std::string& id) const;
    [[nodiscard]] Called read(const Knob& knob, std::int64_t& value) const;
    [[nodiscard]] Called write(const Knob& knob, std::int64_t value) const;

    const VideoDevice& device_;
    std::vector<Knob> knobs_;
};

}  // namespace kino
