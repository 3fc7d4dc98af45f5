#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <string>
#include <vector>

#include "apps/pipeline/stepper.h"
#include "sensor/session/session_source.h"
#include "skeleton/synthetic/performance.h"
#include "skeleton/synthetic/synthetic_source.h"

/// The performance that the demo plays while nobody is there: what is written in its script is what
/// the tracker and the recogniser make of its noisy depth.
namespace kino {
namespace {

constexpr double kToleranceS = 0.5;

std::string phase_word(GesturePhase phase) {
    return phase == GesturePhase::begin ? "begin" : phase == GesturePhase::end ? "end" : "once";
}

std::string line_of(double time_s, std::string_view gesture, std::string_view phase,
                    std::string_view hand) {
    return fmt::format("{:6.2f} {} {} {}", time_s, gesture, phase, hand);
}

struct Seen {
    std::vector<GestureEvent> gestures;  ///< without changes
    std::set<std::uint32_t> ids;
    int frames = 0, frames_with_one = 0, frames_with_more = 0;

    [[nodiscard]] std::string log() const {
        std::string out;
        for (const GestureEvent& g : gestures) {
            out += line_of(to_seconds(g.time), gesture_name(g.kind), phase_word(g.phase),
                           hand_name(g.hand)) +
                   "\n";
        }
        return out;
    }
};

Seen watch(OpenedSource opened) {
    Stepper stepper(std::move(opened));
    Seen seen;
    for (std::int64_t i = 0; i < stepper.round(); ++i) {
        const auto frame = stepper.next();
        KINO_CHECK(frame && *frame);
        ++seen.frames;
        const BodyFrame& bodies = *(*frame)->set.bodies;
        seen.frames_with_one += bodies.bodies.size() == 1 ? 1 : 0;
        seen.frames_with_more += bodies.bodies.size() > 1 ? 1 : 0;
        for (const Body& body : bodies.bodies) seen.ids.insert(body.id);
        for (const GestureEvent& event : (*frame)->gestures) {
            if (event.phase != GesturePhase::change) seen.gestures.push_back(event);
        }
    }
    return seen;
}

void expect_the_script(const Seen& seen) {
    const auto script = performance_script();
    ASSERT_EQ(seen.gestures.size(), script.size()) << seen.log();
    for (std::size_t i = 0; i < script.size(); ++i) {
        const GestureEvent& g = seen.gestures[i];
        EXPECT_EQ(gesture_name(g.kind), script[i].gesture) << seen.log();
        EXPECT_EQ(phase_word(g.phase), script[i].phase) << script[i].gesture;
        EXPECT_EQ(hand_name(g.hand), script[i].hand) << script[i].gesture;
        EXPECT_NEAR(to_seconds(g.time), script[i].time_s, kToleranceS) << script[i].gesture;
    }
    // One person all the time, from the way in to the way out.
    EXPECT_EQ(seen.ids.size(), 1u);
    EXPECT_EQ(seen.frames_with_more, 0);
    EXPECT_GT(seen.frames_with_one, seen.frames * 85 / 100);
}

PlayOptions tracked() {
    return {.mode = LoopMode::once, .bodies = {.mode = BodyMode::on}};
}

TEST(Performance, ScriptIsInOrderAndOfKnownGestures) {
    double before = 0;
    std::set<std::string_view> kinds;
    for (const Cue& cue : performance_script()) {
        EXPECT_GE(cue.time_s, before);
        EXPECT_LT(cue.time_s, kPerformanceSeconds);
        EXPECT_TRUE(gesture_from_name(cue.gesture)) << cue.gesture;
        before = cue.time_s;
        kinds.insert(cue.gesture);
    }
    // All but dwell and learned ones, which the demo has no use for.
    EXPECT_EQ(kinds.size(), kGestureKindCount - 2);
}

TEST(Performance, TheRecordingIsRecognisedAsWritten) {
    register_source(session_opener());
    auto opened = open_for_playing("recordings/performance/performance.mkv", tracked());
    ASSERT_TRUE(opened) << opened.error().to_string();
    expect_the_script(watch(std::move(*opened)));
}

TEST(Performance, TheRecordingIsTheComputedOne) {
    auto recorded = session_opener().open("recordings/performance/performance.mkv");
    auto computed = SyntheticSource::create(make_performance(320, 240));
    ASSERT_TRUE(recorded && computed);
    for (Source* source : {recorded->get(), static_cast<Source*>(computed->get())}) {
        ASSERT_TRUE(source->subscribe({0, StreamKind::depth}));
    }
    ASSERT_EQ((*recorded)->timeline()->frame_count(), (*computed)->timeline()->frame_count());
    for (const std::int64_t index : {0, 50, 400, 1300}) {
        std::vector<Image<std::uint16_t>> raw;
        for (Source* source : {recorded->get(), static_cast<Source*>(computed->get())}) {
            ASSERT_TRUE(source->timeline()->seek(index));
            const auto set = source->next(kNsPerSecond);
            ASSERT_TRUE(set && *set && (*set)->depth);
            raw.push_back((*set)->depth->raw);
        }
        EXPECT_EQ(raw[0], raw[1]) << index;
    }
}

}  // namespace
}  // namespace kino
