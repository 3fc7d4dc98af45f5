#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "base/camera_model.h"
#include "sensor/kinect1/camera_commands.h"

namespace kino::kinect1 {

/// The reference plane that disparities are measured against, as the factory measured it.
struct ZeroPlane {
    double emitter_distance_cm = 7.5;  ///< infrared camera to projector
    double color_distance_cm = 2.3;    ///< infrared camera to colour camera
    double reference_distance_cm = 120;
    double reference_pixel_size_mm = 0.1042;  ///< on the plane, of the 1280 px wide sensor, x 10
};

/// 29 numbers in the order in which the camera sends them: how far each depth pixel moves to
/// lie on its colour pixel, as a cubic polynomial by its finite differences
/// (libfreenect_registration.h names them).
struct RegistrationBlock {
    std::int32_t dx_center = 0;
    std::int32_t ax = 0, bx = 0, cx = 0, dx = 0, dx_start = 0;
    std::int32_t ay = 0, by = 0, cy = 0, dy = 0, dy_start = 0;
    std::int32_t dx_beta_start = 0, dy_beta_start = 0;
    std::int32_t rollout_blank = 0, rollout_size = 0;
    std::int32_t dx_beta_inc = 0, dy_beta_inc = 0;
    std::int32_t dxdx_start = 0, dxdy_start = 0, dydx_start = 0, dydy_start = 0;
    std::int32_t dxdxdx_start = 0, dydxdx_start = 0, dxdxdy_start = 0, dydxdy_start = 0;
    std::int32_t back_comp1 = 0;
    std::int32_t dydydx_start = 0;
    std::int32_t back_comp2 = 0;
    std::int32_t dydydy_start = 0;
    friend bool operator==(const RegistrationBlock&, const RegistrationBlock&) = default;
};

/// Lines that the registered image has more than the depth image.
struct RegistrationPadding {
    std::uint16_t start_lines = 0;
    std::uint16_t end_lines = 0;
    std::uint16_t cropping_lines = 0;
};

/// What the device says about itself; what it would not say, or said implausibly, is missing.
struct FactoryData {
    std::optional<ZeroPlane> zero_plane;
    std::optional<RegistrationBlock> registration;
    RegistrationPadding padding;
    std::optional<std::uint16_t> const_shift;
    std::string problems;  ///< for a person, empty if everything came
};

// The data of a reply (without its 8-byte header) to values; none for a wrong length or values
// that no Kinect can have.
[[nodiscard]] std::optional<ZeroPlane> parse_zero_plane(std::span<const std::uint8_t> data);
[[nodiscard]] std::optional<RegistrationBlock> parse_registration(
    std::span<const std::uint8_t> data);
[[nodiscard]] std::optional<RegistrationPadding> parse_padding(std::span<const std::uint8_t> data);
[[nodiscard]] std::optional<std::uint16_t> parse_const_shift(std::span<const std::uint8_t> data);

/// Asks for all of it. Only a device that has gone is a fault.
[[nodiscard]] usb::Outcome<FactoryData> read_factory_data(CameraCommands& commands);

/// The default's values where the device gave none.
[[nodiscard]] DisparityParameters disparity_of(const FactoryData& data);

}  // namespace kino::kinect1
