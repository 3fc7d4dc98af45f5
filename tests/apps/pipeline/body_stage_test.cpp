#include "apps/pipeline/body_stage.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <thread>

#include "apps/pipeline/live_runner.h"
#include "apps/pipeline/stepper.h"
#include "counting_source.h"
#include "sensor/session/session_source.h"
#include "skeleton/gestures/gesture_json.h"
#include "skeleton/synthetic/synthetic_source.h"
#include "tests/support/temp_dir.h"

namespace kino {
namespace {

using test::CountingSource;
using test::TempDir;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

constexpr TimeNs kBodyPatience = 60 * kNsPerSecond;

std::unique_ptr<Source> synthetic(Motion motion) {
    auto source = SyntheticSource::create(make_scene(motion, 64, 48));
    KINO_CHECK(source.has_value());
    return std::move(*source);
}

OpenedSource prepared(std::unique_ptr<Source> source, BodyMode mode,
                      LoopMode loop = LoopMode::once) {
    auto opened = prepare_for_playing(std::move(source), {.mode = loop, .bodies = {.mode = mode}});
    KINO_CHECK(opened.has_value());
    return std::move(*opened);
}

/// Finds one person, whose number is how often it was asked.
struct CountingFinder {
    std::shared_ptr<std::vector<TimeNs>> asked = std::make_shared<std::vector<TimeNs>>();
    BodyFinder finder() const {
        return [asked = asked](const Image<float>&, TimeNs time, const std::optional<glm::vec3>&,
                               BodyFrame& out) {
            asked->push_back(time);
            out.bodies.resize(1);
            out.bodies[0].id = static_cast<std::uint32_t>(asked->size());
            return TrackingTimes{.people = 7};
        };
    }
};

ProcessedFrame frame_at(std::int64_t index) {
    ProcessedFrame frame;
    frame.set.index = index;
    frame.set.time = index * kNsPerSecond / 30;
    frame.surface = std::make_shared<DepthSurface>();
    return frame;
}

TEST(BodyStage, BackwardsAndAgainShowsWhatWasFound) {
    const CountingFinder counting;
    BodyStage stage(counting.finder(), std::nullopt, {});
    const auto id_at = [&](std::int64_t index) {
        ProcessedFrame frame = frame_at(index);
        stage.process(frame);
        return frame.set.bodies->bodies.at(0).id;
    };
    EXPECT_EQ(id_at(3), 1u);
    EXPECT_EQ(id_at(4), 2u);
    EXPECT_EQ(id_at(6), 3u);  // 5 was passed over
    EXPECT_EQ(id_at(6), 3u);
    EXPECT_EQ(id_at(5), 2u);
    EXPECT_EQ(id_at(3), 1u);
    EXPECT_EQ(id_at(6), 3u);
    EXPECT_EQ(id_at(7), 4u);
    EXPECT_EQ(id_at(2), 5u) << "from before the beginning everything is new";
    EXPECT_EQ(id_at(3), 6u);
    EXPECT_EQ(id_at(300), 7u);
    EXPECT_EQ(id_at(3), 8u) << "a loop starts anew";
}

TEST(BodyStage, WithoutDepthThereIsNobody) {
    const CountingFinder counting;
    BodyStage stage(counting.finder(), std::nullopt, {});
    ProcessedFrame frame = frame_at(0);
    frame.surface.reset();
    stage.process(frame);
    ASSERT_TRUE(frame.set.bodies);
    EXPECT_THAT(frame.set.bodies->bodies, IsEmpty());
    EXPECT_THAT(*counting.asked, IsEmpty());
    EXPECT_FALSE(frame.tracking);
    frame = frame_at(1);
    stage.process(frame);
    ASSERT_TRUE(frame.tracking);
    EXPECT_EQ(frame.tracking->people, 7);
    EXPECT_TRUE(frame.bodies_are_new);
}

TEST(BodyStage, WhatCannotBeHadIsNamed) {
    const TempDir temp;
    const auto problem = [&](BodyOptions options) {
        const auto opened = prepare_for_playing(synthetic(Motion::idle), {.bodies = options});
        return opened ? std::string() : opened.error().to_string();
    };
    EXPECT_EQ(problem({}), "");
    EXPECT_EQ(problem({.mode = BodyMode::recorded}), "");
    EXPECT_THAT(problem({.mode = BodyMode::on, .forest = temp / "none.forest"}),
                testing::AllOf(testing::HasSubstr("bodies cannot be tracked"),
                               testing::HasSubstr("none.forest")));
    EXPECT_THAT(problem({.mode = BodyMode::recorded, .gestures = temp / "none.json"}),
                testing::HasSubstr("none.json"));
    // It has no end.
    EXPECT_THAT(problem({.mode = BodyMode::recorded, .gestures = "/dev/zero"}),
                testing::HasSubstr("not a regular file"));
    const std::string wrong = temp.write("wrong.json", R"({"kinoscope_gestures": 1, "yawn": {}})");
    EXPECT_THAT(problem({.mode = BodyMode::recorded, .gestures = wrong}),
                testing::HasSubstr("yawn"));
    EXPECT_THAT(problem({.mode = BodyMode::recorded, .joint_filter = "magic"}),
                testing::HasSubstr("magic"));
}

TEST(BodyStage, ARecordingMaySayThatItsPeopleSit) {
    const PlayOptions play{.bodies = {.mode = BodyMode::on}};
    const auto person = open_for_playing("recordings/person", play);
    ASSERT_TRUE(person) << person.error().to_string();
    EXPECT_TRUE(person->body_options.seated);
    const auto desk = open_for_playing("recordings/desk", play);
    ASSERT_TRUE(desk) << desk.error().to_string();
    EXPECT_FALSE(desk->body_options.seated);
}

std::vector<GestureEvent> gestures_of(std::unique_ptr<Source> source, BodyMode mode) {
    Stepper stepper(prepared(std::move(source), mode));
    std::vector<GestureEvent> out;
    for (;;) {
        auto frame = stepper.next();
        KINO_CHECK(frame.has_value());
        if (!*frame) return out;
        for (const GestureEvent& event : (*frame)->gestures) {
            EXPECT_EQ(event.time, (*frame)->set.time);
            out.push_back(event);
        }
    }
}

TEST(Bodies, GesturesOfRecordedBodies) {
    const auto events = gestures_of(synthetic(Motion::wave), BodyMode::recorded);
    ASSERT_THAT(events, SizeIs(2));
    EXPECT_EQ(events[0].kind, GestureKind::wave);
    EXPECT_EQ(events[1].kind, GestureKind::engaged);
    EXPECT_THAT(gestures_of(synthetic(Motion::wave), BodyMode::off), IsEmpty());
}

/// What a runner has recorded of `motion`, with what it told meanwhile.
std::vector<GestureEvent> record_with_runner(Motion motion, const std::string& file) {
    auto clock = std::make_shared<std::atomic<TimeNs>>(1);
    LiveRunner runner(prepared(synthetic(motion), BodyMode::recorded),
                      {.clock = [clock] { return clock->load(); }});
    EXPECT_TRUE(runner.status().bodies);
    EXPECT_TRUE(runner.wait(kBodyPatience));
    EXPECT_TRUE(runner.start_recording(file, SessionCodec::raw));
    for (int i = 1; i < SyntheticSource::kFrames; ++i) {
        clock->fetch_add(kNsPerSecond / 30 + 1);
        EXPECT_TRUE(runner.wait(kBodyPatience)) << i;
    }
    runner.stop();
    const LiveStatus status = runner.status();
    EXPECT_EQ(status.recording->error, "");
    EXPECT_EQ(status.recording->dropped, 0);
    return runner.take_gestures();
}

TEST(Bodies, ARecordingHasThemAndTheirGesturesAndGivesThemBack) {
    const TempDir temp;
    const std::string file = temp / "push.mkv";
    const auto told = record_with_runner(Motion::push, file);
    ASSERT_THAT(told, SizeIs(3));
    auto reader = SessionReader::open(file);
    ASSERT_TRUE(reader.has_value());
    std::vector<GestureEvent> written;
    for (const SessionEvent& event : (*reader)->events()) {
        if (event.kind != "gesture") continue;
        written.push_back(*gesture_event_from_json(event.detail, "x"));
        EXPECT_EQ(event.text, gesture_text(written.back()));
    }
    EXPECT_EQ(written, told);
    // The bodies are those of the source, each once, from the frame after the first on.
    std::size_t bodies = 0;
    const auto source = synthetic(Motion::push);
    ASSERT_TRUE(source->subscribe({0, StreamKind::bodies}));
    ASSERT_TRUE(source->next(0).has_value());
    for (const SessionEntry& entry : (*reader)->frames()) {
        if (entry.id.kind != StreamKind::bodies) continue;
        const auto frame = (*reader)->read(entry);
        ASSERT_TRUE(frame.has_value());
        const auto& read = *std::get<std::shared_ptr<const BodyFrame>>(*frame);
        const auto set = source->next(0);
        ASSERT_TRUE(set && *set && (*set)->bodies);
        EXPECT_EQ(read.time, (*set)->time);
        ASSERT_EQ(read.bodies.size(), (*set)->bodies->bodies.size());
        for (std::size_t j = 0; j < kJointCount; ++j) {
            const JointPosition& joint = read.bodies[0].joints[j];
            const JointPosition& given = (*set)->bodies->bodies[0].joints[j];
            EXPECT_EQ(joint.position_m, given.position_m);
            EXPECT_EQ(joint.state, given.state);
            EXPECT_EQ(joint.confidence, given.confidence);
        }
        ++bodies;
    }
    EXPECT_EQ(bodies, static_cast<std::size_t>(SyntheticSource::kFrames - 1));

    const auto open = [&] {
        auto again = SessionReader::open(file);
        KINO_CHECK(again.has_value());
        auto made = make_session_source(std::move(*again), file);
        KINO_CHECK(made.has_value());
        return std::move(*made);
    };
    EXPECT_EQ(gestures_of(open(), BodyMode::off), told) << "as they were recorded";
    EXPECT_EQ(gestures_of(open(), BodyMode::recorded), told) << "recognised anew, told once";
}

TEST(Bodies, AreSwitchedOnAndOffWhilePlaying) {
    auto clock = std::make_shared<std::atomic<TimeNs>>(1);
    const TempDir temp;
    auto opened =
        prepare_for_playing(synthetic(Motion::idle),
                            {.mode = LoopMode::once, .bodies = {.forest = temp / "none.forest"}});
    ASSERT_TRUE(opened.has_value());
    LiveRunner runner(std::move(*opened), {.clock = [clock] { return clock->load(); }});
    ASSERT_TRUE(runner.wait(kBodyPatience));
    EXPECT_FALSE(runner.status().bodies);
    runner.set_bodies(true);
    ASSERT_TRUE(runner.wait(kBodyPatience)) << "the frame is made again in a pause of the clock";
    EXPECT_THAT(runner.status().bodies_error, testing::HasSubstr("none.forest"));
    EXPECT_FALSE(runner.status().bodies);
    clock->fetch_add(kNsPerSecond / 30 + 1);
    const auto frame = runner.wait(kBodyPatience);
    ASSERT_TRUE(frame) << "playing goes on";
    EXPECT_FALSE(frame->bodies_are_new);
}

}  // namespace
}  // namespace kino
