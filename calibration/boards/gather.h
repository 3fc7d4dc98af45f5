#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "calibration/boards/find_board.h"
#include "calibration/boards/picture_pairs.h"
#include "calibration/solve/shots.h"

namespace kino {

/// What a camera saw in a view.
struct GatheredPicture {
    int width = 0;
    int height = 0;
    std::optional<BoardSighting> board;
};

/// Sightings of one board by one or two cameras, view by view.
class Gathering {
  public:
    Gathering(Board board, std::vector<std::string> cameras);

    /// `pictures`: one a camera, or none where it took none. Pictures of a camera must be of one
    /// size: another is an error that names the view.
    [[nodiscard]] Result<void> add(const std::string& view,
                                   const std::vector<std::optional<GatheredPicture>>& pictures);

    /// The shots that are good enough, and in `notes` what was left out and why: no board seen,
    /// blurred (edges over 2.5 times as wide as the median, and 5 px; or over 0.4 squares). Fails
    /// where a camera's pictures are mirrored, or where nothing is left.
    [[nodiscard]] Result<Shots> shots(std::vector<std::string>& notes) const;

  private:
    struct View {
        std::string name;
        std::vector<std::optional<GatheredPicture>> pictures;
    };
    Board board_;
    std::vector<std::string> cameras_;
    std::vector<View> views_;
};

/// Reads and searches every picture of the set. `progress` is told one line a view.
[[nodiscard]] Result<Shots> shots_of_pictures(
    const PictureSet& set, const Board& board, std::vector<std::string>& notes,
    const std::function<void(std::string_view)>& progress = {});

}  // namespace kino
