#include <gtest/gtest.h>

#include "base/check.h"
#include "logged_file.h"
#include "sensor/session/session_source.h"
#include "session_frames.h"

/// Seeking and stepping are exact: a frame is the same however one came to it.
namespace kino {
namespace {

using test::frames_between;

std::unique_ptr<Source> source_over(const std::vector<std::uint8_t>& bytes) {
    auto source = make_session_source(test::reader_of(bytes), "x");
    KINO_CHECK(source.has_value());
    KINO_CHECK(subscribe_all(**source).has_value());
    return *std::move(source);
}

bool same_sets(const FrameSet& a, const FrameSet& b) {
    return a.index == b.index && a.time == b.time && test::equal(a.depth, b.depth) &&
           test::equal(a.color, b.color) && test::equal(a.infrared, b.infrared) &&
           test::equal(a.motion, b.motion) && test::equal(a.bodies, b.bodies) &&
           a.color_paired == b.color_paired;
}

TEST(SessionTimeline, EverySetIsWholeAndPaired) {
    const auto frames = frames_between(0, 40);
    const auto bytes = test::session_of(frames);
    const auto source = source_over(bytes);
    ASSERT_EQ(source->timeline()->frame_count(), 40);
    EXPECT_EQ(source->info().streams.size(), 5U);
    for (int i = 0; i < 40; ++i) {
        const auto set = source->next(0);
        ASSERT_TRUE(set && *set);
        const auto put = test::frames_at(i);
        EXPECT_TRUE(test::equal((*set)->depth, put[0].frame));
        EXPECT_TRUE(test::equal((*set)->color, put[1].frame));
        EXPECT_TRUE(test::equal((*set)->infrared, put[2].frame));
        EXPECT_TRUE(test::equal((*set)->motion, put[3].frame));
        EXPECT_TRUE(test::equal((*set)->bodies, put[4].frame));
        EXPECT_TRUE((*set)->color_paired);
        EXPECT_EQ((*set)->time, (*set)->depth->header.host_time);
    }
    EXPECT_FALSE(*source->next(0));
    const auto events = source->take_events();
    ASSERT_EQ(events.size(), 2U);
    EXPECT_EQ(events[0].kind, EventKind::started);
    EXPECT_EQ(events[1].kind, EventKind::ended);
}

TEST(SessionTimeline, SeekThenNextEqualsPlayingThere) {
    const auto bytes = test::session_of(frames_between(0, 45));
    const auto source = source_over(bytes);
    Timeline& timeline = *source->timeline();
    std::vector<FrameSet> played;
    while (true) {
        auto set = source->next(0);
        ASSERT_TRUE(set.has_value());
        if (!*set) break;
        played.push_back(**set);
    }
    ASSERT_EQ(played.size(), 45U);
    test::Random random(3);
    for (int jump = 0; jump < 100; ++jump) {
        const int to = random.integer(0, 44);
        ASSERT_TRUE(timeline.seek(to).has_value());
        EXPECT_EQ(timeline.position(), to);
        const auto set = source->next(0);
        ASSERT_TRUE(set && *set);
        EXPECT_TRUE(same_sets(**set, played[static_cast<std::size_t>(to)]));
    }
    for (std::int64_t i = 44; i >= 0; --i) {
        ASSERT_TRUE(timeline.seek(i).has_value());
        const auto set = source->next(0);
        ASSERT_TRUE(set && *set);
        EXPECT_TRUE(same_sets(**set, played[static_cast<std::size_t>(i)]));
        EXPECT_EQ(timeline.position(), i + 1);
    }
}

TEST(SessionTimeline, OutsideIsAnErrorThatMovesNothing) {
    const auto bytes = test::session_of(frames_between(0, 5));
    const auto source = source_over(bytes);
    ASSERT_TRUE(source->timeline()->seek(3).has_value());
    EXPECT_FALSE(source->timeline()->seek(-1).has_value());
    EXPECT_FALSE(source->timeline()->seek(5).has_value());
    EXPECT_EQ(source->timeline()->position(), 3);
}

TEST(SessionTimeline, TimesRiseWhateverTheOrderOfTheFile) {
    auto frames = frames_between(0, 20);
    std::swap(frames[10], frames[60]);
    std::swap(frames[0], frames[35]);
    frames.push_back(frames[5]);  // the same moment twice
    const auto bytes = test::session_of(frames);
    const auto source = source_over(bytes);
    const Timeline& timeline = *source->timeline();
    EXPECT_EQ(timeline.frame_count(), 21);
    EXPECT_EQ(timeline.time_of(0), 0);
    for (std::int64_t i = 1; i < timeline.frame_count(); ++i) {
        EXPECT_GT(timeline.time_of(i), timeline.time_of(i - 1));
    }
}

TEST(SessionTimeline, UnsubscribedStreamsAreNull) {
    const auto bytes = test::session_of(frames_between(0, 3));
    const auto source = make_session_source(test::reader_of(bytes), "x");
    ASSERT_TRUE(source.has_value());
    ASSERT_TRUE((*source)->subscribe({0, StreamKind::color}).has_value());
    EXPECT_FALSE((*source)->subscribe({1, StreamKind::color}).has_value());
    const auto set = (*source)->next(0);
    ASSERT_TRUE(set && *set);
    EXPECT_EQ((*set)->depth, nullptr);
    EXPECT_NE((*set)->color, nullptr);
}

TEST(SessionTimeline, WithoutDepthTheInfraredLeads) {
    auto frames = frames_between(0, 4);
    std::erase_if(frames,
                  [](const test::PutFrame& put) { return put.id.kind == StreamKind::depth; });
    const auto bytes = test::session_of(frames);
    const auto source = source_over(bytes);
    EXPECT_EQ(source->timeline()->frame_count(), 4);
    EXPECT_EQ(source->info().streams.front().id.kind, StreamKind::infrared);
}

TEST(SessionTimeline, LostAndBackComeAgainWhenTheyArePassed) {
    test::FileLog log;
    SessionWriter writer(std::make_unique<test::LoggedFile>(log), test::source_of(), test::rig_of(),
                         {}, 0);
    const auto frames = frames_between(0, 6);
    ASSERT_TRUE(test::write_all(writer, frames).has_value());
    const TimeNs third = std::get<0>(frames[10].frame)->header.host_time;
    ASSERT_TRUE(
        writer.put_event({.kind = "lost", .time = third + 1, .text = "gone"}, 0).has_value());
    ASSERT_TRUE(writer.finish(0).has_value());
    const auto source = source_over(log.content);
    for (int i = 0; i < 3; ++i) ASSERT_TRUE(source->next(0).has_value());
    EXPECT_EQ(source->take_events().size(), 1U);
    ASSERT_TRUE(source->next(0).has_value());
    const auto events = source->take_events();
    ASSERT_EQ(events.size(), 1U);
    EXPECT_EQ(events[0].kind, EventKind::lost);
    EXPECT_EQ(events[0].text, "gone");
}

TEST(SessionTimeline, GesturesComeAgainWithTheirFrame) {
    test::FileLog log;
    SessionWriter writer(std::make_unique<test::LoggedFile>(log), test::source_of(), test::rig_of(),
                         {}, 0);
    ASSERT_TRUE(test::write_all(writer, frames_between(0, 4)).has_value());
    const auto bytes_before = test::session_of(frames_between(0, 4));
    const auto source_before = source_over(bytes_before);
    TimeNs third = 0;
    for (int i = 0; i < 3; ++i) third = (*source_before->next(0))->time;
    const std::string detail = R"({"body":1,"gesture":"push"})";
    ASSERT_TRUE(
        writer.put_event({.kind = "gesture", .time = third, .text = "push", .detail = detail}, 0)
            .has_value());
    ASSERT_TRUE(writer.finish(0).has_value());
    const auto source = source_over(log.content);
    for (int i = 0; i < 2; ++i) ASSERT_TRUE(source->next(0).has_value());
    EXPECT_EQ(source->take_events().size(), 1U);
    for (int round = 0; round < 2; ++round) {  // after a jump back, too
        ASSERT_TRUE(source->timeline()->seek(2).has_value());
        ASSERT_TRUE(source->next(0).has_value());
        const auto events = source->take_events();
        ASSERT_EQ(events.size(), 1U);
        EXPECT_EQ(events[0].kind, EventKind::gesture);
        EXPECT_EQ(events[0].time, third);
        EXPECT_EQ(events[0].detail, detail);
    }
}

void put_session(const test::TempDir& dir, std::string_view name) {
    const auto bytes = test::session_of(frames_between(0, 3));
    dir.write(name, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

TEST(SessionFolder, OpensTheOnlySessionInIt) {
    const test::TempDir dir;
    put_session(dir, "visit.mkv");
    dir.write("notes.txt", "a word");
    dir.write("film.mkv", "no session");
    const SourceOpener opener = session_folder_opener();
    ASSERT_TRUE(opener.probe(dir.path().string()));
    const auto source = opener.open(dir.path().string());
    ASSERT_TRUE(source.has_value()) << source.error().to_string();
    EXPECT_EQ((*source)->timeline()->frame_count(), 3);
    EXPECT_EQ((*source)->info().uri, (dir / "visit.mkv").string());
}

TEST(SessionFolder, OfSeveralSaysWhichThereAre) {
    const test::TempDir dir;
    put_session(dir, "second.mkv");
    put_session(dir, "first.mkv");
    ASSERT_TRUE(session_folder_opener().probe(dir.path().string()));
    const auto source = session_folder_opener().open(dir.path().string());
    ASSERT_FALSE(source.has_value());
    EXPECT_NE(source.error().to_string().find("2 sessions: first.mkv, second.mkv"),
              std::string::npos)
        << source.error().to_string();
}

TEST(SessionFolder, LeavesOtherFoldersToOthers) {
    const test::TempDir dir;
    EXPECT_FALSE(session_folder_opener().probe(dir.path().string())) << "empty";
    EXPECT_FALSE(session_folder_opener().probe((dir / "none").string()));
    put_session(dir, "visit.mkv");
    EXPECT_FALSE(session_folder_opener().probe((dir / "visit.mkv").string())) << "a file";
    dir.write("kinoscope.json", "{}");
    EXPECT_FALSE(session_folder_opener().probe(dir.path().string())) << "a described folder";
}

}  // namespace
}  // namespace kino
