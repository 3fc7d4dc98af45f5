#include "calibration/boards/edge_width.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

namespace kino {
namespace {

constexpr double kBlurredTimes = 2.5;
constexpr double kBlurredPx = 5;
constexpr double kBlurredSquares = 0.4;

double sample(const GreyPicture& picture, const glm::dvec2& p) {
    const double x = std::clamp(p.x, 0.0, picture.width() - 1.001);
    const double y = std::clamp(p.y, 0.0, picture.height() - 1.001);
    const int left = static_cast<int>(x);
    const int top = static_cast<int>(y);
    const double fx = x - left;
    const double fy = y - top;
    const double above = picture.at(left, top) * (1 - fx) + picture.at(left + 1, top) * fx;
    const double below = picture.at(left, top + 1) * (1 - fx) + picture.at(left + 1, top + 1) * fx;
    return above * (1 - fy) + below * fy;
}

double median(std::vector<double>& values) {
    if (values.empty()) return 0;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

// Across the border between two squares, half way between two corners.
double width_across(const GreyPicture& picture, const glm::dvec2& a, const glm::dvec2& b) {
    const glm::dvec2 along = b - a;
    const double reach = 0.4 * glm::length(along);
    const glm::dvec2 across = glm::normalize(glm::dvec2(-along.y, along.x));
    const glm::dvec2 middle = (a + b) / 2.0;
    constexpr double kStep = 0.5;
    double lowest = 255;
    double highest = 0;
    double steepest = 0;
    double before = sample(picture, middle - reach * across);
    for (double at = -reach; at <= reach; at += kStep) {
        const double value = sample(picture, middle + at * across);
        lowest = std::min(lowest, value);
        highest = std::max(highest, value);
        steepest = std::max(steepest, std::abs(value - before) / kStep);
        before = value;
    }
    return steepest > 0 ? (highest - lowest) / steepest : 2 * reach;
}

}  // namespace

void measure_edges(const GreyPicture& picture, const Board& board, BoardSighting& sighting) {
    std::vector<const SeenCorner*> at(static_cast<std::size_t>(board.corner_count()), nullptr);
    for (const SeenCorner& corner : sighting.corners) {
        at[static_cast<std::size_t>(corner.id)] = &corner;
    }
    std::vector<double> lengths;
    std::vector<double> widths;
    const bool readable = picture.width() > 2 && picture.height() > 2;
    for (const SeenCorner& corner : sighting.corners) {
        const bool last_column = corner.id % board.columns == board.columns - 1;
        for (const int next : {last_column ? -1 : corner.id + 1, corner.id + board.columns}) {
            if (next < 0 || next >= board.corner_count()) continue;
            const SeenCorner* neighbour = at[static_cast<std::size_t>(next)];
            if (!neighbour || !readable) continue;
            const double length = glm::length(neighbour->px - corner.px);
            if (!(length > 1)) continue;
            lengths.push_back(length);
            widths.push_back(width_across(picture, corner.px, neighbour->px));
        }
    }
    sighting.square_px = median(lengths);
    sighting.edge_width_px = median(widths);
}

double blur_limit_px(double usual_px, double square_px) {
    return std::min(std::max(kBlurredPx, kBlurredTimes * usual_px), kBlurredSquares * square_px);
}

double mean_motion_px(const BoardSighting& a, const BoardSighting& b) {
    double sum = 0;
    double count = 0;
    auto other = b.corners.begin();
    for (const SeenCorner& corner : a.corners) {
        while (other != b.corners.end() && other->id < corner.id) ++other;
        if (other == b.corners.end()) break;
        if (other->id != corner.id) continue;
        sum += glm::distance(corner.px, other->px);
        ++count;
    }
    return count > 0 ? sum / count : std::numeric_limits<double>::infinity();
}

}  // namespace kino
