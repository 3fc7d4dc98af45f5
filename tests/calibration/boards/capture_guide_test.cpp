#include "calibration/boards/capture_guide.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

#include "calibration/projection.h"
#include "tests/support/random.h"

namespace kino {
namespace {

using testing::HasSubstr;

constexpr double kRadians = 3.14159265358979323846 / 180;
constexpr TimeNs kFrame = kNsPerSecond / 30;

CameraModel guided_camera() {
    return {.width = 640, .height = 480, .fx = 580, .fy = 580, .cx = 318, .cy = 242, .k1 = -0.08};
}

// The board's middle at `place`, turned so that its left (x) and upper (y) side are away.
Pose stand_at(const glm::dvec3& place, double left_deg, double upper_deg) {
    const Board board;
    const glm::dquat rotation = glm::angleAxis(left_deg * kRadians, glm::dvec3(0, 1, 0)) *
                                glm::angleAxis(-upper_deg * kRadians, glm::dvec3(1, 0, 0));
    const glm::dvec3 middle(board.corner_m(board.corner_count() - 1) / 2.0, 0);
    return {glm::normalize(rotation), place - rotation * middle};
}

// Plays frames of a script to a guide.
class Script {
  public:
    explicit Script(GuideOptions options = {}) : guide(Board{}, 1, options) {}

    GuideAnswer show(const Pose& pose, double edge_px = 2, double shake_px = 0) {
        const Projection projection(guided_camera());
        GatheredPicture picture{640, 480, BoardSighting{}};
        picture.board->edge_width_px = edge_px;
        picture.board->square_px = 40;
        const Board board;
        for (int id = 0; id < board.corner_count(); ++id) {
            const auto px = projection.project(pose * glm::dvec3(board.corner_m(id), 0));
            if (!px || px->x < 0 || px->y < 0 || px->x > 639 || px->y > 479) {
                picture.board.reset();
                break;
            }
            const glm::dvec2 noise(random_.real(-0.1, 0.1), random_.real(-0.1, 0.1));
            picture.board->corners.push_back({id, *px + noise + glm::dvec2(shake_px, 0)});
        }
        seen = picture.board.has_value();
        return look({picture});
    }
    GuideAnswer show_nothing() { return look({GatheredPicture{640, 480, std::nullopt}}); }

    GuideAnswer hold(const Pose& pose, int frames) {
        GuideAnswer answer;
        for (int i = 0; i < frames; ++i) answer = show(pose);
        return answer;
    }
    void move(const Pose& from, const Pose& to, int frames) {
        for (int i = 1; i < frames; ++i) {
            const GuideAnswer answer = show(interpolate(from, to, static_cast<double>(i) / frames));
            EXPECT_FALSE(answer.take);
        }
    }

    CaptureGuide guide;
    bool seen = false;

  private:
    GuideAnswer look(const std::vector<std::optional<GatheredPicture>>& pictures) {
        return guide.look(pictures, time_ += kFrame);
    }
    test::Random random_{5};
    TimeNs time_ = 0;
};

std::vector<Pose> places() {
    std::vector<Pose> out;
    for (const double y : {-1.0, 0.0, 1.0}) {
        for (const double x : {-1.0, 0.0, 1.0}) {
            const double z = 0.5;
            out.push_back(stand_at({0.15 * x, 0.125 * y, z}, -20 * x, -20 * y));
        }
    }
    out.push_back(stand_at({0.01, 0, 0.34}, 25, 10));
    out.push_back(stand_at({0.01, 0, 0.36}, -25, 10));
    out.push_back(stand_at({-0.01, 0, 0.35}, 0, 30));
    out.push_back(stand_at({0.05, 0.05, 0.8}, 25, 10));
    return out;
}

TEST(CaptureGuide, TakesOnePictureInEachPlaceAndNoneOnTheWay) {
    Script script;
    Pose before = stand_at({0, 0, 0.6}, 0, 0);
    int taken = 0;
    for (const Pose& place : places()) {
        script.move(before, place, 12);
        int here = 0;
        for (int i = 0; i < 9; ++i) {
            const GuideAnswer answer = script.show(place);
            ASSERT_TRUE(script.seen);
            here += answer.take ? 1 : 0;
            EXPECT_EQ(answer.take, answer.state == GuideState::taken);
            // Not in the first frame of rest.
            EXPECT_FALSE(i < 2 && answer.take);
        }
        EXPECT_EQ(here, 1) << taken;
        taken += here;
        before = place;
    }
    EXPECT_EQ(script.guide.taken(), static_cast<int>(places().size()));
    EXPECT_TRUE(script.guide.enough());
    const GuideCoverage& coverage = *script.guide.coverage(0);
    EXPECT_GT(coverage.field_share(), 0.8);
    EXPECT_GE(coverage.views(GuideCoverage::left), 2);
    EXPECT_GE(coverage.views(GuideCoverage::lower), 2);
    EXPECT_GE(coverage.views(GuideCoverage::near), 2);
    ASSERT_TRUE(script.guide.expected_focal_percent(0));
    EXPECT_LT(*script.guide.expected_focal_percent(0), 1);
}

TEST(CaptureGuide, TiltsAndDistancesAreThoseOfTheBoard) {
    Script script;
    script.show(stand_at({0, 0, 0.5}, 30, 0));
    ASSERT_TRUE(script.guide.stand(0));
    EXPECT_NEAR(script.guide.stand(0)->tilt_x_deg, 30, 5);
    EXPECT_TRUE(script.guide.stand(0)->away[GuideCoverage::left]);
    EXPECT_FALSE(script.guide.stand(0)->away[GuideCoverage::upper]);
    script.show(stand_at({0, 0, 0.5}, 0, -30));
    EXPECT_TRUE(script.guide.stand(0)->away[GuideCoverage::lower]);
    EXPECT_FALSE(script.guide.stand(0)->away[GuideCoverage::right]);
    EXPECT_EQ(script.guide.stand(0)->distance, GuideCoverage::middle);
    script.show(stand_at({0, 0, 0.33}, 0, 0));
    EXPECT_EQ(script.guide.stand(0)->distance, GuideCoverage::near);
    script.show(stand_at({0, 0, 1.2}, 0, 0));
    EXPECT_EQ(script.guide.stand(0)->distance, GuideCoverage::far);
    script.show_nothing();
    EXPECT_FALSE(script.guide.stand(0));
}

TEST(CaptureGuide, BlurredPicturesAreNotTaken) {
    Script script;
    const Pose place = stand_at({0, 0, 0.5}, 20, 0);
    GuideAnswer answer;
    for (int i = 0; i < 12; ++i) {
        answer = script.show(place, 9);
        EXPECT_FALSE(answer.take);
    }
    EXPECT_EQ(answer.state, GuideState::blurred);
    EXPECT_THAT(answer.words, HasSubstr("blurred"));
    EXPECT_TRUE(script.show(place, 2).take);
}

TEST(CaptureGuide, TheSameViewIsNotTakenTwice) {
    Script script;
    const Pose place = stand_at({0, 0, 0.5}, 20, 0);
    script.hold(place, 4);
    EXPECT_EQ(script.guide.taken(), 1);
    const Pose other = stand_at({0.1, 0, 0.5}, -20, 0);
    script.move(place, other, 12);
    script.hold(other, 6);
    EXPECT_EQ(script.guide.taken(), 2);
    script.move(other, place, 12);
    const GuideAnswer again = script.hold(place, 10);
    EXPECT_EQ(again.state, GuideState::known);
    EXPECT_EQ(script.guide.taken(), 2);
}

// Once most is known, a new place that promises nothing is left alone, and one that does is not.
TEST(CaptureGuide, ViewsMustPromiseSomething) {
    GuideOptions options;
    options.least_views = 25;
    options.least_fall = 2;  // nothing falls by more than all of it
    Script script(options);
    Pose before = stand_at({0, 0, 0.6}, 0, 0);
    for (const Pose& place : places()) {
        script.move(before, place, 12);
        script.hold(place, 6);
        before = place;
    }
    const Pose flat = stand_at({0.0, 0.04, 0.42}, 0, 0);
    script.move(before, flat, 12);
    EXPECT_EQ(script.hold(flat, 8).state, GuideState::known);
    options.least_fall = 0;
    Script eager(options);
    before = stand_at({0, 0, 0.6}, 0, 0);
    for (const Pose& place : places()) {
        eager.move(before, place, 12);
        eager.hold(place, 6);
        before = place;
    }
    const int taken = eager.guide.taken();
    eager.move(before, flat, 12);
    eager.hold(flat, 8);
    EXPECT_EQ(eager.guide.taken(), taken + 1);
}

TEST(CaptureGuide, RestMayTrembleButNotCreep) {
    const Pose place = stand_at({0, 0, 0.5}, 20, 0);
    Script trembling;
    trembling.show(place);
    trembling.show(place, 2, 0.5);
    // Over the limit of coming to rest (1.28 px), under that of leaving it.
    trembling.show(place, 2, 2.3);
    trembling.show(place, 2, 2.0);
    EXPECT_EQ(trembling.guide.taken(), 0);
    EXPECT_TRUE(trembling.show(place, 2, 1.8).take);

    Script creeping;
    for (int i = 0; i < 20; ++i) {
        EXPECT_FALSE(creeping.show(place, 2, 2.6 * i).take);
    }
    GuideOptions slow;
    slow.still_frames = 6;
    Script creeping_slowly(slow);
    for (int i = 0; i < 20; ++i) {
        EXPECT_FALSE(creeping_slowly.show(place, 2, 1.1 * i).take) << i;
    }
}

TEST(CaptureGuide, ABoardLostForTwoFramesIsNotLost) {
    Script script;
    const Pose place = stand_at({0, 0, 0.5}, 20, 0);
    EXPECT_EQ(script.show_nothing().state, GuideState::no_board);
    script.hold(place, 2);
    EXPECT_EQ(script.show_nothing().state, GuideState::moving);
    EXPECT_EQ(script.show_nothing().state, GuideState::moving);
    const GuideAnswer lost = script.show_nothing();
    EXPECT_EQ(lost.state, GuideState::no_board);
    EXPECT_THAT(lost.words, HasSubstr("show the whole board"));
    // Rest must be found anew.
    EXPECT_FALSE(script.show(place).take);
}

TEST(CaptureGuide, AsksForThePartOfThePictureThatIsMissing) {
    Script script;
    Pose before = stand_at({-0.1, 0, 0.5}, 0, 0);
    // All tilts and distances, but only in the left half.
    for (const double y : {-0.09, 0.0, 0.09}) {
        for (const double z : {0.5, 0.48}) {
            const Pose place = stand_at({-0.12, y, z}, z == 0.5 ? 22 : -22, y > 0 ? 22 : -22);
            script.move(before, place, 12);
            script.hold(place, 6);
            before = place;
        }
    }
    ASSERT_GE(script.guide.taken(), 4);
    script.move(before, stand_at({-0.1, 0, 0.55}, 0, 0), 12);
    const auto wants = script.guide.coverage(0)->missing();
    const auto field = std::find_if(wants.begin(), wants.end(), [](const auto& want) {
        return want.kind == GuideCoverage::Want::Kind::field;
    });
    ASSERT_NE(field, wants.end());
    EXPECT_THAT(field->words, HasSubstr("right"));
}

TEST(CaptureGuide, AsksForTiltsWhenBoardsAreFlat) {
    Script script;
    Pose before = stand_at({0, 0, 0.5}, 0, 0);
    for (const Pose& place : places()) {
        const Pose flat = stand_at(place * glm::dvec3(0.1, 0.0625, 0), 0, 0);
        script.move(before, flat, 12);
        script.hold(flat, 6);
        before = flat;
    }
    const auto wants = script.guide.coverage(0)->missing();
    ASSERT_FALSE(wants.empty());
    EXPECT_EQ(wants[0].kind, GuideCoverage::Want::Kind::tilt);
    EXPECT_FALSE(script.guide.enough());
    EXPECT_THAT(script.show(stand_at({0.05, 0.02, 0.6}, 0, 0)).words, HasSubstr("tilt the board"));
}

TEST(CaptureGuide, WishesDoNotFlicker) {
    Script script;
    std::vector<std::string> heard;
    Pose from = stand_at({0, 0, 0.6}, 0, 0);
    // Four seconds of movement: nothing is taken, so nothing else may be asked for.
    for (int lap = 0; lap < 10; ++lap) {
        const Pose to = stand_at({lap % 2 == 0 ? 0.1 : -0.1, 0.02, 0.55}, 10, -10);
        for (int i = 1; i < 12; ++i) {
            const auto answer = script.show(interpolate(from, to, i / 12.0));
            if (heard.empty() || heard.back() != answer.words) heard.push_back(answer.words);
        }
        from = to;
    }
    EXPECT_EQ(heard.size(), 1u) << testing::PrintToString(heard);
    // What cannot be done gives way once patience is over.
    for (int lap = 0; lap < 20; ++lap) {
        const Pose to = stand_at({lap % 2 == 0 ? 0.1 : -0.1, 0.02, 0.55}, 10, -10);
        for (int i = 1; i < 12; ++i) {
            const auto answer = script.show(interpolate(from, to, i / 12.0));
            if (heard.back() != answer.words) heard.push_back(answer.words);
        }
        from = to;
    }
    EXPECT_EQ(heard.size(), 2u) << testing::PrintToString(heard);
}

TEST(CaptureGuide, EndsWithEnoughViews) {
    GuideOptions options;
    options.views = 2;
    Script script(options);
    const Pose first = stand_at({0, 0, 0.5}, 20, 0);
    const Pose second = stand_at({0.1, 0, 0.5}, -20, 0);
    script.hold(first, 5);
    script.move(first, second, 12);
    script.hold(second, 5);
    EXPECT_TRUE(script.guide.enough());
    EXPECT_EQ(script.show(first).state, GuideState::enough);
}

// A view counts only where both cameras see the board whole and still.
TEST(CaptureGuide, BothCamerasMustSeeIt) {
    CaptureGuide guide(Board{}, 2);
    const Projection projection(guided_camera());
    const Pose place = stand_at({0, 0, 0.5}, 20, 0);
    GatheredPicture picture{640, 480, BoardSighting{}};
    picture.board->edge_width_px = 2;
    picture.board->square_px = 40;
    for (int id = 0; id < 54; ++id) {
        picture.board->corners.push_back(
            {id, *projection.project(place * glm::dvec3(Board{}.corner_m(id), 0))});
    }
    TimeNs time = 0;
    for (int i = 0; i < 8; ++i) {
        EXPECT_FALSE(guide.look({picture, GatheredPicture{640, 480, std::nullopt}}, ++time).take);
        EXPECT_FALSE(guide.look({picture, std::nullopt}, ++time).take);
    }
    for (int i = 0; i < 4; ++i) (void)guide.look({picture, picture}, ++time);
    EXPECT_EQ(guide.taken(), 1);
}

}  // namespace
}  // namespace kino
