#pragma once

#include <vector>

#include "calibration/boards/find_board.h"

namespace kino {

/// Fills square_px and edge_width_px from the corners; both 0 where no two neighbours are seen.
void measure_edges(const GreyPicture& picture, const Board& board, BoardSighting& sighting);

}  // namespace kino
