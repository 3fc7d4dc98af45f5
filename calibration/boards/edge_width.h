#pragma once

#include <vector>

#include "calibration/boards/find_board.h"

namespace kino {

/// Fills square_px and edge_width_px from the corners; both 0 where no two neighbours are seen.
void measure_edges(const GreyPicture& picture, const Board& board, BoardSighting& sighting);

/// Edges wider than this are blurred: 2.5 times the usual width and 5 px, or 0.4 squares.
/// `usual_px`: the median of other views, 0 where there are none.
[[nodiscard]] double blur_limit_px(double usual_px, double square_px);

/// Mean distance of the corners that both sightings have; infinite where they share none.
[[nodiscard]] double mean_motion_px(const BoardSighting& a, const BoardSighting& b);

}  // namespace kino
