#include "skeleton/people/body_reach.h"

#include <algorithm>
#include <cmath>

namespace kino {

bool within_reach(const glm::vec3& head, const glm::vec3& point) {
    const float up = point.y - head.y, away = std::hypot(point.x - head.x, point.z - head.z);
    if (up > 0.95f || up < -1.9f) return false;
    if (up > 0.2f) return away < 0.8f;
    return away < (up > -0.8f ? 0.95f : 0.75f);
}

void BodyReach::cut(const std::vector<Anchor>& anchors, const std::vector<glm::vec3>& upright_m,
                    const Image<std::uint8_t>& certain, Image<std::int32_t>& labels) {
    if (anchors.empty()) return;
    const int width = labels.width(), height = labels.height();
    std::vector<std::int32_t> held;
    kept_.assign(labels.size(), 0);
    for (const Anchor& anchor : anchors) {
        const std::int32_t label = labels.data()[anchor.cell];
        if (label == 0) continue;
        held.push_back(label);
        open_.assign(1, anchor.cell);
        // Bit 1: kept; bit 2: looked at for this anchor, which may reach what another could not.
        for (std::uint8_t& k : kept_) k &= 1;
        kept_[static_cast<std::size_t>(anchor.cell)] = 3;
        while (!open_.empty()) {
            const std::int32_t cell = open_.back();
            open_.pop_back();
            const int x = cell % width, y = cell / width;
            const auto look = [&](int u, int v) {
                if (u < 0 || v < 0 || u >= width || v >= height) return;
                const std::int32_t other = v * width + u;
                const auto k = static_cast<std::size_t>(other);
                if (labels.data()[other] != label || (kept_[k] & 2)) return;
                if (!certain.data()[other] && !within_reach(anchor.head_m, upright_m[k])) return;
                kept_[k] = 3;
                open_.push_back(other);
            };
            // Two away as well: a component joins over one cell without a reading.
            for (const int d : {1, 2}) {
                look(x - d, y);
                look(x + d, y);
                look(x, y - d);
                look(x, y + d);
            }
        }
    }
    std::sort(held.begin(), held.end());
    held.erase(std::unique(held.begin(), held.end()), held.end());
    for (std::size_t i = 0; i < labels.size(); ++i) {
        std::int32_t& label = labels.data()[i];
        if (label == 0 || kept_[i] || certain.data()[i]) continue;
        if (std::binary_search(held.begin(), held.end(), label)) label = 0;
    }
}

}  // namespace kino
