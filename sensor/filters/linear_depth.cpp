#include "sensor/filters/linear_depth.h"

#include "sensor/filters/depth_filter.h"

namespace kino {

void linear_depth(const Image<float>& depth_m, DepthFrame& out) {
    // 65535 is "no reading" to many readers.
    constexpr float kLargest = 65534;
    constexpr auto kPerMetre = static_cast<float>(1 / kLinearDepthUnitM);
    out.unit = DepthUnit::linear;
    out.metres_per_unit = kLinearDepthUnitM;
    out.raw.resize(depth_m.width(), depth_m.height());
    const float* z = depth_m.data();
    std::uint16_t* raw = out.raw.data();
    for (std::size_t i = 0; i < depth_m.size(); ++i) {
        const float units = z[i] * kPerMetre + 0.5f;
        const bool fits = is_reading(z[i]) && units < kLargest + 1;
        raw[i] = fits ? static_cast<std::uint16_t>(static_cast<int>(units)) : std::uint16_t{0};
    }
}

}  // namespace kino
