#include "skeleton/tracking/free_space.h"

#include <algorithm>
#include <cmath>

namespace kino {
namespace {

struct Line {
    double slope = 1, offset = 0;
};

// Least squares of pixel = slope * ray + offset.
class LineFit {
  public:
    void add(double ray, double pixel) {
        n_ += 1;
        x_ += ray;
        y_ += pixel;
        xx_ += ray * ray;
        xy_ += ray * pixel;
    }
    [[nodiscard]] Line solve() const {
        const double d = n_ * xx_ - x_ * x_;
        if (!(d > 0)) return {};
        const double slope = (n_ * xy_ - x_ * y_) / d;
        return {slope, (y_ - slope * x_) / n_};
    }

  private:
    double n_ = 0, x_ = 0, y_ = 0, xx_ = 0, xy_ = 0;
};

constexpr int kMarginCells = 14;

}  // namespace

PinholeFit PinholeFit::of(const Image<RayXy>& rays) {
    LineFit x, y;
    for (int v = 0; v < rays.height(); v += 4) {
        for (int u = 0; u < rays.width(); u += 4) {
            const RayXy& ray = rays.at(u, v);
            if (!std::isfinite(ray.x) || !std::isfinite(ray.y)) continue;
            x.add(static_cast<double>(ray.x), u);
            y.add(static_cast<double>(ray.y), v);
        }
    }
    const Line lx = x.solve(), ly = y.solve();
    return {static_cast<float>(lx.slope), static_cast<float>(ly.slope),
            static_cast<float>(lx.offset), static_cast<float>(ly.offset)};
}

void FreeSpace::set(const Image<float>& depth_m, const Image<std::uint8_t>& labels,
                    std::uint8_t slot, const PixelBox& box, int cell_px, float far_m) {
    cell_px_ = std::max(cell_px, 1);
    const int margin = kMarginCells * cell_px_;
    left_ = std::max(box.x0 - margin, 0);
    top_ = std::max(box.y0 - margin, 0);
    const int right = std::min(box.x1 + margin, depth_m.width());
    const int bottom = std::min(box.y1 + margin, depth_m.height());
    width_ = std::max(0, (right - left_ + cell_px_ - 1) / cell_px_);
    height_ = std::max(0, (bottom - top_ + cell_px_ - 1) / cell_px_);
    cells_.resize(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_));
    constexpr std::int16_t kFar = 1000;
    for (int y = 0; y < height_; ++y) {
        const int v = std::min(top_ + y * cell_px_ + cell_px_ / 2, depth_m.height() - 1);
        Cell* row = cells_.data() + static_cast<std::ptrdiff_t>(y) * width_;
        for (int x = 0; x < width_; ++x) {
            const int u = std::min(left_ + x * cell_px_ + cell_px_ / 2, depth_m.width() - 1);
            const float z = depth_m.at(u, v);
            SpaceView::Kind kind = SpaceView::unknown;
            if (z > 0 && std::isfinite(z)) {
                const std::uint8_t label = labels.at(u, v);
                kind = label == slot ? SpaceView::own
                       : z < far_m   ? SpaceView::nearer
                                     : SpaceView::free;
            }
            const bool away = kind == SpaceView::free;
            row[x] = {z, kind, away ? kFar : std::int16_t{0}, away ? kFar : std::int16_t{0}};
        }
    }
    // Vector distances in two sweeps (Danielsson 1980).
    const auto take = [this](Cell& cell, int x, int y, int dx, int dy) {
        x += dx;
        y += dy;
        if (x < 0 || y < 0 || x >= width_ || y >= height_) return;
        const Cell& other = cells_[static_cast<std::size_t>(y * width_ + x)];
        const int ox = other.dx + dx, oy = other.dy + dy;
        if (ox * ox + oy * oy < cell.dx * cell.dx + cell.dy * cell.dy) {
            cell.dx = static_cast<std::int16_t>(ox);
            cell.dy = static_cast<std::int16_t>(oy);
        }
    };
    for (int pass = 0; pass < 2; ++pass) {
        const int d = pass == 0 ? -1 : 1;
        for (int i = 0; i < height_; ++i) {
            const int y = pass == 0 ? i : height_ - 1 - i;
            for (int k = 0; k < width_; ++k) {
                const int x = pass == 0 ? k : width_ - 1 - k;
                Cell& cell = cells_[static_cast<std::size_t>(y * width_ + x)];
                if (cell.dx == 0 && cell.dy == 0) continue;
                take(cell, x, y, d, 0);
                take(cell, x, y, 0, d);
                take(cell, x, y, d, d);
                take(cell, x, y, -d, d);
            }
            for (int k = 0; k < width_; ++k) {
                const int x = pass == 0 ? width_ - 1 - k : k;
                Cell& cell = cells_[static_cast<std::size_t>(y * width_ + x)];
                if (cell.dx == 0 && cell.dy == 0) continue;
                take(cell, x, y, -d, 0);
            }
        }
    }
}

SpaceView FreeSpace::at(const glm::vec2& pixel) const {
    const float fx = (pixel.x - static_cast<float>(left_)) / static_cast<float>(cell_px_);
    const float fy = (pixel.y - static_cast<float>(top_)) / static_cast<float>(cell_px_);
    if (!(fx >= 0 && fy >= 0 && fx < static_cast<float>(width_) &&
          fy < static_cast<float>(height_))) {
        return {};
    }
    const Cell& cell =
        cells_[static_cast<std::size_t>(static_cast<int>(fy) * width_ + static_cast<int>(fx))];
    SpaceView view{cell.kind, cell.depth_m, glm::vec2(0)};
    if (cell.kind == SpaceView::free && cell.dx * cell.dx + cell.dy * cell.dy < 500 * 500) {
        view.to_own_px = glm::vec2(cell.dx, cell.dy) * static_cast<float>(cell_px_);
    } else if (cell.kind == SpaceView::free) {
        view.kind = SpaceView::unknown;
    }
    return view;
}

}  // namespace kino
