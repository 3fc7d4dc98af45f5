#include "calibration/boards/gather.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/check.h"
#include "calibration/boards/edge_width.h"

namespace kino {

Gathering::Gathering(Board board, std::vector<std::string> cameras)
    : board_(board), cameras_(std::move(cameras)) {}

Result<void> Gathering::add(const std::string& view,
                            const std::vector<std::optional<GatheredPicture>>& pictures) {
    KINO_CHECK_EQ(pictures.size(), cameras_.size());
    for (std::size_t c = 0; c < pictures.size(); ++c) {
        if (!pictures[c]) continue;
        for (const View& other : views_) {
            const auto& known = other.pictures[c];
            if (!known) continue;
            if (known->width != pictures[c]->width || known->height != pictures[c]->height) {
                return fail(
                    fmt::format("this picture is {}x{}, that of {} {}x{}", pictures[c]->width,
                                pictures[c]->height, other.name, known->width, known->height),
                    fmt::format("{}, view {}", cameras_[c], view),
                    "all pictures of a camera must be of one size");
            }
            break;
        }
    }
    views_.push_back({view, pictures});
    return {};
}

Result<Shots> Gathering::shots(std::vector<std::string>& notes) const {
    Shots out;
    for (int id = 0; id < board_.corner_count(); ++id) {
        out.corners_m.push_back(board_.corner_m(id));
    }
    for (const View& view : views_) out.names.push_back(view.name);
    for (std::size_t c = 0; c < cameras_.size(); ++c) {
        CameraShots camera{cameras_[c], 0, 0, {}};
        std::vector<double> widths;
        std::size_t seen = 0;
        std::size_t mirrored_views = 0;
        for (const View& view : views_) {
            if (!view.pictures[c]) continue;
            camera.width = view.pictures[c]->width;
            camera.height = view.pictures[c]->height;
            if (!view.pictures[c]->board) continue;
            ++seen;
            if (view.pictures[c]->board->mirrored) ++mirrored_views;
            widths.push_back(view.pictures[c]->board->edge_width_px);
        }
        if (seen == 0) {
            return fail(fmt::format("no picture shows the board {}", board_text(board_)),
                        cameras_[c],
                        "count the inner corners of a chessboard, or the squares and the "
                        "dictionary of a ChArUco board");
        }
        if (2 * mirrored_views > seen) {
            return fail(
                "these pictures are mirrored: the markers are read only with left and "
                "right exchanged",
                cameras_[c], "switch the mirroring of this camera off and take them again");
        }
        std::sort(widths.begin(), widths.end());
        const double median = widths[widths.size() / 2];
        for (const View& view : views_) {
            auto& corners = camera.views.emplace_back();
            if (!view.pictures[c]) continue;
            const auto& board = view.pictures[c]->board;
            const std::string where = fmt::format("{}, view {}", cameras_[c], view.name);
            if (!board || board->mirrored) {
                notes.push_back(where + ": no board is seen");
                continue;
            }
            if (board->edge_width_px > blur_limit_px(median, board->square_px)) {
                notes.push_back(fmt::format(
                    "{}: blurred (edges {:.1f} px wide, {:.1f} px in the median view); left out",
                    where, board->edge_width_px, median));
                continue;
            }
            for (const SeenCorner& corner : board->corners) {
                corners.push_back({corner.id, corner.px});
            }
        }
        out.cameras.push_back(std::move(camera));
    }
    std::vector<bool> keep;
    for (std::size_t view = 0; view < views_.size(); ++view) {
        keep.push_back(
            std::any_of(out.cameras.begin(), out.cameras.end(),
                        [&](const CameraShots& camera) { return !camera.views[view].empty(); }));
    }
    return only_views(out, keep);
}

Result<Shots> shots_of_pictures(const PictureSet& set, const Board& board,
                                std::vector<std::string>& notes,
                                const std::function<void(std::string_view)>& progress) {
    if (set.cameras.size() == 2 && board.looks_same_upside_down()) {
        return fail(fmt::format("the board {} looks the same upside down, so two cameras may "
                                "disagree about its first corner",
                                board_text(board)),
                    "--board", "take one with an odd and an even number of corners, or ChArUco");
    }
    Gathering gathering(board, set.cameras);
    for (const PictureView& view : set.views) {
        std::vector<std::optional<GatheredPicture>> pictures;
        std::string line = view.name + ":";
        for (std::size_t c = 0; c < set.cameras.size(); ++c) {
            auto& picture = pictures.emplace_back();
            if (view.files[c].empty()) continue;
            KINO_ASSIGN(const GreyPicture grey, read_grey(view.files[c]));
            picture = {grey.width(), grey.height(), find_board(grey, board)};
            line += picture->board ? fmt::format(" {} corners", picture->board->corners.size())
                                   : std::string(" no board");
        }
        if (progress) progress(line);
        KINO_TRY(gathering.add(view.name, pictures));
    }
    return gathering.shots(notes);
}

}  // namespace kino
