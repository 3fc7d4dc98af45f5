#include "calibration/boards/guide_coverage.h"

#include <algorithm>
#include <cmath>
#include <string_view>

namespace kino {
namespace {

constexpr double kGuideDegrees = 180 / 3.14159265358979323846;
constexpr double kAwayDeg = 15;
constexpr double kNearFill = 0.45;
constexpr double kFarFill = 0.3;
constexpr std::array<std::string_view, 9> kParts = {"show it in the upper left corner",
                                                    "show it at the upper edge",
                                                    "show it in the upper right corner",
                                                    "show it at the left edge",
                                                    "show it in the middle",
                                                    "show it at the right edge",
                                                    "show it in the lower left corner",
                                                    "show it at the lower edge",
                                                    "show it in the lower right corner"};
constexpr std::array<std::string_view, 4> kTurns = {
    "tilt the board to the left: its left side away",
    "tilt the board to the right: its right side away", "tilt the board back: its upper side away",
    "tilt the board forward: its lower side away"};
constexpr std::array<std::string_view, 3> kSteps = {"closer: the board should fill half of it",
                                                    "at half the way: neither near nor far",
                                                    "farther away, once"};

// Columns 0..7 and rows 0..5 to thirds.
int part_of(int column, int row) {
    const auto third = [](int at, int count) { return std::min(2, 3 * at / count); };
    return 3 * third(row, GuideCoverage::kRows) + third(column, GuideCoverage::kColumns);
}

}  // namespace

GuideCoverage::Stand GuideCoverage::stand(const std::vector<SeenCorner>& corners,
                                          const Pose& camera_from_board, double board_diagonal_m,
                                          double focal_px) const {
    Stand out;
    for (const SeenCorner& corner : corners) {
        const int column =
            std::clamp(static_cast<int>((corner.px.x + 0.5) / width_ * kColumns), 0, kColumns - 1);
        const int row =
            std::clamp(static_cast<int>((corner.px.y + 0.5) / height_ * kRows), 0, kRows - 1);
        out.fields[static_cast<std::size_t>(row * kColumns + column)] = true;
    }
    // The board's z axis points away from the camera: what leans to the right leaves the left.
    const glm::dvec3 normal = camera_from_board.rotation * glm::dvec3(0, 0, 1);
    out.tilt_x_deg = kGuideDegrees * std::atan2(normal.x, normal.z);
    out.tilt_y_deg = kGuideDegrees * std::atan2(normal.y, normal.z);
    out.away = {out.tilt_x_deg > kAwayDeg, out.tilt_x_deg<-kAwayDeg, out.tilt_y_deg> kAwayDeg,
                out.tilt_y_deg < -kAwayDeg};
    const double seen_px =
        focal_px * board_diagonal_m / std::max(1e-6, camera_from_board.translation.z);
    out.fill = seen_px / std::hypot(width_, height_);
    out.distance = out.fill >= kNearFill  ? Distance::near
                   : out.fill >= kFarFill ? Distance::middle
                                          : Distance::far;
    return out;
}

void GuideCoverage::add(const Stand& stand) {
    for (std::size_t i = 0; i < fields_.size(); ++i) fields_[i] += stand.fields[i] ? 1 : 0;
    for (std::size_t i = 0; i < tilts_.size(); ++i) tilts_[i] += stand.away[i] ? 1 : 0;
    ++distances_[stand.distance];
}

int GuideCoverage::new_fields(const Stand& stand) const {
    int count = 0;
    for (std::size_t i = 0; i < fields_.size(); ++i) {
        if (stand.fields[i] && fields_[i] == 0) ++count;
    }
    return count;
}

bool GuideCoverage::is_wanted(const Stand& stand) const {
    for (std::size_t i = 0; i < tilts_.size(); ++i) {
        if (stand.away[i] && tilts_[i] < kWantedTilts) return true;
    }
    return distances_[stand.distance] < kWantedDistances[stand.distance];
}

double GuideCoverage::field_share() const {
    return static_cast<double>(
               std::count_if(fields_.begin(), fields_.end(), [](int views) { return views > 0; })) /
           static_cast<double>(fields_.size());
}

std::vector<GuideCoverage::Want> GuideCoverage::missing() const {
    std::vector<Want> fields;
    const double share = field_share();
    if (share < kEnoughFields) {
        std::array<double, 9> empty{};
        std::array<double, 9> all{};
        for (int row = 0; row < kRows; ++row) {
            for (int column = 0; column < kColumns; ++column) {
                const auto part = static_cast<std::size_t>(part_of(column, row));
                ++all[part];
                if (views(column, row) == 0) ++empty[part];
            }
        }
        for (std::size_t part = 0; part < empty.size(); ++part) {
            if (empty[part] == 0) continue;
            // Corners first: there the lens bends most.
            const bool is_corner = part % 2 == 0 && part != 4;
            fields.push_back({Want::Kind::field, static_cast<int>(part),
                              (1 - share / kEnoughFields) + 1e-3 * empty[part] / all[part] +
                                  (is_corner ? 2e-4 : 0),
                              std::string(kParts[part])});
        }
    }
    std::vector<Want> turns;
    double turned = 0;
    for (const int views : tilts_) turned += std::min(views, kWantedTilts);
    for (std::size_t side = 0; side < tilts_.size(); ++side) {
        if (tilts_[side] >= kWantedTilts) continue;
        turns.push_back({Want::Kind::tilt, static_cast<int>(side),
                         1 - turned / (4 * kWantedTilts) - 1e-3 * tilts_[side],
                         std::string(kTurns[side])});
    }
    std::vector<Want> steps;
    double stepped = 0;
    double wanted = 0;
    for (std::size_t i = 0; i < distances_.size(); ++i) {
        stepped += std::min(distances_[i], kWantedDistances[i]);
        wanted += kWantedDistances[i];
    }
    for (std::size_t i = 0; i < distances_.size(); ++i) {
        const int lacking = kWantedDistances[i] - distances_[i];
        if (lacking <= 0) continue;
        steps.push_back({Want::Kind::distance, static_cast<int>(i),
                         1 - stepped / wanted + 1e-3 * lacking, std::string(kSteps[i])});
    }
    std::vector<Want> out;
    for (const auto* kind : {&fields, &turns, &steps}) {
        out.insert(out.end(), kind->begin(), kind->end());
    }
    std::stable_sort(out.begin(), out.end(),
                     [](const Want& a, const Want& b) { return a.missing > b.missing; });
    return out;
}

}  // namespace kino
