#include "skeleton/people/components.h"

#include <algorithm>

namespace kino {

std::int32_t Components::root(std::int32_t cell) {
    auto* parent = parent_.data();
    while (parent[cell] != cell) {
        parent[cell] = parent[parent[cell]];
        cell = parent[cell];
    }
    return cell;
}

void Components::join(std::int32_t a, std::int32_t b) {
    a = root(a);
    b = root(b);
    // The lower index leads, so a component's root is its first cell.
    if (a != b) parent_[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
}

void Components::find(const Image<float>& z_m, const Image<std::uint8_t>& mask,
                      const SurfaceStep& step) {
    KINO_CHECK(z_m.width() == mask.width() && z_m.height() == mask.height());
    const int width = z_m.width(), height = z_m.height();
    labels_.resize(width, height);
    parent_.resize(z_m.size());
    const float* z = z_m.data();
    const std::uint8_t* in = mask.data();
    const auto link = [&](std::int32_t cell, std::int32_t back, bool two) {
        const std::int32_t other = cell - back;
        if (in[other]) {
            if (step.joins(z[cell], z[other])) join(cell, other);
        } else if (two && z[other] == 0) {
            const std::int32_t next = other - back;
            if (in[next] && step.joins(z[cell], z[next])) join(cell, next);
        }
    };
    std::int32_t cell = 0;
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x, ++cell) {
            parent_[static_cast<std::size_t>(cell)] = cell;
            if (!in[cell]) continue;
            if (x > 0) link(cell, 1, x > 1);
            if (y > 0) link(cell, width, y > 1);
        }
    }
    count_ = 0;
    for (std::int32_t i = 0; i < cell; ++i) {
        std::int32_t& label = labels_.data()[i];
        if (!in[i]) {
            label = 0;
            continue;
        }
        const std::int32_t first = root(i);
        label = first == i ? ++count_ : labels_.data()[first];
    }
}

}  // namespace kino
