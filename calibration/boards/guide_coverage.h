#pragma once

#include <array>
#include <glm/vec2.hpp>
#include <optional>
#include <string>
#include <vector>

#include "base/pose.h"
#include "calibration/boards/find_board.h"

namespace kino {

/// What the views of one camera have shown so far.
class GuideCoverage {
  public:
    static constexpr int kColumns = 8;  ///< fields of the picture, as in view_checks.h
    static constexpr int kRows = 6;
    enum Side { left, right, upper, lower };
    enum Distance { near, middle, far };
    /// How often each is wanted.
    static constexpr int kWantedTilts = 2;
    static constexpr std::array<int, 3> kWantedDistances = {3, 3, 1};
    /// Fields that are enough: a whole board hardly gets into the outermost corners.
    static constexpr double kEnoughFields = 0.85;

    GuideCoverage(int width, int height) : width_(width), height_(height) {}

    /// Where a board stands: its fields, which sides of it are away by more than 15 degrees, and
    /// how large it is. `fill`: the board's diagonal, seen straight, over the picture's.
    struct Stand {
        std::array<bool, kColumns * kRows> fields{};
        std::array<bool, 4> away{};
        Distance distance = Distance::middle;
        double tilt_x_deg = 0;  ///< positive: the left side is away
        double tilt_y_deg = 0;  ///< positive: the upper side is away
        double fill = 0;
    };
    [[nodiscard]] Stand stand(const std::vector<SeenCorner>& corners, const Pose& camera_from_board,
                              double board_diagonal_m, double focal_px) const;

    void add(const Stand& stand);
    /// Fields that no view has shown.
    [[nodiscard]] int new_fields(const Stand& stand) const;
    /// A tilt or a distance that is still wanted.
    [[nodiscard]] bool is_wanted(const Stand& stand) const;

    [[nodiscard]] int views(int column, int row) const {
        return fields_[static_cast<std::size_t>(row) * kColumns + static_cast<std::size_t>(column)];
    }
    [[nodiscard]] int views(Side side) const { return tilts_[side]; }
    [[nodiscard]] int views(Distance distance) const { return distances_[distance]; }
    [[nodiscard]] double field_share() const;
    [[nodiscard]] bool is_enough() const { return missing().empty(); }

    /// What a view should show next.
    struct Want {
        enum class Kind { field, tilt, distance } kind = Kind::field;
        int which = 0;       ///< part of the picture (3 x 3), Side or Distance
        double missing = 0;  ///< share of its kind that is not there yet
        std::string words;   ///< "show it in the upper right corner"
        [[nodiscard]] bool is_same(const Want& other) const {
            return kind == other.kind && which == other.which;
        }
    };
    /// The kind that is missing most comes first, and within it what is missing most.
    [[nodiscard]] std::vector<Want> missing() const;

  private:
    int width_;
    int height_;
    std::array<int, kColumns * kRows> fields_{};
    std::array<int, 4> tilts_{};
    std::array<int, 3> distances_{};
};

}  // namespace kino
