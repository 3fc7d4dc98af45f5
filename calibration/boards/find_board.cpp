#include "calibration/boards/find_board.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <opencv2/aruco/charuco.hpp>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "calibration/boards/edge_width.h"

namespace kino {
namespace {

using Points = std::vector<cv::Point2f>;

constexpr int kHalvedAbove = 500;  // px wide

// OpenCV only reads the pixels.
cv::Mat as_mat(const GreyPicture& picture) {
    return {picture.height(), picture.width(), CV_8UC1, const_cast<std::uint8_t*>(picture.data())};
}

glm::dvec2 vector(const cv::Point2f& from, const cv::Point2f& to) {
    return {static_cast<double>(to.x) - from.x, static_cast<double>(to.y) - from.y};
}

double brightness(const cv::Mat& picture, const cv::Point2f& at) {
    const cv::Rect area =
        cv::Rect(cvRound(at.x) - 1, cvRound(at.y) - 1, 3, 3) & cv::Rect({0, 0}, picture.size());
    return area.empty() ? 0 : cv::mean(picture(area))[0];
}

// Square (column, row) between the corners; 0, 0 is the one inside the first corner.
double square_brightness(const cv::Mat& picture, const Points& p, int columns, int column,
                         int row) {
    const auto at = [&](int c, int r) { return p[static_cast<std::size_t>(r * columns + c)]; };
    const cv::Point2f sum =
        at(column, row) + at(column + 1, row) + at(column, row + 1) + at(column + 1, row + 1);
    return brightness(picture, sum * 0.25f);
}

void put_in_order(const cv::Mat& picture, const Board& board, Points& p) {
    const int columns = board.columns;
    const glm::dvec2 row = vector(p[0], p[static_cast<std::size_t>(columns - 1)]);
    const glm::dvec2 column = vector(p[0], p[static_cast<std::size_t>((board.rows - 1) * columns)]);
    if (row.x * column.y - row.y * column.x < 0) {
        for (int r = 0; r < board.rows; ++r) {
            std::reverse(p.begin() + r * columns, p.begin() + (r + 1) * columns);
        }
    }
    if (board.looks_same_upside_down()) return;
    double difference = 0;
    for (int r = 0; r + 1 < board.rows; ++r) {
        for (int c = 0; c + 1 < columns; ++c) {
            const double value = square_brightness(picture, p, columns, c, r);
            difference += (c + r) % 2 == 0 ? value : -value;
        }
    }
    const int squares = (columns - 1) * (board.rows - 1);
    // An odd number of squares cannot be here: one of the two counts is even.
    if (squares > 0 && difference > 0) std::reverse(p.begin(), p.end());
}

double shortest_pitch(const Board& board, const Points& p) {
    double least = 1e9;
    for (int i = 0; i < board.corner_count(); ++i) {
        const auto at = static_cast<std::size_t>(i);
        if (i % board.columns + 1 < board.columns) {
            least = std::min(least, glm::length(vector(p[at], p[at + 1])));
        }
        if (i + board.columns < board.corner_count()) {
            least = std::min(
                least, glm::length(vector(p[at], p[at + static_cast<std::size_t>(board.columns)])));
        }
    }
    return least;
}

bool find_chess(const cv::Mat& picture, const Board& board, bool quick, Points& corners) {
    const cv::Size size(board.columns, board.rows);
    const int flags = cv::CALIB_CB_ADAPTIVE_THRESH | cv::CALIB_CB_NORMALIZE_IMAGE |
                      (quick ? static_cast<int>(cv::CALIB_CB_FAST_CHECK) : 0);
    bool found = false;
    if (quick && picture.cols > kHalvedAbove) {
        cv::Mat small;
        cv::resize(picture, small, {}, 0.5, 0.5, cv::INTER_AREA);
        found = cv::findChessboardCorners(small, size, corners, flags);
        for (auto& p : corners) p = p * 2 + cv::Point2f(0.5f, 0.5f);
        // A second look at the whole picture would take too long among other corners.
        if (!found) return false;
    }
    if (!found) found = cv::findChessboardCorners(picture, size, corners, flags);
    if (!found && (quick || !cv::findChessboardCornersSB(picture, size, corners))) return false;
    // The window must not reach the next corner.
    const int reach = std::clamp(static_cast<int>(0.4 * shortest_pitch(board, corners)), 2, 11);
    cv::cornerSubPix(
        picture, corners, {reach, reach}, {-1, -1},
        {cv::TermCriteria::EPS | cv::TermCriteria::COUNT, quick ? 15 : 60, quick ? 0.02 : 0.001});
    put_in_order(picture, board, corners);
    return true;
}

std::vector<SeenCorner> find_charuco(const cv::Mat& picture, const Board& board) {
    const auto dictionary = cv::aruco::getPredefinedDictionary(board.dictionary);
    const auto pattern = cv::aruco::CharucoBoard::create(
        board.columns + 1, board.rows + 1, static_cast<float>(board.square_m),
        static_cast<float>(board.marker_m), dictionary);
    std::vector<Points> markers;
    std::vector<int> marker_ids;
    cv::aruco::detectMarkers(picture, dictionary, markers, marker_ids);
    std::vector<SeenCorner> out;
    if (marker_ids.empty()) return out;
    Points corners;
    std::vector<int> ids;
    cv::aruco::interpolateCornersCharuco(markers, marker_ids, picture, pattern, corners, ids);
    for (std::size_t i = 0; i < ids.size(); ++i) {
        if (ids[i] >= 0 && ids[i] < board.corner_count()) {
            out.push_back({ids[i], {corners[i].x, corners[i].y}});
        }
    }
    std::sort(out.begin(), out.end(), [](auto& a, auto& b) { return a.id < b.id; });
    return out;
}

bool spans_a_plane(const Board& board, const std::vector<SeenCorner>& corners) {
    if (corners.size() < 6) return false;
    const glm::dvec2 origin = board.corner_m(corners[0].id);
    const glm::dvec2 along = board.corner_m(corners[1].id) - origin;
    return std::count_if(corners.begin(), corners.end(), [&](const SeenCorner& c) {
               const glm::dvec2 d = board.corner_m(c.id) - origin;
               return std::abs(along.x * d.y - along.y * d.x) > 1e-9;
           }) >= 2;
}

}  // namespace

std::optional<BoardSighting> find_board(const GreyPicture& picture, const Board& board,
                                        const FindBoardOptions& options) {
    if (picture.width() < 32 || picture.height() < 32) return std::nullopt;
    const cv::Mat mat = as_mat(picture);
    BoardSighting out;
    if (board.kind == BoardKind::chess) {
        Points corners;
        if (!find_chess(mat, board, options.quick, corners)) return std::nullopt;
        for (std::size_t i = 0; i < corners.size(); ++i) {
            out.corners.push_back({static_cast<int>(i), {corners[i].x, corners[i].y}});
        }
        measure_edges(picture, board, out);
        return out;
    }
    out.corners = find_charuco(mat, board);
    if (spans_a_plane(board, out.corners)) {
        measure_edges(picture, board, out);
        return out;
    }
    if (options.quick) return std::nullopt;
    const GreyPicture turned = mirrored(picture);
    out.corners = find_charuco(as_mat(turned), board);
    if (!spans_a_plane(board, out.corners)) return std::nullopt;
    out.mirrored = true;
    measure_edges(turned, board, out);
    return out;
}

}  // namespace kino
