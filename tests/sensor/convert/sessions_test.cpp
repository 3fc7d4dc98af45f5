#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bag_bytes.h"
#include "recordings.h"
#include "sensor/convert/bag_import.h"
#include "sensor/convert/sinks.h"
#include "sensor/openers.h"
#include "sensor/session/session_source.h"

/// Into sessions and out of them.
namespace kino {
namespace {

using test::Clip;
using test::make_clip;
using test::read_all;
using test::TempDir;
using testing::IsEmpty;

Result<ConvertReport> to_session(Source& source, SessionReader* reader, const RigParameters& rig,
                                 const std::filesystem::path& file,
                                 SessionCodec codec = SessionCodec::ffv1,
                                 const ConvertRange& range = {}) {
    test::TestGeometry geometry(rig);
    KINO_ASSIGN(auto sink,
                make_session_sink(file, {source.info(), rig, &geometry}, {.codec = codec}));
    KINO_ASSIGN(const auto report, convert_recording(source, reader, *sink, range));
    EXPECT_THAT(sink->losses().lines(), IsEmpty());
    return report;
}

std::unique_ptr<Source> open_session(const std::filesystem::path& file) {
    auto source = session_opener().open(file.string());
    EXPECT_TRUE(source) << source.error().to_string();
    return source ? *std::move(source) : nullptr;
}

TEST(SessionConversion, TumAndBackAgainIsTheSameRecording) {
    const TempDir dir;
    const Clip clip = make_clip({.with_poses = true});
    const auto first = test::source_of(clip);
    ASSERT_TRUE(to_session(*first, nullptr, clip.rig, dir / "a.mkv"));

    const auto session = open_session(dir / "a.mkv");
    ASSERT_TRUE(session && subscribe_all(*session));
    const auto reader = SessionReader::open(dir / "a.mkv");
    ASSERT_TRUE(reader);
    test::TestGeometry geometry(clip.rig);
    auto sink = make_tum_sink(dir / "tum", {session->info(), clip.rig, &geometry}, {});
    ASSERT_TRUE(sink);
    ASSERT_TRUE(convert_recording(*session, reader->get(), **sink, {}));
    EXPECT_THAT((*sink)->losses().lines(), IsEmpty());

    auto folder = tum_folder_opener().open((dir / "tum").string());
    ASSERT_TRUE(folder);
    ASSERT_TRUE(subscribe_all(**folder));
    EXPECT_EQ(*(*folder)->calibration(), clip.rig);
    ASSERT_TRUE(to_session(**folder, nullptr, clip.rig, dir / "b.mkv"));
    const auto sets = read_all(*open_session(dir / "b.mkv"));
    ASSERT_EQ(sets.size(), clip.depth.size());
    for (std::size_t i = 0; i < sets.size(); ++i) {
        EXPECT_TRUE(test::same_pixels(*sets[i].depth, *clip.depth[i]));
        EXPECT_EQ(sets[i].depth->header.device_time, clip.depth[i]->header.device_time);
        EXPECT_EQ(sets[i].depth->header.host_time, clip.depth[i]->header.host_time);
        ASSERT_TRUE(sets[i].color);
        EXPECT_EQ(sets[i].color->bytes, clip.color[i]->bytes);
        EXPECT_EQ(sets[i].color->header.device_time, clip.color[i]->header.device_time);
        EXPECT_EQ(sets[i].pose_origin, PoseOrigin::trajectory);
    }
}

TEST(SessionConversion, AnotherCodecKeepsEveryFrameAndEveryBit) {
    const TempDir dir;
    const Clip clip = make_clip({.frames = 8,
                                 .unit = DepthUnit::kinect_disparity11,
                                 .color = PixelFormat::bayer_grbg8,
                                 .with_poses = true});
    // Colour at twice the rate of depth: half of it is beside no depth frame.
    SourceInfo info;
    info.streams = {{{0, StreamKind::depth}, 32, 24, 30, "test"},
                    {{0, StreamKind::color}, 32, 24, 60, "test"},
                    {{0, StreamKind::motion}, 0, 0, 60, "test"}};
    auto recorder = Recorder::create(dir / "a.mkv", info, clip.rig, {});
    ASSERT_TRUE(recorder);
    int colors = 0;
    for (std::size_t i = 0; i < clip.depth.size(); ++i) {
        FrameSet set;
        set.depth = clip.depth[i];
        set.world_from_depth = clip.poses[i];
        set.pose_origin = PoseOrigin::trajectory;
        (*recorder)->put(set);
        for (const TimeNs later : {TimeNs{4'000'000}, TimeNs{20'000'000}}) {
            auto color = std::make_shared<ColorFrame>(*clip.color[i]);
            color->header.host_time = clip.depth[i]->header.host_time + later;
            color->header.sequence = ++colors;
            (*recorder)->put({0, StreamKind::color},
                             StreamFrame(std::shared_ptr<const ColorFrame>(color)));
        }
        auto motion = std::make_shared<MotionFrame>();
        motion->header = clip.depth[i]->header;
        motion->acceleration_m_s2 = {0.5, -9.8, 0.25};
        (*recorder)->put({0, StreamKind::motion},
                         StreamFrame(std::shared_ptr<const MotionFrame>(motion)));
    }
    (*recorder)->put_event({EventKind::lost, clip.depth[4]->header.host_time, "unplugged"});
    ASSERT_TRUE((*recorder)->close());

    for (const SessionCodec codec : {SessionCodec::fast, SessionCodec::rvl, SessionCodec::raw}) {
        const TempDir out;
        const auto source = open_session(dir / "a.mkv");
        ASSERT_TRUE(source && subscribe_all(*source));
        auto reader = SessionReader::open(dir / "a.mkv");
        ASSERT_TRUE(reader);
        ASSERT_TRUE(to_session(*source, reader->get(), clip.rig, out / "b.mkv", codec));
        auto again = SessionReader::open(out / "b.mkv");
        ASSERT_TRUE(again);
        ASSERT_EQ((*again)->frames().size(), (*reader)->frames().size());
        EXPECT_EQ((*again)->poses().size(), 8u);
        int lost = 0;
        for (const SessionEvent& event : (*again)->events()) lost += event.kind == "lost" ? 1 : 0;
        EXPECT_EQ(lost, 1);
        int seen = 0;
        for (const SessionEntry& entry : (*again)->frames()) {
            const auto frame = (*again)->read(entry);
            ASSERT_TRUE(frame);
            if (const auto* color = std::get_if<1>(&*frame)) {
                ++seen;
                const auto& was =
                    *clip.color[static_cast<std::size_t>(((*color)->header.sequence - 1) / 2)];
                EXPECT_EQ((*color)->bytes, was.bytes);
                EXPECT_EQ((*color)->format, PixelFormat::bayer_grbg8);
            } else if (const auto* depth = std::get_if<0>(&*frame)) {
                EXPECT_TRUE(test::same_pixels(
                    **depth, *clip.depth[static_cast<std::size_t>((*depth)->header.sequence)]));
            }
        }
        EXPECT_EQ(seen, 16);
    }
}

TEST(SessionConversion, ARangeTakesWhatLiesWithin) {
    const TempDir dir;
    const Clip clip = make_clip({.frames = 8});
    ASSERT_TRUE(to_session(*test::source_of(clip), nullptr, clip.rig, dir / "a.mkv"));
    const auto source = open_session(dir / "a.mkv");
    ASSERT_TRUE(source && subscribe_all(*source));
    auto reader = SessionReader::open(dir / "a.mkv");
    ASSERT_TRUE(reader);
    const auto report = to_session(*source, reader->get(), clip.rig, dir / "b.mkv",
                                   SessionCodec::ffv1, {.from = 2, .count = 3});
    ASSERT_TRUE(report);
    EXPECT_EQ(report->frames, 3);
    const auto sets = read_all(*open_session(dir / "b.mkv"));
    ASSERT_EQ(sets.size(), 3u);
    for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_TRUE(test::same_pixels(*sets[i].depth, *clip.depth[i + 2]));
        ASSERT_TRUE(sets[i].color);
        EXPECT_EQ(sets[i].color->bytes, clip.color[i + 2]->bytes);
    }
}

TEST(SessionConversion, ABagBecomesASessionWithEveryFrame) {
    const TempDir dir;
    const auto bytes = test::make_bag({.packing = test::BagPacking::lz4});
    auto bag = make_bag_source(memory_byte_source(bytes), "a.bag");
    ASSERT_TRUE(bag && subscribe_all(**bag));
    const RigParameters rig = *(*bag)->calibration();
    ASSERT_TRUE(to_session(**bag, nullptr, rig, dir / "a.mkv"));
    const auto session = open_session(dir / "a.mkv");
    EXPECT_EQ(*session->calibration(), rig);
    const auto sets = read_all(*session);
    ASSERT_EQ(sets.size(), 4u);
    for (std::size_t i = 0; i < 4; ++i) {
        EXPECT_EQ(sets[i].depth->raw.data()[77], test::bag_depth(77, static_cast<int>(i)));
        EXPECT_EQ(sets[i].color->bytes[99], test::bag_color(99, static_cast<int>(i)));
    }
}

}  // namespace
}  // namespace kino
