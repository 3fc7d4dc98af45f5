#include "skeleton/people/assignment.h"

#include <algorithm>
#include <cstddef>
#include <limits>

#include "base/check.h"

namespace kino {

std::vector<int> assign(const std::vector<double>& cost, int rows, int columns) {
    KINO_CHECK(rows >= 0 && columns >= 0);
    KINO_CHECK(cost.size() == static_cast<std::size_t>(rows) * static_cast<std::size_t>(columns));
    // One dummy column a row makes every row pairable; it costs more than any sum of real pairs.
    constexpr double kAlone = 1e5;
    const int wide = columns + rows;
    const auto price = [&](int row, int column) {
        if (column >= columns) return kAlone;
        return cost[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) +
                    static_cast<std::size_t>(column)];
    };
    // Index 0 is the row or column that stands for "none yet".
    std::vector<double> row_potential(static_cast<std::size_t>(rows) + 1, 0.0);
    std::vector<double> column_potential(static_cast<std::size_t>(wide) + 1, 0.0);
    std::vector<int> row_of(static_cast<std::size_t>(wide) + 1, 0);
    for (int row = 1; row <= rows; ++row) {
        std::vector<double> slack(static_cast<std::size_t>(wide) + 1,
                                  std::numeric_limits<double>::infinity());
        std::vector<int> came_from(static_cast<std::size_t>(wide) + 1, 0);
        std::vector<char> done(static_cast<std::size_t>(wide) + 1, 0);
        row_of[0] = row;
        int column = 0;
        do {
            done[static_cast<std::size_t>(column)] = 1;
            const int at = row_of[static_cast<std::size_t>(column)];
            double least = std::numeric_limits<double>::infinity();
            int next = 0;
            for (int j = 1; j <= wide; ++j) {
                const auto k = static_cast<std::size_t>(j);
                if (done[k]) continue;
                const double reduced = price(at - 1, j - 1) -
                                       row_potential[static_cast<std::size_t>(at)] -
                                       column_potential[k];
                if (reduced < slack[k]) {
                    slack[k] = reduced;
                    came_from[k] = column;
                }
                if (slack[k] < least) {
                    least = slack[k];
                    next = j;
                }
            }
            for (int j = 0; j <= wide; ++j) {
                const auto k = static_cast<std::size_t>(j);
                if (done[k]) {
                    row_potential[static_cast<std::size_t>(row_of[k])] += least;
                    column_potential[k] -= least;
                } else {
                    slack[k] -= least;
                }
            }
            column = next;
        } while (row_of[static_cast<std::size_t>(column)] != 0);
        while (column != 0) {
            const int before = came_from[static_cast<std::size_t>(column)];
            row_of[static_cast<std::size_t>(column)] = row_of[static_cast<std::size_t>(before)];
            column = before;
        }
    }
    std::vector<int> result(static_cast<std::size_t>(rows), -1);
    for (int j = 1; j <= columns; ++j) {
        const int row = row_of[static_cast<std::size_t>(j)];
        if (row != 0 && price(row - 1, j - 1) < kNoPair) {
            result[static_cast<std::size_t>(row) - 1] = j - 1;
        }
    }
    return result;
}

}  // namespace kino
