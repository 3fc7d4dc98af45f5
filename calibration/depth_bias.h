#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "base/image.h"

namespace kino {

/// What the depth of each part of the picture is off by, as a difference of 1/z, which
/// triangulation makes constant with distance: 1/z_true = 1/z - bias. Cells over the picture,
/// bilinear between their middles, so that every pixel has its own.
struct DepthBias {
    int width = 0, height = 0;  ///< of the depth image it was made from, px
    int columns = 0, rows = 0;
    std::vector<float> per_m;  ///< 1/m, row by row; 0 where nothing was seen

    [[nodiscard]] double at(double x, double y) const;
    /// Metres in place; 0 stays 0, and what would turn negative or beyond 100 m becomes 0. The
    /// slow, exact way: BiasTable is for every frame.
    void correct(Image<float>& depth_m) const;
    friend bool operator==(const DepthBias&, const DepthBias&) = default;
};

/// A bias worked out for every pixel of a depth image, also of another size than it was made from
/// (the same camera read out coarser or finer).
class BiasTable {
  public:
    BiasTable(const DepthBias& bias, int width, int height);

    /// As DepthBias::correct(), within 2e-6 of the depth; some 0.3 ms at 640x480. The size must be
    /// that of the table.
    void correct(Image<float>& depth_m) const;

  private:
    Image<float> per_m_;
};

/// {"kinoscope_depth_bias": 1, "serial": "", "size": [640, 480], "cells": [20, 15],
///  "per_m": [..]}, a file of its own beside a device's calibration. Writing and reading back gives
/// the same bits.
[[nodiscard]] std::string bias_to_json(const DepthBias& bias, const std::string& serial);
/// Fails for anything else, unknown keys too, and for values beyond 1/m. A serial that is not
/// `serial` is an error unless one of the two is empty. `where` names the text in errors.
[[nodiscard]] Result<DepthBias> bias_from_json(std::string_view text, const std::string& serial,
                                               const std::string& where);

[[nodiscard]] Result<void> write_bias_file(const std::filesystem::path& path, const DepthBias& bias,
                                           const std::string& serial);
[[nodiscard]] Result<DepthBias> read_bias_file(const std::filesystem::path& path,
                                               const std::string& serial);
/// "A22.json" -> "A22.bias.json": beside the calibration.
[[nodiscard]] std::filesystem::path bias_file_beside(const std::filesystem::path& calibration);
/// The bias beside a calibration file; none where there is no such file.
[[nodiscard]] Result<std::optional<DepthBias>> bias_beside(const std::filesystem::path& calibration,
                                                           const std::string& serial);

}  // namespace kino
