#include "sensor/filters/decimation_filter.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace kino {
namespace {

// Blocks are small: insertion beats anything clever.
void sort(float* values, int count) {
    for (int i = 1; i < count; ++i) {
        const float value = values[i];
        int place = i;
        for (; place > 0 && values[place - 1] > value; --place) values[place] = values[place - 1];
        values[place] = value;
    }
}

}  // namespace

std::span<const filters::Setting<DecimationParameters>> DecimationParameters::settings() {
    using P = DecimationParameters;
    static constexpr std::array kSettings = {
        filters::setting<&P::factor>("factor", 1, 8, "pixels a side that become one"),
        filters::setting<&P::steps>("steps", 0, 50,
                                    "farthest from the block's median, steps of 0.00307 1/m"),
        filters::setting<&P::readings>("readings", 1, 64, "that a block must hold"),
    };
    return kSettings;
}

Result<std::unique_ptr<DecimationFilter>> DecimationFilter::create(
    const DecimationParameters& parameters, FilterOptions options) {
    KINO_TRY(filters::check_settings("decimate", parameters));
    return std::unique_ptr<DecimationFilter>(new DecimationFilter(parameters, options));
}

DecimationFilter::DecimationFilter(const DecimationParameters& parameters, FilterOptions options)
    : parameters_(parameters),
      run_(filters::choose(options.simd)),
      threshold_(static_cast<float>(parameters.steps * kKinectStepPerM)) {}

float DecimationFilter::reduce(float* readings, int count) const {
    if (count < parameters_.readings) return 0;
    sort(readings, count);
    const float median = readings[(count - 1) / 2];
    float sum = 0;
    float used = 0;
    for (int i = 0; i < count; ++i) {
        const float difference = (median - readings[i]) / (median * readings[i]);
        const bool near = std::abs(difference) <= threshold_;
        sum += near ? difference : 0.0f;
        used += near ? 1.0f : 0.0f;
    }
    return median / (1.0f + (sum / used) * median);
}

float DecimationFilter::block(const Image<float>& in, int x, int y) const {
    const int factor = parameters_.factor;
    const int last_row = std::min((y + 1) * factor, in.height());
    const int last = std::min((x + 1) * factor, in.width());
    std::array<float, 64> readings;
    int count = 0;
    for (int v = y * factor; v < last_row; ++v) {
        const float* row = in.row(v);
        for (int u = x * factor; u < last; ++u) {
            readings[static_cast<std::size_t>(count)] = row[u];
            count += is_reading(row[u]) ? 1 : 0;
        }
    }
    return reduce(readings.data(), count);
}

void DecimationFilter::apply(const Image<float>& in, Image<float>& out) {
    const int factor = parameters_.factor;
    out.resize((in.width() + factor - 1) / factor, (in.height() + factor - 1) / factor);
    const filters::Halve halve = {threshold_, parameters_.readings};
    const int whole_rows = in.height() / factor;
    for (int y = 0; y < out.height(); ++y) {
        int x = 0;
        if (factor == 2 && y < whole_rows) {
            x = in.width() / 2;
            run_.halve(halve, in.row(2 * y), in.row(2 * y + 1), static_cast<std::size_t>(x),
                       out.row(y));
        }
        for (; x < out.width(); ++x) out.at(x, y) = block(in, x, y);
    }
}

CameraModel decimated(const CameraModel& camera, int factor) {
    CameraModel out = camera;
    const double centre = (factor - 1) / 2.0;
    out.width = (camera.width + factor - 1) / factor;
    out.height = (camera.height + factor - 1) / factor;
    out.fx /= factor;
    out.fy /= factor;
    out.cx = (camera.cx - centre) / factor;
    out.cy = (camera.cy - centre) / factor;
    return out;
}

}  // namespace kino
