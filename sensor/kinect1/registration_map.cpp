#include "sensor/kinect1/registration_map.h"

namespace kino::kinect1 {
namespace {

// The low `bits` of a word as a signed number, brought to the polynomial's fixed point. The fields
// of the block are narrower than the words that hold them.
std::int64_t field(std::int32_t word, int bits, int scale_bits) {
    const std::int64_t wide = static_cast<std::int64_t>(word) << (64 - bits);
    return (wide >> (64 - bits)) * (std::int64_t{1} << scale_bits);
}

// One displacement, x or y: the value, its differences along a row and down the rows. Shifts to
// the right round down, as the device's integers do.
struct Differences {
    std::int64_t value, along, along2;  // along3 is constant
    std::int64_t down, down2;           // of value
    std::int64_t along_down;            // of along
    std::int64_t along3, down3, along2_down, along_down2;

    void next_row() {
        along2 += along2_down;
        along += along_down >> 8;
        along_down += along_down2;
        value += down >> 6;
        down += down2 >> 8;
        down2 += down3;
    }
    void next_column() {
        value += along >> 6;
        along += along2 >> 8;
        along2 += along3;
    }
    [[nodiscard]] double px() const { return static_cast<double>(value) / (1 << 17); }
};

}  // namespace

RegistrationMap::RegistrationMap(const RegistrationBlock& b, const RegistrationPadding& padding,
                                 const ZeroPlane& plane)
    : table_(kWidth, kHeight),
      start_lines_(padding.start_lines),
      color_shift_px_(plane.color_distance_cm / (2 * plane.reference_pixel_size_mm)),
      reference_m_(plane.reference_distance_cm / 100) {
    Differences x{field(b.dx_start, 19, 9),
                  field(b.dxdx_start, 21, 8),
                  field(b.dxdxdx_start, 24, 8),
                  field(b.dydx_start, 21, 8),
                  field(b.dydydx_start, 24, 8),
                  field(b.dydxdx_start, 24, 8),
                  b.ax,
                  b.bx,
                  b.cx,
                  b.dx};
    Differences y{field(b.dy_start, 19, 9),
                  field(b.dxdy_start, 21, 8),
                  field(b.dxdxdy_start, 24, 8),
                  field(b.dydy_start, 21, 8),
                  field(b.dydydy_start, 24, 8),
                  field(b.dydxdy_start, 24, 8),
                  b.ay,
                  b.by,
                  b.cy,
                  b.dy};
    for (int row = 0; row < kHeight; ++row) {
        // The device steps before its first row.
        x.next_row();
        y.next_row();
        Differences along_x = x;
        Differences along_y = y;
        for (int column = 0; column < kWidth; ++column) {
            table_.at(column, row) = {along_x.px(), along_y.px()};
            along_x.next_column();
            along_y.next_column();
        }
    }
}

glm::dvec2 RegistrationMap::at(int x, int y, double z_m) const {
    constexpr double kOffset = 1;
    constexpr double kShiftOffset = 0.375;
    constexpr double kHalfPixel = 0.5;
    const glm::dvec2 moved = table_.at(x, y);
    return {x + moved.x + kOffset + kShiftOffset + color_shift_px_ * (1 - reference_m_ / z_m) -
                kHalfPixel,
            y + moved.y + kOffset - start_lines_ - kHalfPixel};
}

}  // namespace kino::kinect1
