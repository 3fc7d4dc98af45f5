#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <string>
#include <string_view>

#include "base/error.h"

namespace kino {

enum class BoardKind : std::uint8_t { chess, charuco };

/// A flat board with a grid of corners. Its plane is z = 0; corner 0 is the origin, x runs along a
/// row, y to the next row, metres. Corner ids count along the rows.
struct Board {
    BoardKind kind = BoardKind::chess;
    int columns = 9;          ///< inner corners in a row
    int rows = 6;             ///< rows of inner corners
    double square_m = 0.025;  ///< side of a square
    double marker_m = 0;      ///< charuco: side of a marker
    int dictionary = 0;       ///< charuco: OpenCV's number of the marker dictionary, 0..20

    [[nodiscard]] int corner_count() const { return columns * rows; }
    [[nodiscard]] glm::dvec2 corner_m(int id) const {
        const int row = id / columns;
        return {(id - row * columns) * square_m, row * square_m};
    }
    /// A chessboard with two odd or two even numbers of corners looks the same upside down, so two
    /// cameras may disagree about its first corner.
    [[nodiscard]] bool looks_same_upside_down() const {
        return kind == BoardKind::chess && columns % 2 == rows % 2;
    }
    friend bool operator==(const Board&, const Board&) = default;
};

/// "chess:9x6:25": 9 x 6 inner corners, squares of 25 mm. "charuco:14x9:40:30:6": 14 x 9 squares
/// of 40 mm, markers of 30 mm, dictionary 6 or its OpenCV name (DICT_5X5_250). Fails with the two
/// forms as a hint; boards run from 3x3 to 64x64 corners, squares from 1 mm to 10 m.
[[nodiscard]] Result<Board> parse_board(std::string_view text);
/// What parse_board() reads back to the same board.
[[nodiscard]] std::string board_text(const Board& board);

}  // namespace kino
