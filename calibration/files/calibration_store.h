#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "base/camera_model.h"
#include "base/error.h"

namespace kino {

/// Calibrations of devices, found again by their serial number: one file a device,
/// $XDG_CONFIG_HOME/kinoscope/calibration/SERIAL.json (sensor/rig_json.h), or below
/// $HOME/.config. Characters of a serial that are not letters, digits, '-' or '_' become "%XX".
[[nodiscard]] Result<std::filesystem::path> calibration_folder();
[[nodiscard]] std::filesystem::path calibration_file(const std::filesystem::path& folder,
                                                     const std::string& serial);

/// Writes or replaces the device's file; returns where. Fails without a serial.
[[nodiscard]] Result<std::filesystem::path> store_calibration(const std::filesystem::path& folder,
                                                              const RigParameters& rig);
/// None where there is no file for this device (or it has no serial). An error where the file is
/// no calibration, or that of another device.
[[nodiscard]] Result<std::optional<RigParameters>> stored_calibration(
    const std::filesystem::path& folder, const std::string& serial);

}  // namespace kino
