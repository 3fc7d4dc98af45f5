#include <gtest/gtest.h>

#include <algorithm>

#include "logged_file.h"
#include "sensor/session/session_source.h"
#include "session_frames.h"

/// What is put into a session comes out of it, bit by bit.
namespace kino {
namespace {

using test::count_exact;
using test::frames_between;
using test::FrameStyle;
using test::PutFrame;
using test::reader_of;
using test::session_of;

class EveryCodec : public testing::TestWithParam<SessionCodec> {};

TEST_P(EveryCodec, EveryStreamComesBackBitByBit) {
    const auto frames = frames_between(0, 40);
    RecorderOptions options;
    options.codec = GetParam();
    const auto bytes = session_of(frames, options);
    const auto reader = reader_of(bytes);
    EXPECT_EQ(count_exact(*reader, frames), static_cast<int>(frames.size()));
    EXPECT_TRUE(reader->index().closed);
    EXPECT_TRUE(reader->index().findings.empty());
    EXPECT_EQ(reader->index().rig, test::rig_of());
    EXPECT_EQ(reader->index().source.name, test::source_of().name);
    EXPECT_EQ(reader->index().source.licence, "CC0");
}

INSTANTIATE_TEST_SUITE_P(Codecs, EveryCodec,
                         testing::Values(SessionCodec::ffv1, SessionCodec::fast, SessionCodec::rvl,
                                         SessionCodec::raw));

class EveryPixelFormat : public testing::TestWithParam<std::tuple<PixelFormat, SessionCodec>> {};

TEST_P(EveryPixelFormat, ComesBackBitByBit) {
    const auto [format, codec] = GetParam();
    FrameStyle style;
    style.color = format;
    style.infrared = style.texts = false;
    for (const int width : {48, 46}) {
        style.width = width;
        const auto frames = frames_between(0, 6, style);
        RecorderOptions options;
        options.codec = codec;
        const auto reader_bytes = session_of(frames, options, style);
        const auto reader = reader_of(reader_bytes);
        EXPECT_EQ(count_exact(*reader, frames), 12);
    }
}

INSTANTIATE_TEST_SUITE_P(
    Formats, EveryPixelFormat,
    testing::Combine(testing::Values(PixelFormat::rgba8, PixelFormat::rgb8, PixelFormat::gray8,
                                     PixelFormat::bayer_grbg8, PixelFormat::uyvy, PixelFormat::yuyv,
                                     PixelFormat::mjpeg),
                     testing::Values(SessionCodec::ffv1, SessionCodec::fast, SessionCodec::raw)));

TEST(RoundTrip, LinearDepthKeepsItsUnit) {
    auto frame = std::make_shared<DepthFrame>();
    frame->raw = Image<std::uint16_t>(20, 10, 65535);
    frame->metres_per_unit = 0.1 / 3;
    const std::vector<PutFrame> frames = {{{0, StreamKind::depth}, frame}};
    const auto bytes = session_of(frames);
    const auto reader = reader_of(bytes);
    EXPECT_EQ(count_exact(*reader, frames), 1);
}

TEST(RoundTrip, FramesThatFitNoTrackComeBackAsWell) {
    auto frames = frames_between(0, 5);
    // The camera is switched to another size and format in the middle of the recording, and a
    // second device joins in.
    FrameStyle other;
    other.width = 64;
    other.height = 50;
    other.color = PixelFormat::uyvy;
    for (const PutFrame& frame : frames_between(5, 9, other)) frames.push_back(frame);
    auto second = test::frames_at(9);
    frames.push_back({{1, StreamKind::depth}, second[0].frame});
    const auto bytes = session_of(frames);
    const auto reader = reader_of(bytes);
    EXPECT_EQ(count_exact(*reader, frames), static_cast<int>(frames.size()));
}

TEST(RoundTrip, ExtremeTimesAndNumbersInTheHeaders) {
    std::vector<PutFrame> frames;
    std::int64_t sequence = 0;
    for (const TimeNs time : {TimeNs{0}, TimeNs{-5'000'000'000}, TimeNs{1} << 61, TimeNs{7},
                              -(TimeNs{1} << 61), TimeNs{7}}) {
        auto frame = std::make_shared<DepthFrame>();
        frame->header = {time - 3, time, ++sequence, INT64_MAX};
        frame->raw = Image<std::uint16_t>(8, 8, static_cast<std::uint16_t>(sequence));
        frames.push_back({{0, StreamKind::depth}, frame});
    }
    const auto bytes = session_of(frames);
    const auto reader = reader_of(bytes);
    EXPECT_EQ(count_exact(*reader, frames), 6);
    const auto source = make_session_source(reader_of(bytes), "x");
    ASSERT_TRUE(source.has_value());
    Timeline& timeline = *(*source)->timeline();
    for (std::int64_t i = 1; i < timeline.frame_count(); ++i) {
        EXPECT_GT(timeline.time_of(i), timeline.time_of(i - 1));
    }
}

TEST(RoundTrip, UnsoundFramesAreToldNotWritten) {
    auto frames = frames_between(0, 4);
    auto broken =
        std::make_shared<ColorFrame>(*std::get<std::shared_ptr<const ColorFrame>>(frames[1].frame));
    broken->bytes.resize(10);
    auto with_broken = frames;
    with_broken.push_back({{0, StreamKind::color}, broken});
    auto empty = std::make_shared<DepthFrame>();
    with_broken.push_back({{0, StreamKind::depth}, empty});
    const auto bytes = session_of(with_broken);
    const auto reader = reader_of(bytes);
    EXPECT_EQ(count_exact(*reader, frames), static_cast<int>(frames.size()));
    ASSERT_EQ(reader->events().size(), 2U);
    EXPECT_EQ(reader->events()[0].kind, "refused");
    EXPECT_EQ(reader->events()[0].stream, (StreamId{0, StreamKind::color}));
    EXPECT_EQ(reader->events()[1].stream, (StreamId{0, StreamKind::depth}));
}

TEST(RoundTrip, EventsAndPosesKeepTheirWords) {
    test::FileLog log;
    SessionWriter writer(std::make_unique<test::LoggedFile>(log), test::source_of(), test::rig_of(),
                         {}, 0);
    const SessionEvent lost{.kind = "lost", .time = 123, .text = "unplugged: \"\xC3\xBC\"\n"};
    const SessionEvent bad{.kind = "back", .time = 456, .text = "not \xFF UTF-8"};
    const SessionEvent gesture{.kind = "gesture",
                               .time = 457,
                               .text = "wave",
                               .detail = R"({"body":2,"gesture":"wave","value":-0.0,"x":0.1})"};
    const SessionPose pose{98'765'432'101'251,
                           {glm::dquat(0.6, 0, 0.8, 0), {1.0 / 3, -0.0, 1e-300}}};
    ASSERT_TRUE(writer.put_event(lost, 1).has_value());
    ASSERT_TRUE(writer.put_pose(pose, 1).has_value());
    ASSERT_TRUE(test::write_all(writer, frames_between(0, 2)).has_value());
    ASSERT_TRUE(writer.put_event(bad, 2).has_value());
    ASSERT_TRUE(writer.put_event(gesture, 2).has_value());
    ASSERT_TRUE(writer.finish(3).has_value());
    const auto reader = reader_of(log.content);
    ASSERT_EQ(reader->events().size(), 3U);
    EXPECT_EQ(reader->events()[2], gesture);
    EXPECT_EQ(reader->events()[0], lost);
    EXPECT_EQ(reader->events()[1].text, "not \xEF\xBF\xBD UTF-8");
    ASSERT_EQ(reader->poses().size(), 1U);
    EXPECT_EQ(reader->poses()[0].world_from_depth, pose.world_from_depth);

    const auto source = make_session_source(reader_of(log.content), "x");
    ASSERT_TRUE(source.has_value());
    const auto set = (*source)->next(0);
    ASSERT_TRUE(set && *set);
    EXPECT_EQ((*set)->pose_origin, PoseOrigin::trajectory);
    EXPECT_EQ((*set)->world_from_depth, pose.world_from_depth);
}

TEST(RoundTrip, OnlyPlainDetailsAreKept) {
    const auto kept = [](const std::string& detail) {
        const auto read = event_from_text(
            event_to_text({.kind = "gesture", .time = 1, .text = "t", .detail = detail}), "x");
        EXPECT_TRUE(read.has_value());
        return read ? read->detail : "?";
    };
    EXPECT_EQ(kept(R"({"b": 1, "a": "\u00fc"})"), "{\"a\":\"\\u00fc\",\"b\":1}");
    for (const char* wrong : {"[1]", "3", "{", R"({"a": [1]})", R"({"a": {}})", "{} {}"}) {
        EXPECT_EQ(kept(wrong), "") << wrong;
    }
    // Of a later version: the event stays.
    const auto later = event_from_text(
        R"({"time_ns": 5, "kind": "gesture", "text": "t", "detail": {"list": [1]}})", "x");
    ASSERT_TRUE(later.has_value());
    EXPECT_EQ(*later, (SessionEvent{.kind = "gesture", .time = 5, .text = "t"}));
    // Nothing can be so deep that it exhausts the stack.
    const std::string deep(200'000, '[');
    EXPECT_EQ(kept("{\"a\":" + deep + std::string(deep.size(), ']') + "}"), "");
}

}  // namespace
}  // namespace kino
