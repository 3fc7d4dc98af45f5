#include <gtest/gtest.h>
#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <set>
#include <string>

#include "apps/demo_show/gesture_outline.h"
#include "apps/demo_show/gesture_places.h"
#include "apps/demo_show/show_keys.h"
#include "apps/demo_show/show_screen.h"
#include "apps/demo_show/ui_canvas.h"

namespace kino {
namespace {

constexpr std::array kHints = {DemoHint::step_into_view, DemoHint::step_back, DemoHint::step_closer,
                               DemoHint::wave_to_start,  DemoHint::paint,     DemoHint::swipe,
                               DemoHint::push,           DemoHint::two_hands, DemoHint::raise_both};

double difference(const std::vector<OutlineLine>& a, const std::vector<OutlineLine>& b) {
    double sum = a.size() == b.size() ? 0 : 10;
    for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
        sum += std::abs(a[i].strength - b[i].strength);
        for (std::size_t k = 0; k < std::min(a[i].points.size(), b[i].points.size()); ++k) {
            sum += glm::length(a[i].points[k] - b[i].points[k]);
        }
    }
    return sum;
}

TEST(Outline, StaysInItsSquareAndMoves) {
    for (const DemoHint hint : kHints) {
        double moved = 0;
        for (double t = 0; t < 8; t += 0.05) {
            const auto now = gesture_outline(hint, Hand::right, t);
            ASSERT_FALSE(now.empty()) << demo_hint_name(hint);
            for (const OutlineLine& line : now) {
                EXPECT_GE(line.points.size(), 2u);
                EXPECT_GE(line.strength, 0);
                EXPECT_LE(line.strength, 1);
                for (const glm::vec2& p : line.points) {
                    EXPECT_LE(std::max(std::abs(p.x), std::abs(p.y)), 1.42f)
                        << demo_hint_name(hint) << " at " << t;
                }
            }
            moved += difference(now, gesture_outline(hint, Hand::right, t + 0.05));
        }
        EXPECT_GT(moved, 5) << demo_hint_name(hint);
    }
    EXPECT_TRUE(gesture_outline(DemoHint::none, Hand::none, 1).empty());
}

TEST(Outline, ClockThatIsNoNumberGivesAPictureStill) {
    for (const DemoHint hint : kHints) {
        for (const double t : {double{INFINITY}, -double{INFINITY}, double{NAN}, -1e300}) {
            for (const OutlineLine& line : gesture_outline(hint, Hand::left, t)) {
                for (const glm::vec2& p : line.points) EXPECT_LE(glm::length(p), 2);
            }
        }
    }
}

TEST(Outline, SwipesGoInwards) {
    EXPECT_GT(difference(gesture_outline(DemoHint::swipe, Hand::left, 0.3),
                         gesture_outline(DemoHint::swipe, Hand::right, 0.3)),
              0.5);
}

TEST(Outline, WordsAreFewAndOwn) {
    std::set<std::string> all;
    for (const DemoHint hint : kHints) {
        const std::string words = hint_words(hint);
        EXPECT_LE(words.size(), 24u) << words;
        EXPECT_LE(std::count(words.begin(), words.end(), ' '), 3) << words;
        EXPECT_TRUE(all.insert(words).second) << words;
    }
    EXPECT_STREQ(hint_words(DemoHint::none), "");
}

/// What a screen comes to, without a window and without a device.
class GuidanceScreen : public testing::Test {
  protected:
    GuidanceScreen() {
        unsigned char* pixels = nullptr;
        int width = 0, height = 0;
        ImGui::GetIO().Fonts->GetTexDataAsRGBA32(&pixels, &width, &height);
    }
    struct Drawn {
        int vertices = 0;
        bool finite = true;
        glm::vec2 least{1e9f}, most{-1e9f};  ///< px
    };
    Drawn draw(const ShowScreen& screen, const View& view, double dt_s = 0.033) {
        context.begin_picture(view.width, view.height, dt_s);
        draw_screen(UiCanvas(view.width, view.height), view, screen, dt_s, spots);
        const ImDrawData& data = context.end_frame();
        Drawn drawn;
        for (int i = 0; i < data.CmdListsCount; ++i) {
            for (const ImDrawVert& v : data.CmdLists[i]->VtxBuffer) {
                ++drawn.vertices;
                drawn.finite = drawn.finite && std::isfinite(v.pos.x) && std::isfinite(v.pos.y);
                drawn.least = glm::min(drawn.least, glm::vec2(v.pos.x, v.pos.y));
                drawn.most = glm::max(drawn.most, glm::vec2(v.pos.x, v.pos.y));
            }
        }
        return drawn;
    }
    static View view_of(int width, int height) {
        return {.width = width,
                .height = height,
                .projection = perspective(0.8, width, height),
                .world_from_view = look_at({0, 1, 3}, {0, 1, 0})};
    }
    UiContext context{40.0f};
    std::array<GuidanceSpot, 2> spots;
};

TEST_F(GuidanceScreen, IsInThePictureWhereverPeopleAre) {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> place(-6, 6);
    for (int i = 0; i < 400; ++i) {
        DemoGuidance guidance{.hint = kHints[static_cast<std::size_t>(i) % kHints.size()],
                              .shown_s = 1 + 0.01 * i,
                              .progress = 0.01 * (i % 100)};
        if (i % 7 != 0) guidance.anchor_m = {place(random), place(random), place(random)};
        if (i % 31 == 0) guidance.anchor_m = glm::dvec3(std::numeric_limits<double>::quiet_NaN());
        if (i % 37 == 0) guidance.anchor_m = glm::dvec3(1e30);
        ShowScreen screen;
        screen.guidance = {&guidance, nullptr};
        const View view = view_of(i % 2 == 0 ? 1280 : 480, i % 2 == 0 ? 720 : 640);
        spots = {};
        const Drawn drawn = draw(screen, view);
        EXPECT_GT(drawn.vertices, 50);
        EXPECT_TRUE(drawn.finite);
        EXPECT_GE(drawn.least.x, -2);
        EXPECT_GE(drawn.least.y, -2);
        EXPECT_LE(drawn.most.x, static_cast<float>(view.width) + 2);
        EXPECT_LE(drawn.most.y, static_cast<float>(view.height) + 2);
    }
}

TEST_F(GuidanceScreen, WordsAreReadFromThreeMetres) {
    EXPECT_GE(kGuidanceWords * 720, 36);
}

TEST_F(GuidanceScreen, FlashIsThereInTheSamePicture) {
    const View view = view_of(1280, 720);
    DemoGuidance guidance{.anchor_m = glm::dvec3(0.2, 1.2, 0)};
    ShowScreen screen;
    screen.guidance = {&guidance, nullptr};
    EXPECT_TRUE(screen.empty());
    EXPECT_EQ(draw(screen, view).vertices, 0);
    guidance.praised = GestureKind::push;
    guidance.praised_ago_s = 0;
    EXPECT_FALSE(screen.empty());
    EXPECT_GT(draw(screen, view).vertices, 50);
    guidance.praised_ago_s = 5;
    EXPECT_TRUE(screen.empty());
}

TEST_F(GuidanceScreen, ComesAfterAHandCalmly) {
    const View view = view_of(1280, 720);
    DemoGuidance guidance{.hint = DemoHint::push, .shown_s = 1, .anchor_m = glm::dvec3(0.1, 1, 0)};
    ShowScreen screen;
    screen.guidance = {&guidance, nullptr};
    draw(screen, view);
    const glm::vec2 before = *spots[0].at;
    guidance.anchor_m = glm::dvec3(0.3, 1, 0);
    draw(screen, view);
    const float step = glm::length(*spots[0].at - before);
    EXPECT_GT(step, 1);
    EXPECT_LT(step, 20);
    for (int i = 0; i < 120; ++i) draw(screen, view);
    EXPECT_GT(glm::length(*spots[0].at - before), 40);
    // To the other hand it does not go across the person.
    guidance.anchor_m = glm::dvec3(-0.4, 1, 0);
    draw(screen, view);
    EXPECT_LT(spots[0].at->x, 640);
    EXPECT_EQ(spots[0].shown_s, 0);
    // Another hint begins where it belongs.
    guidance = {.hint = DemoHint::swipe, .anchor_m = glm::dvec3(-0.6, 1, 0)};
    draw(screen, view);
    EXPECT_LT(spots[0].at->x, 640);
}

TEST_F(GuidanceScreen, EveryScreenOfWordsFitsIntoSmallPictures) {
    for (const auto& [width, height] : {std::pair{320, 180}, {1280, 720}, {300, 600}}) {
        ShowScreen screen;
        screen.banner = "no sensor: watching a recording";
        screen.note = "scenes are changed by who plays: wave first";
        screen.records = true;
        const Drawn words = draw(screen, view_of(width, height));
        EXPECT_GE(words.least.x, -2) << width;
        EXPECT_LE(words.most.x, static_cast<float>(width) + 2) << width;
        screen = {};
        screen.trouble = ShowScreen::Trouble{"The sensor is gone", "Check its cable."};
        const Drawn trouble = draw(screen, view_of(width, height));
        EXPECT_LE(trouble.most.x, static_cast<float>(width) + 2) << width;
        EXPECT_LE(trouble.most.y, static_cast<float>(height) + 2) << width;
    }
}

TEST(GuidancePlaces, AreWhereTheHandIs) {
    BodyFrame bodies;
    Body body;
    body.id = 7;
    body[Joint::hand_left] = {{0.5f, 0.1f, 2}, JointState::tracked, 1};
    body[Joint::hand_right] = {{-0.3f, 0.2f, 2}, JointState::inferred, 1};
    bodies.bodies = {body};
    const Pose world = world_from_camera_axes();
    GesturePlaces places;
    EXPECT_FALSE(places.of(GestureKind::push, &bodies, world, false));
    places.hear({.kind = GestureKind::push, .hand = Hand::right, .body_id = 7});
    places.hear({.kind = GestureKind::zoom, .hand = Hand::both, .body_id = 7});
    places.hear({.kind = GestureKind::raise, .hand = Hand::left, .body_id = 8});
    EXPECT_NEAR(places.of(GestureKind::push, &bodies, world, false)->x, -0.3, 1e-6);
    // In a mirror the right hand stays at the right: the depth camera's x, turned over.
    EXPECT_NEAR(places.of(GestureKind::push, &bodies, world, true)->x, 0.3, 1e-6);
    EXPECT_NEAR(places.of(GestureKind::push, &bodies, world, true)->y, -0.2, 1e-6);
    EXPECT_NEAR(places.of(GestureKind::zoom, &bodies, world, false)->x, 0.1, 1e-6);
    EXPECT_FALSE(places.of(GestureKind::raise, &bodies, world, false));
    EXPECT_FALSE(places.of(GestureKind::push, nullptr, world, false));
    bodies.bodies[0][Joint::hand_right].state = JointState::lost;
    EXPECT_FALSE(places.of(GestureKind::push, &bodies, world, false));
    places.reset();
    EXPECT_FALSE(places.of(GestureKind::zoom, &bodies, world, false));
}

TEST(GuidanceKeys, EveryKeyIsOneAction) {
    for (const ShowKey& key : show_key_table()) EXPECT_EQ(show_action_of(key.key), key.action);
    EXPECT_FALSE(show_action_of('Z'));
}

}  // namespace
}  // namespace kino
