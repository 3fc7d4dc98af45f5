#include "calibration/boards/board.h"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <optional>
#include <vector>

#include "sensor/decimal.h"

namespace kino {
namespace {

constexpr std::array<std::string_view, 21> kDictionaries = {
    "DICT_4X4_50",         "DICT_4X4_100",       "DICT_4X4_250",       "DICT_4X4_1000",
    "DICT_5X5_50",         "DICT_5X5_100",       "DICT_5X5_250",       "DICT_5X5_1000",
    "DICT_6X6_50",         "DICT_6X6_100",       "DICT_6X6_250",       "DICT_6X6_1000",
    "DICT_7X7_50",         "DICT_7X7_100",       "DICT_7X7_250",       "DICT_7X7_1000",
    "DICT_ARUCO_ORIGINAL", "DICT_APRILTAG_16h5", "DICT_APRILTAG_25h9", "DICT_APRILTAG_36h10",
    "DICT_APRILTAG_36h11"};

std::vector<std::string_view> split(std::string_view text, char mark) {
    std::vector<std::string_view> out;
    for (;;) {
        const std::size_t at = text.find(mark);
        out.push_back(text.substr(0, at));
        if (at == std::string_view::npos) return out;
        text.remove_prefix(at + 1);
    }
}

std::optional<int> whole(std::string_view text) {
    int value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
    return value;
}

std::optional<double> millimetres(std::string_view text) {
    const auto value = parse_number(text);
    if (!value || !(*value >= 1) || !(*value <= 10000)) return std::nullopt;
    return *value / 1000;
}

std::optional<int> dictionary(std::string_view text) {
    for (std::size_t i = 0; i < kDictionaries.size(); ++i) {
        if (kDictionaries[i] == text) return static_cast<int>(i);
    }
    const auto number = whole(text);
    if (!number || *number < 0 || *number >= static_cast<int>(kDictionaries.size())) return {};
    return number;
}

std::optional<Board> parse(std::string_view text) {
    const auto parts = split(text, ':');
    if (parts.size() < 3) return std::nullopt;
    const auto sizes = split(parts[1], 'x');
    if (sizes.size() != 2) return std::nullopt;
    const auto columns = whole(sizes[0]);
    const auto rows = whole(sizes[1]);
    const auto square = millimetres(parts[2]);
    if (!columns || !rows || !square) return std::nullopt;
    Board board;
    board.square_m = *square;
    if (parts[0] == "chess" && parts.size() == 3) {
        board.columns = *columns;
        board.rows = *rows;
    } else if (parts[0] == "charuco" && parts.size() == 5) {
        const auto marker = millimetres(parts[3]);
        const auto number = dictionary(parts[4]);
        if (!marker || !number || *marker >= *square) return std::nullopt;
        // In range before the subtraction.
        if (*columns < 4 || *rows < 4) return std::nullopt;
        board.kind = BoardKind::charuco;
        board.columns = *columns - 1;
        board.rows = *rows - 1;
        board.marker_m = *marker;
        board.dictionary = *number;
    } else {
        return std::nullopt;
    }
    if (board.columns < 3 || board.rows < 3 || board.columns > 64 || board.rows > 64) return {};
    return board;
}

}  // namespace

Result<Board> parse_board(std::string_view text) {
    if (const auto board = parse(text)) return *board;
    return fail(fmt::format("\"{}\" describes no board", text), "--board",
                "chess:9x6:25 is 9 by 6 inner corners and squares of 25 mm; charuco:14x9:40:30:6 "
                "is 14 by 9 squares of 40 mm, markers of 30 mm, dictionary 6 or DICT_5X5_250");
}

std::string board_text(const Board& board) {
    if (board.kind == BoardKind::chess) {
        return fmt::format("chess:{}x{}:{}", board.columns, board.rows, board.square_m * 1000);
    }
    return fmt::format("charuco:{}x{}:{}:{}:{}", board.columns + 1, board.rows + 1,
                       board.square_m * 1000, board.marker_m * 1000,
                       kDictionaries[static_cast<std::size_t>(board.dictionary)]);
}

}  // namespace kino
