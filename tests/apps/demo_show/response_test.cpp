#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <tuple>

#include "apps/demo/demo_play.h"
#include "apps/demo_show/screen_painter.h"
#include "skeleton/synthetic/performance.h"
#include "skeleton/synthetic/scene.h"
#include "tests/viz/viz_fixture.h"

/// From a gesture to pixels: the same moments are played twice, once without the gesture, and the
/// pictures compared.
namespace kino {
namespace {

constexpr int kWidth = 96, kHeight = 54;
constexpr double kFrameS = 1.0 / 30;

/// Somebody who is engaged before this, by the performance's script.
constexpr double kEngagedS = 7;

class Response : public test::VizTest {
  protected:
    static const SyntheticScene& person() {
        static const SyntheticScene scene = make_performance(64, 48);
        return scene;
    }
    static DemoPlay new_play() {
        auto play = DemoPlay::create({.scenes = {"light-painting", "playroom"}});
        KINO_CHECK(play.has_value());
        return std::move(*play);
    }
    /// A frame of the performance, seen by a tracker that makes no errors.
    static void play_frame(DemoPlay& play, double t, const std::vector<GestureEvent>& gestures) {
        const BodyFrame bodies{from_seconds(t), person().bodies_at(t)};
        play.step({.dt_s = kFrameS,
                   .time = bodies.time,
                   .bodies = &bodies,
                   .gestures = gestures,
                   .world_from_depth = person().world_from_depth,
                   .middle_m = {0, 1, -3}});
    }
    static GestureEvent gesture(GestureKind kind, GesturePhase phase, Hand hand, double t,
                                double value) {
        return {.kind = kind,
                .phase = phase,
                .hand = hand,
                .body_id = 1,
                .primary = true,
                .time = from_seconds(t),
                .start_time = from_seconds(t - 0.3),
                .confidence = 1,
                .value = value};
    }
    /// Pixels that differ, of pictures with guidance or without.
    int difference(DemoPlay& a, DemoPlay& b, bool guided) {
        std::array<Image<Rgba8>, 2> pictures;
        std::array<DemoPlay*, 2> plays = {&a, &b};
        for (std::size_t i = 0; i < 2; ++i) {
            const View view = plays[i]->view(kWidth, kHeight);
            const Scene& scene = plays[i]->scene();
            FrameOptions options;
            options.read_picture = true;
            std::unique_ptr<ScreenPainter> painter;
            if (guided) {
                painter = *ScreenPainter::create(device(), nullptr, kHeight);
                ShowScreen screen;
                screen.guidance = {&plays[i]->guidance(), nullptr};
                painter->prepare(screen, view, kFrameS, options);
            }
            auto drawn = renderer().render_to_image(scene, view, options);
            KINO_CHECK(drawn.has_value());
            pictures[i] = std::move(drawn->picture);
        }
        int count = 0;
        for (std::size_t i = 0; i < pictures[0].pixels().size(); ++i) {
            count += pictures[0].pixels()[i] == pictures[1].pixels()[i] ? 0 : 1;
        }
        return count;
    }
    static Renderer& renderer() {
        static Renderer renderer(device());
        return renderer;
    }

    /// Plays the second before the cue at `t`, then it; frames until pictures differ.
    int frames_until_seen(GestureKind kind, GesturePhase phase, Hand hand, double t, double value,
                          bool guided) {
        DemoPlay with = new_play(), without = new_play();
        const int first = static_cast<int>((t - 0.5) / kFrameS);
        const int told = static_cast<int>(t / kFrameS);
        for (int frame = first; frame < told + 6; ++frame) {
            const double now = frame * kFrameS;
            std::vector<GestureEvent> both, one;
            if (frame == first) {
                both.push_back(
                    gesture(GestureKind::engaged, GesturePhase::once, Hand::right, now, 0));
            }
            one = both;
            if (frame == told) one.push_back(gesture(kind, phase, hand, now, value));
            play_frame(with, now, one);
            play_frame(without, now, both);
            if (frame == told - 1) {
                EXPECT_EQ(difference(with, without, guided), 0);
            }
            if (frame >= told && difference(with, without, guided) > 0) return frame - told;
        }
        return 1000;
    }
};

TEST_F(Response, EveryGestureIsInThePictureOfItsOwnFrame) {
    const double t = kEngagedS + 16.4;  // a push of the performance, so that there is a ball
    const std::array all = {
        std::tuple{GestureKind::swipe_left, GesturePhase::once, Hand::right},
        std::tuple{GestureKind::swipe_up, GesturePhase::once, Hand::right},
        std::tuple{GestureKind::push, GesturePhase::once, Hand::right},
        std::tuple{GestureKind::raise, GesturePhase::once, Hand::right},
        std::tuple{GestureKind::raise_both, GesturePhase::once, Hand::both},
        std::tuple{GestureKind::zoom, GesturePhase::begin, Hand::both},
        std::tuple{GestureKind::rotate, GesturePhase::begin, Hand::both},
        std::tuple{GestureKind::t_pose, GesturePhase::once, Hand::both},
    };
    for (const auto& [kind, phase, hand] : all) {
        const double value = kind == GestureKind::zoom ? 1.3 : 0.5;
        EXPECT_EQ(frames_until_seen(kind, phase, hand, t, value, true), 0) << gesture_name(kind);
    }
}

TEST_F(Response, WhatTheyDoToTheStageIsSeenAFrameLaterAtMost) {
    const double t = kEngagedS + 16.4;
    const std::array all = {
        std::tuple{GestureKind::swipe_left, GesturePhase::once, Hand::right},
        std::tuple{GestureKind::swipe_up, GesturePhase::once, Hand::right},
        std::tuple{GestureKind::push, GesturePhase::once, Hand::right},
        std::tuple{GestureKind::raise_both, GesturePhase::once, Hand::both},
    };
    for (const auto& [kind, phase, hand] : all) {
        const int frames = frames_until_seen(kind, phase, hand, t, 1, false);
        RecordProperty(std::string(gesture_name(kind)), frames);
        EXPECT_LE(frames, 1) << gesture_name(kind);
    }
}

TEST_F(Response, AScreenWithNothingOnItHasNoPass) {
    const auto painter = ScreenPainter::create(device(), nullptr, kHeight);
    ASSERT_TRUE(painter);
    const View view{.width = kWidth,
                    .height = kHeight,
                    .projection = perspective(0.8, kWidth, kHeight),
                    .world_from_view = look_at({0, 1, 3}, {0, 1, 0})};
    FrameOptions options;
    (*painter)->prepare({}, view, kFrameS, options);
    EXPECT_FALSE(options.overlay);
    ShowScreen screen;
    screen.banner = "step in front of the sensor";
    (*painter)->prepare(screen, view, kFrameS, options);
    EXPECT_TRUE(options.overlay);
    options.read_picture = true;
    const auto drawn = renderer().render_to_image(Scene{}, view, options);
    ASSERT_TRUE(drawn);
    EXPECT_TRUE((*painter)->result());
}

}  // namespace
}  // namespace kino
