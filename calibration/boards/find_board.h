#pragma once

#include <glm/vec2.hpp>
#include <optional>
#include <vector>

#include "calibration/boards/board.h"
#include "calibration/boards/grey_picture.h"

namespace kino {

/// One corner of the board in one picture; px, pixel centres at integers.
struct SeenCorner {
    int id = 0;
    glm::dvec2 px{};
    friend bool operator==(const SeenCorner&, const SeenCorner&) = default;
};

/// A board in one picture. A chessboard is seen whole or not at all; of a ChArUco board six corners
/// that are not in one row are enough.
struct BoardSighting {
    std::vector<SeenCorner> corners;  ///< by rising id
    /// Median width of the edges between squares: contrast over steepest slope, px. Some 2 px where
    /// the picture is sharp.
    double edge_width_px = 0;
    double square_px = 0;  ///< median distance of neighbouring corners
    /// Only the mirrored picture shows the board. Its corners are those of the mirrored picture.
    bool mirrored = false;
};

struct FindBoardOptions {
    /// For live guidance: the fast detector alone, on the picture at half its size where it is
    /// wider than 500 px, so that boards with squares under some 15 px there are missed; sub-pixel
    /// always on the whole picture. Nothing is tried twice.
    bool quick = false;
};

/// OpenCV's detectors with sub-pixel refinement. None where no board is seen. A chessboard's first
/// corner is the one whose square inside the grid is dark, and its rows run as in Board, so that
/// two cameras agree on them. A mirrored chessboard cannot be told from a true one.
[[nodiscard]] std::optional<BoardSighting> find_board(const GreyPicture& picture,
                                                      const Board& board,
                                                      const FindBoardOptions& options = {});

}  // namespace kino
