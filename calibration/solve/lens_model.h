#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "base/camera_model.h"

namespace kino {

/// How much distortion a camera is given. Larger ones contain the smaller ones.
enum class LensModel : std::uint8_t {
    pinhole,   ///< none
    brown4,    ///< k1, k2, p1, p2
    brown5,    ///< and k3
    rational8  ///< and k4, k5, k6 in the denominator
};
constexpr std::array<LensModel, 4> kLensModels = {LensModel::pinhole, LensModel::brown4,
                                                  LensModel::brown5, LensModel::rational8};
[[nodiscard]] std::string_view name(LensModel model);

/// The numbers of a CameraModel in a row, as the solver turns them: kLensNames says which.
using Lens = std::array<double, 12>;
constexpr std::array<std::string_view, 12> kLensNames = {"fx", "fy", "cx", "cy", "k1", "k2",
                                                         "p1", "p2", "k3", "k4", "k5", "k6"};
/// How many numbers from the front a model may turn.
[[nodiscard]] int free_numbers(LensModel model);

[[nodiscard]] Lens lens_of(const CameraModel& camera);
[[nodiscard]] CameraModel camera_of(const Lens& lens, int width, int height);

}  // namespace kino
