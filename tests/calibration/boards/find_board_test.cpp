#include "calibration/boards/find_board.h"

#include <gmock/gmock.h>

#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

#include "calibration/boards/gather.h"
#include "drawn_board.h"
#include "sensor/png_io.h"
#include "tests/support/temp_dir.h"

namespace kino {
namespace {

using test::blurred;
using test::draw_chessboard;
using testing::Contains;
using testing::HasSubstr;

CameraModel small_camera() {
    return {
        .width = 320, .height = 240, .fx = 280, .fy = 281, .cx = 160.3, .cy = 118.9, .k1 = -0.1};
}

Pose held(double tilt, double turn) {
    const glm::dquat rotation =
        glm::angleAxis(tilt, glm::dvec3(0.6, 0.8, 0)) * glm::angleAxis(turn, glm::dvec3(0, 0, 1));
    return {glm::normalize(rotation),
            glm::dvec3(0.01, -0.01, 0.42) - rotation * glm::dvec3(0.1, 0.0625, 0)};
}

TEST(FindBoard, CornersOfADrawnChessboardAreWhereTheyWereDrawn) {
    const Board board;
    const Projection projection(small_camera());
    for (const double turn : {0.0, 0.3, 3.0, -2.8}) {
        const Pose pose = held(0.4, turn);
        const auto found = find_board(draw_chessboard(small_camera(), board, pose, 1), board);
        ASSERT_TRUE(found) << turn;
        ASSERT_EQ(found->corners.size(), 54u);
        double sum = 0;
        glm::dvec2 bias(0);
        for (const SeenCorner& corner : found->corners) {
            const glm::dvec2 truth =
                *projection.project(pose * glm::dvec3(board.corner_m(corner.id), 0));
            sum += glm::distance(truth, corner.px);
            bias += (corner.px - truth) / 54.0;
        }
        // A wrong order would be off by whole squares.
        EXPECT_LT(sum / 54, 0.15) << turn;
        // Another idea of where pixel centres are would show as half a pixel.
        EXPECT_LT(glm::length(bias), 0.05) << turn;
        EXPECT_LT(found->edge_width_px, 4);
        EXPECT_GT(found->square_px, 10);
    }
}

TEST(FindBoard, QuickFindsTheSame) {
    const Board board;
    const GreyPicture picture = draw_chessboard(small_camera(), board, held(0.3, 0.1), 2);
    const auto quick = find_board(picture, board, {.quick = true});
    const auto thorough = find_board(picture, board);
    ASSERT_TRUE(quick && thorough);
    for (std::size_t i = 0; i < 54; ++i) {
        EXPECT_LT(glm::distance(quick->corners[i].px, thorough->corners[i].px), 0.2);
    }
}

TEST(FindBoard, NothingWhereNothingIs) {
    const GreyPicture flat(320, 240, 128);
    EXPECT_FALSE(find_board(flat, Board{}));
    const Board charuco = *parse_board("charuco:14x9:40:30:6");
    EXPECT_FALSE(find_board(flat, charuco));
    EXPECT_FALSE(find_board(GreyPicture(5, 5, 0), charuco));
    EXPECT_FALSE(find_board(GreyPicture(), Board{}));
    // Another board than the one asked for.
    EXPECT_FALSE(find_board(draw_chessboard(small_camera(), Board{}, held(0.3, 0), 3),
                            *parse_board("chess:8x5:25")));
}

TEST(FindBoard, CharucoInARealPicture) {
    const auto picture = read_grey("tests/data/calibration/azure-charuco/color-0.jpg");
    ASSERT_TRUE(picture) << picture.error().to_string();
    const Board board = *parse_board("charuco:14x9:40:30:DICT_5X5_250");
    const auto found = find_board(*picture, board);
    ASSERT_TRUE(found);
    EXPECT_GT(found->corners.size(), 95u);
    EXPECT_FALSE(found->mirrored);
    const auto turned = find_board(mirrored(*picture), board);
    ASSERT_TRUE(turned);
    EXPECT_TRUE(turned->mirrored);
}

TEST(Gathering, MirroredCharucoIsAnError) {
    const auto picture = read_grey("tests/data/calibration/azure-charuco/color-0.jpg");
    ASSERT_TRUE(picture);
    const Board board = *parse_board("charuco:14x9:40:30:6");
    Gathering gathering(board, {"color"});
    ASSERT_TRUE(gathering.add("0", {GatheredPicture{picture->width(), picture->height(),
                                                    find_board(mirrored(*picture), board)}}));
    std::vector<std::string> notes;
    const auto shots = gathering.shots(notes);
    ASSERT_FALSE(shots);
    EXPECT_THAT(shots.error().to_string(), HasSubstr("color: these pictures are mirrored"));
}

TEST(Gathering, BlurredViewsAreNamedAndLeftOut) {
    const Board board;
    Gathering gathering(board, {"infrared"});
    for (int view = 0; view < 4; ++view) {
        GreyPicture picture = draw_chessboard(small_camera(), board, held(0.3, 0.2 * view), 4);
        if (view == 2) picture = blurred(picture, 3);
        const auto found = find_board(picture, board);
        ASSERT_TRUE(found) << view;
        ASSERT_TRUE(gathering.add(std::to_string(view), {GatheredPicture{320, 240, found}}));
    }
    std::vector<std::string> notes;
    const auto shots = gathering.shots(notes);
    ASSERT_TRUE(shots);
    EXPECT_EQ(shots->names.size(), 3u);
    EXPECT_THAT(notes, Contains(HasSubstr("infrared, view 2: blurred (edges")));
}

TEST(Gathering, NoBoardInAnyPictureAndPicturesOfTwoSizes) {
    Gathering gathering(Board{}, {"infrared"});
    ASSERT_TRUE(gathering.add("a", {GatheredPicture{320, 240, std::nullopt}}));
    std::vector<std::string> notes;
    EXPECT_THAT(gathering.shots(notes).error().to_string(),
                HasSubstr("infrared: no picture shows the board chess:9x6:25"));
    const auto other = gathering.add("b", {GatheredPicture{640, 480, std::nullopt}});
    ASSERT_FALSE(other);
    EXPECT_THAT(other.error().to_string(), HasSubstr("this picture is 640x480, that of a 320x240"));
}

TEST(Board, TextRoundTripsAndNonsenseIsRefused) {
    for (const char* text : {"chess:9x6:25", "chess:3x4:12.5", "charuco:14x9:40:30:DICT_5X5_250"}) {
        const auto board = parse_board(text);
        ASSERT_TRUE(board) << text;
        EXPECT_EQ(board_text(*board), text);
    }
    for (const char* text :
         {"", "chess", "chess:9x6", "chess:2x6:25", "chess:9x6:0", "chess:9x6:nan", "chess:9x99:25",
          "charuco:14x9:30:40:6", "charuco:14x9:40:30:21", "charuco:-2147483648x9:40:30:6",
          "ring:9x6:25", "chess:9x6:25:1"}) {
        EXPECT_FALSE(parse_board(text)) << text;
    }
}

TEST(PicturePairs, ByNameInFoldersAndInOrder) {
    const test::TempDir folder;
    for (const char* name : {"left1.png", "left10.png", "left2.png", "right2.png", "right10.png"}) {
        folder.write(name, "x");
    }
    folder.write("notes.txt", "x");
    const auto set = picture_pairs_in(folder.path());
    ASSERT_TRUE(set) << set.error().to_string();
    EXPECT_THAT(set->cameras, testing::ElementsAre("left", "right"));
    ASSERT_EQ(set->views.size(), 3u);
    EXPECT_EQ(set->views[0].name, "1");
    EXPECT_TRUE(set->views[0].files[1].empty());
    EXPECT_EQ(set->views[2].name, "10");
    EXPECT_FALSE(picture_pairs_in(folder.path(), "a,b"));
    EXPECT_FALSE(picture_pairs_in(folder.path(), "left"));
    EXPECT_FALSE(pictures_in(folder / "missing"));
    const auto upside = shots_of_pictures(*set, *parse_board("chess:7x5:20"),
                                          *std::make_unique<std::vector<std::string>>());
    ASSERT_FALSE(upside);
    EXPECT_THAT(upside.error().to_string(), HasSubstr("looks the same upside down"));
}

TEST(GreyPicture, SixteenBitsAreStretchedAndOtherFilesRefused) {
    const test::TempDir folder;
    Image<std::uint16_t> deep(64, 64);
    for (int i = 0; i < 64 * 64; ++i) deep.data()[i] = static_cast<std::uint16_t>(1000 + i);
    ASSERT_TRUE(write_png_gray16(folder / "deep.png", deep));
    const auto grey = read_grey(folder / "deep.png");
    ASSERT_TRUE(grey) << grey.error().to_string();
    EXPECT_EQ(grey->at(0, 0), 0);
    EXPECT_EQ(grey->at(63, 63), 255);
    EXPECT_NEAR(grey->at(0, 32), 128, 2);
    EXPECT_FALSE(read_grey(folder.write("a.png", "no picture at all")));
    EXPECT_FALSE(read_grey(folder.write("a.jpg", "\xFF\xD8\xFF not one")));
}

}  // namespace
}  // namespace kino
