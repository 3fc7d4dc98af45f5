#include "skeleton/synthetic/depth_sensor.h"

#include <algorithm>
#include <cmath>

#include "base/check.h"
#include "skeleton/synthetic/normal_quantile.h"

namespace kino {
namespace {

constexpr int kMargin = 8;
constexpr int kQuantiles = 4096;

}  // namespace

DepthSensor::DepthSensor(const RigParameters& rig, const DepthSensorOptions& options)
    : disparity_(rig.disparity, rig.min_depth_m, rig.max_depth_m) {
    // raw = offset - factor / z: both numbers read off the decoding object itself.
    const double near = std::max(rig.min_depth_m, 0.3), far = std::min(rig.max_depth_m, 10.0);
    const auto raw_near = disparity_.raw_exact(near), raw_far = disparity_.raw_exact(far);
    KINO_CHECK(raw_near && raw_far);
    const double factor = (*raw_far - *raw_near) / (1 / near - 1 / far);
    quantiser_.factor = static_cast<float>(factor);
    quantiser_.offset = static_cast<float>(*raw_near + factor / near);
    const auto& table = disparity_.table();
    int first = 0, last = Disparity::kLevels - 1;
    while (first < Disparity::kLevels && !(table[static_cast<std::size_t>(first)] > 0)) ++first;
    while (last > first && !(table[static_cast<std::size_t>(last)] > 0)) --last;
    quantiser_.raw_min = first;
    quantiser_.raw_max = last;
    if (!options.noise) return;

    quantiser_.sigma = static_cast<float>(options.sigma_steps);
    quantiser_.jump = static_cast<float>(options.edge_jump_steps);
    quantiser_.drop_next = static_cast<std::uint32_t>(options.drop_next * (1 << 20));
    quantiser_.drop_second = static_cast<std::uint32_t>(options.drop_second * (1 << 20));
    double square_sum = 0;
    for (int i = 0; i < kQuantiles; ++i) {
        normal_quantiles_.push_back(static_cast<float>(normal_quantile((i + 0.5) / kQuantiles)));
        square_sum += normal_quantiles_.back() * normal_quantiles_.back();
    }
    // Midpoints cut the tails; the remaining variance is scaled back to one.
    const auto gain = static_cast<float>(std::sqrt(kQuantiles / square_sum));
    for (float& value : normal_quantiles_) value *= gain;
    quantiser_.normal_quantiles = normal_quantiles_.data();
}

void DepthSensor::measure(const Visibility& seen, std::int64_t index, Image<std::uint16_t>& raw) {
    const Image<float>& z = seen.z_m();
    const int width = z.width(), height = z.height(), pitch = width + 2 * kMargin;
    raw.resize(width, height);
    exact_.resize(static_cast<std::size_t>(pitch) * static_cast<std::size_t>(height));
    const auto row_of = [&](int y) {
        return exact_.data() + std::ptrdiff_t{std::clamp(y, 0, height - 1)} * pitch + kMargin;
    };
    const raycast::Kernels& k = raycast::kernels();
    for (int y = 0; y < height; ++y) {
        float* row = row_of(y);
        k.disparity(quantiser_, z.row(y), width, row);
        std::fill(row - kMargin, row, row[0]);  // the picture's border is no edge
        std::fill(row + width, row + width + kMargin, row[width - 1]);
    }
    quantiser_.seed = static_cast<std::uint32_t>(index) * 0x9E3779B9u + 0x7F4A7C15u;
    for (int y = 0; y < height; ++y) {
        const float* rows[5] = {row_of(y - 2), row_of(y - 1), row_of(y), row_of(y + 1),
                                row_of(y + 2)};
        k.measure(quantiser_, rows, seen.lit().row(y), static_cast<std::uint32_t>(y * width), width,
                  raw.row(y));
    }
}

}  // namespace kino
