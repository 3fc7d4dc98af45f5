#include "skeleton/tracking/part_modes.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace kino {

void PartModes::find(const PartPoints& points, float cell_tangent, const ModeOptions& options) {
    const float area = cell_tangent * cell_tangent;
    constexpr float kIgnored = 0.05f;  // shares below say nothing
    std::array<int, kBodyPartCount> count{}, due{};
    for (std::size_t i = 0; i < points.size(); ++i) {
        const auto share = points.share(i);
        for (std::size_t part = 0; part < kBodyPartCount; ++part) {
            count[part] += share[part] > kIgnored ? 1 : 0;
        }
    }
    for (auto& list : points_) list.clear();
    for (std::size_t i = 0; i < points.size(); ++i) {
        const auto share = points.share(i);
        const glm::vec3& at = points.at_m(i);
        for (std::size_t part = 0; part < kBodyPartCount; ++part) {
            if (!(share[part] > kIgnored)) continue;
            if (count[part] > options.points_per_part) {
                due[part] += options.points_per_part;
                if (due[part] < count[part]) continue;
                due[part] -= count[part];
            }
            const float thinned = std::max(1.0f, static_cast<float>(count[part]) /
                                                     static_cast<float>(options.points_per_part));
            points_[part].push_back({at, share[part] * at.z * at.z * area * thinned,
                                     share[part] >= options.least_share});
        }
    }
    const float scale = -0.5f / (options.bandwidth_m * options.bandwidth_m);
    const float reach2 = 9 * options.bandwidth_m * options.bandwidth_m;
    for (std::size_t part = 0; part < kBodyPartCount; ++part) {
        std::vector<PartMode>& modes = modes_[part];
        modes.clear();
        const auto& list = points_[part];
        const float inward = part_place(static_cast<BodyPart>(part)).inward_m;
        for (int attempt = 0; attempt < options.modes; ++attempt) {
            const Weighted* start = nullptr;
            for (const Weighted& point : list) {
                if (!point.start || (start && point.weight <= start->weight)) continue;
                const bool taken = std::ranges::any_of(modes, [&](const PartMode& mode) {
                    const glm::vec3 d = mode.surface_m - point.at;
                    return glm::dot(d, d) < options.apart_m * options.apart_m;
                });
                if (!taken) start = &point;
            }
            if (!start) break;
            glm::vec3 at = start->at;
            float weight = 0;
            for (int round = 0; round < options.rounds; ++round) {
                glm::vec3 sum(0);
                weight = 0;
                for (const Weighted& point : list) {
                    const glm::vec3 d = point.at - at;
                    const float d2 = glm::dot(d, d);
                    if (d2 > reach2) continue;
                    const float w = point.weight * std::exp(d2 * scale);
                    sum += d * w;
                    weight += w;
                }
                const glm::vec3 shift = sum / weight;
                at += shift;
                if (glm::dot(shift, shift) < options.stop_m * options.stop_m) break;
            }
            const bool known = std::ranges::any_of(modes, [&](const PartMode& mode) {
                const glm::vec3 d = mode.surface_m - at;
                return glm::dot(d, d) < options.apart_m * options.apart_m;
            });
            if (known) break;
            modes.push_back({at, at * (1 + inward / glm::length(at)), weight});
        }
        std::ranges::stable_sort(
            modes, [](const PartMode& a, const PartMode& b) { return a.weight_m2 > b.weight_m2; });
    }
    drop_mirrored(options);
}

void PartModes::drop_mirrored(const ModeOptions& options) {
    const auto weaker = [&](const PartMode& mode, const std::vector<PartMode>& others) {
        return std::ranges::any_of(others, [&](const PartMode& other) {
            const glm::vec3 d = mode.surface_m - other.surface_m;
            return glm::dot(d, d) < options.mirror_m * options.mirror_m &&
                   other.weight_m2 > options.mirror_ratio * mode.weight_m2;
        });
    };
    for (std::size_t part = 0; part < kBodyPartCount; ++part) {
        const auto other = static_cast<std::size_t>(mirrored(static_cast<BodyPart>(part)));
        if (other <= part) continue;
        const std::vector<PartMode> left = modes_[part];
        std::erase_if(modes_[part], [&](const auto& m) { return weaker(m, modes_[other]); });
        std::erase_if(modes_[other], [&](const auto& m) { return weaker(m, left); });
    }
}

}  // namespace kino
