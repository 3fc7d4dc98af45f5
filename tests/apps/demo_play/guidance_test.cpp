#include "tests/apps/demo_play/play_fixture.h"

namespace kino::test {
namespace {

using K = GestureKind;

/// A hand that waves; all else stands still.
Body waver(double time_s, double swing_m) {
    Body body = somebody(1, 0);
    body[Joint::hand_right].position_m = {-0.35 + swing_m * std::sin(2 * 3.14159 * 1.6 * time_s),
                                          -0.55, 2.35};
    body[Joint::wrist_right].position_m = {-0.35, -0.45, 2.37};
    return body;
}

TEST(Guidance, SaysWhereToStandThenToWave) {
    Game game;
    const auto hint = [&] { return game.play().guidance().hint; };
    game.nobody(0.3);
    EXPECT_EQ(hint(), DemoHint::step_into_view);
    const auto stand = [&](double z_m) {
        for (int i = 0; i < 5; ++i) game.step({somebody(1, game.now_s(), 0, z_m)});
    };
    stand(4.4);
    EXPECT_EQ(hint(), DemoHint::step_closer);
    EXPECT_NEAR(game.play().guidance().distance_m, 4.4, 0.02);
    stand(3.75);  // a little nearer is not near enough: it does not flicker
    EXPECT_EQ(hint(), DemoHint::step_closer);
    stand(2.5);
    EXPECT_EQ(hint(), DemoHint::wave_to_start);
    EXPECT_GT(game.play().guidance().shown_s, 0.1);
    stand(1);
    EXPECT_EQ(hint(), DemoHint::step_back);
    stand(1.35);
    EXPECT_EQ(hint(), DemoHint::step_back);
    stand(1.6);
    EXPECT_EQ(hint(), DemoHint::wave_to_start);
    game.lost = true;
    stand(1.6);
    EXPECT_EQ(hint(), DemoHint::none);
}

TEST(Guidance, WhoLostTheLeadMayWaveForItAgain) {
    Game game;
    game.engage();
    EXPECT_EQ(game.play().guidance().hint, DemoHint::paint);
    game.make(K::released);
    EXPECT_EQ(game.play().phase(), DemoPhase::playing);
    EXPECT_EQ(game.play().guidance().hint, DemoHint::wave_to_start);
    game.make(K::engaged);
    EXPECT_NE(game.play().guidance().hint, DemoHint::wave_to_start);
}

TEST(Guidance, TheNearestVisitorIsAddressed) {
    Game game;
    game.step({somebody(1, 0, 1, 3.4), somebody(2, 0, -0.8, 2), somebody(3, 0, 0.2, 3)});
    EXPECT_NEAR(game.play().guidance().distance_m, std::hypot(0.8, 2), 0.01);
    game.step({somebody(1, 0, 1, 1.5), somebody(2, 0, -0.8, 2)});  // until they leave
    EXPECT_NEAR(game.play().guidance().distance_m, std::hypot(0.8, 2), 0.01);
    game.step({somebody(1, 0, 1, 1.5)});
    EXPECT_NEAR(game.play().guidance().distance_m, std::hypot(1, 1.5), 0.01);
}

TEST(Guidance, TheAnchorIsTheJointOnTheStage) {
    Game game;
    game.go_on(0.2);
    Body body = somebody(1, game.now_s());
    body[Joint::hand_left].position_m.y = 0.4f;  // the right hand is the higher one
    game.step({body});
    const DemoGuidance& guidance = game.play().guidance();
    ASSERT_TRUE(guidance.anchor_m.has_value());
    EXPECT_EQ(guidance.hand, Hand::right);
    glm::dvec3 hand(body[Joint::hand_right].position_m);
    hand.x = -hand.x;
    EXPECT_LT(glm::distance(*guidance.anchor_m, sensor_pose() * hand), 1e-4);
}

TEST(Guidance, AWaveIsSeenComing) {
    const auto most = [](double swing_m) {
        Game game;
        double progress = 0, last = 0;
        bool fell = false;
        for (int i = 0; i < 60; ++i) {
            game.step({waver(game.now_s(), swing_m)});
            if (i < 3) continue;
            const double now = game.play().guidance().progress;
            fell = fell || now < last - 1e-9;
            last = now;
            progress = std::max(progress, now);
        }
        EXPECT_FALSE(fell);
        return progress;
    };
    EXPECT_LT(most(0.0), 0.3);
    EXPECT_EQ(most(0.15), 1);
}

TEST(Guidance, LessonsComeInTurnAndAreNotRepeated) {
    Game game;
    const auto hint = [&] { return game.play().guidance().hint; };
    game.go_on(0.3);
    game.make(K::engaged);
    EXPECT_EQ(hint(), DemoHint::paint);
    game.go_on(4);  // hands that move paint
    EXPECT_EQ(hint(), DemoHint::swipe);
    game.make(K::swipe_left);
    game.go_on(kStep);
    EXPECT_EQ(hint(), DemoHint::push);
    game.make(K::raise_both);  // out of turn
    game.make(K::push);
    game.go_on(kStep);
    EXPECT_EQ(hint(), DemoHint::two_hands);
    GestureEvent turn = gesture(K::rotate, 1, Hand::both);
    turn.phase = GesturePhase::end;
    game.make(turn);
    game.go_on(kStep);
    EXPECT_EQ(hint(), DemoHint::none);
    EXPECT_FALSE(game.play().guidance().anchor_m.has_value());
    // Somebody else begins anew.
    game.nobody(4);
    game.go_on(0.3);
    game.make(K::engaged);
    game.go_on(kStep);
    EXPECT_EQ(hint(), DemoHint::paint);
}

TEST(Guidance, ALessonThatIsNotTakenUpMakesRoom) {
    Game game;
    game.go_on(0.2);
    game.make(K::engaged);
    game.go_on(4);
    EXPECT_EQ(game.play().guidance().hint, DemoHint::swipe);
    std::set<DemoHint> shown;
    for (int i = 0; i < 120; ++i) {
        game.go_on(1);
        shown.insert(game.play().guidance().hint);
    }
    EXPECT_EQ(shown, (std::set{DemoHint::swipe, DemoHint::push, DemoHint::two_hands,
                               DemoHint::raise_both}));
}

TEST(Guidance, PraisesInTheVeryStepOfTheEvent) {
    Game game;
    game.engage();
    for (const K kind : {K::push, K::swipe_up, K::raise, K::t_pose, K::raise_both, K::wave}) {
        game.go_on(0.5);
        EXPECT_GT(game.play().guidance().praised_ago_s, 0.4);
        game.make(kind);
        EXPECT_EQ(game.play().guidance().praised, kind);
        EXPECT_EQ(game.play().guidance().praised_ago_s, 0);
        game.go_on(kStep);
        EXPECT_NEAR(game.play().guidance().praised_ago_s, kStep, 1e-9);
    }
    game.go_on(0.5);
    game.make(K::dwell);  // is no gesture of the demo
    EXPECT_EQ(game.play().guidance().praised, K::wave);
    EXPECT_GT(game.play().guidance().praised_ago_s, 0.4);
}

TEST(Guidance, NamesAreDifferent) {
    std::set<std::string> names;
    for (int i = 0; i <= static_cast<int>(DemoHint::raise_both); ++i) {
        names.insert(demo_hint_name(static_cast<DemoHint>(i)));
    }
    for (int i = 0; i <= static_cast<int>(DemoPhase::lost); ++i) {
        names.insert(demo_phase_name(static_cast<DemoPhase>(i)));
    }
    EXPECT_EQ(names.size(), 14u);
}

}  // namespace
}  // namespace kino::test
