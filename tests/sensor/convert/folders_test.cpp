#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <fstream>

#include "recordings.h"
#include "sensor/convert/sinks.h"
#include "sensor/openers.h"
#include "sensor/openni2/openni2.h"

/// Recordings into folders, point clouds and ONI, and what our own readers get back.
namespace kino {
namespace {

using test::Clip;
using test::ClipStyle;
using test::make_clip;
using test::names_in;
using test::read_all;
using test::TempDir;
using test::TestGeometry;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

struct Job {
    explicit Job(const Clip& clip) : source(test::source_of(clip)), geometry(clip.rig) {
        input = {source->info(), clip.rig, &geometry};
    }

    Result<ConvertReport> run(Result<std::unique_ptr<FrameSink>> sink,
                              const ConvertRange& range = {}) {
        if (!sink) return fail(sink.error());
        auto report = convert_recording(*source, nullptr, **sink, range);
        losses = (*sink)->losses().lines();
        return report;
    }

    std::unique_ptr<Source> source;
    TestGeometry geometry;
    ConvertInput input;
    std::vector<std::string> losses;
};

std::vector<FrameSet> reopen(const SourceOpener& opener, const std::filesystem::path& path,
                             RigParameters* rig = nullptr) {
    EXPECT_TRUE(opener.probe(path.string()));
    auto source = opener.open(path.string());
    EXPECT_TRUE(source.has_value()) << source.error().to_string();
    if (!source) return {};
    if (rig) *rig = *(*source)->calibration();
    return read_all(**source);
}

void expect_same_frames(const std::vector<FrameSet>& sets, const Clip& clip) {
    ASSERT_EQ(sets.size(), clip.depth.size());
    for (std::size_t i = 0; i < sets.size(); ++i) {
        ASSERT_TRUE(sets[i].depth);
        EXPECT_TRUE(test::same_pixels(*sets[i].depth, *clip.depth[i])) << i;
        ASSERT_EQ(sets[i].color != nullptr, !clip.color.empty());
        if (sets[i].color) {
            EXPECT_TRUE(test::same_picture(*sets[i].color, *clip.color[i])) << i;
        }
    }
}

TEST(TumFolder, LinearDepthOfAFifthOfAMillimetreComesBackBitByBit) {
    const TempDir dir;
    const Clip clip = make_clip({.with_poses = true});
    Job job(clip);
    ASSERT_TRUE(job.run(make_tum_sink(dir / "out", job.input, {})));
    EXPECT_THAT(job.losses, IsEmpty());
    RigParameters rig;
    const auto sets = reopen(tum_folder_opener(), dir / "out", &rig);
    EXPECT_EQ(rig, clip.rig);
    expect_same_frames(sets, clip);
    for (std::size_t i = 0; i < sets.size(); ++i) {
        EXPECT_EQ(sets[i].depth->header.device_time, clip.depth[i]->header.device_time);
        EXPECT_EQ(sets[i].color->header.device_time, clip.color[i]->header.device_time);
        ASSERT_EQ(sets[i].pose_origin, PoseOrigin::trajectory);
        const Pose apart = inverse(clip.poses[i]) * sets[i].world_from_depth;
        EXPECT_LT(glm::length(apart.translation), 1e-12);
        EXPECT_LT(glm::length(glm::dvec3(apart.rotation.x, apart.rotation.y, apart.rotation.z)),
                  1e-12);
    }
    EXPECT_THAT(test::read_bytes(dir / "out/calibration.json"),
                HasSubstr("\"depth_per_metre\": 5000.0"));
    EXPECT_THAT(test::read_bytes(dir / "out/depth.txt"),
                HasSubstr("1305031453.374112007 depth/1305031453.374112007.png\n"));
}

TEST(TumFolder, EveryUnitComesBackAsItWas) {
    for (const double unit : {0.001, 0.0001, 0.00025, 1 / 8000.0, 0.0001234, 0.01}) {
        const TempDir dir;
        const Clip clip = make_clip({.frames = 2, .metres_per_unit = unit});
        Job job(clip);
        ASSERT_TRUE(job.run(make_tum_sink(dir / "out", job.input, {})));
        EXPECT_THAT(job.losses, IsEmpty());
        expect_same_frames(reopen(tum_folder_opener(), dir / "out"), clip);
    }
}

TEST(TumFolder, MillimetresAtFiveThousandKeepEveryDepthThatFits) {
    const TempDir dir;
    const Clip clip = make_clip({.frames = 2, .metres_per_unit = 0.001});
    Job job(clip);
    ASSERT_TRUE(job.run(make_tum_sink(dir / "out", job.input, {.depth_per_metre = 5000})));
    const auto sets = reopen(tum_folder_opener(), dir / "out");
    ASSERT_EQ(sets.size(), 2u);
    std::int64_t too_far = 0;
    for (std::size_t i = 0; i < 2; ++i) {
        for (std::size_t p = 0; p < clip.depth[i]->raw.size(); ++p) {
            const int raw = clip.depth[i]->raw.data()[p];
            const bool fits = raw * 5 <= 65534;
            too_far += fits ? 0 : 1;
            ASSERT_EQ(sets[i].depth->raw.data()[p], fits ? raw * 5 : 0);
        }
    }
    EXPECT_THAT(job.losses,
                ElementsAre("depths left out: too far for 16 bits: " + std::to_string(too_far)));
}

TEST(TumFolder, DisparityBecomesDepthAndThatIsSaid) {
    const TempDir dir;
    const Clip clip = make_clip({.frames = 2, .unit = DepthUnit::kinect_disparity11});
    Job job(clip);
    ASSERT_TRUE(job.run(make_tum_sink(dir / "out", job.input, {})));
    EXPECT_THAT(job.losses, Contains(HasSubstr("raw disparity became depth")));
    const auto sets = reopen(tum_folder_opener(), dir / "out");
    ASSERT_EQ(sets.size(), 2u);
    Image<float> metres;
    ASSERT_TRUE(job.geometry.metres(*clip.depth[1], metres));
    for (std::size_t p = 0; p < metres.size(); ++p) {
        EXPECT_NEAR(sets[1].depth->raw.data()[p] * 0.0002, metres.data()[p], 0.0001001);
    }
}

TEST(TumFolder, BayerBecomesRgbAndThatIsSaid) {
    const TempDir dir;
    const Clip clip = make_clip({.frames = 1, .color = PixelFormat::bayer_grbg8});
    Job job(clip);
    ASSERT_TRUE(job.run(make_tum_sink(dir / "out", job.input, {})));
    EXPECT_THAT(job.losses, Contains(HasSubstr("became RGB")));
    expect_same_frames(reopen(tum_folder_opener(), dir / "out"), clip);
}

TEST(PngFolder, KeepsEitherUnitBitByBit) {
    for (const DepthUnit unit : {DepthUnit::linear, DepthUnit::kinect_disparity11}) {
        const TempDir dir;
        const Clip clip = make_clip({.unit = unit, .color = PixelFormat::rgb8});
        Job job(clip);
        ASSERT_TRUE(job.run(make_png_sink(dir / "out", job.input, {})));
        EXPECT_THAT(job.losses, IsEmpty());
        RigParameters rig;
        const auto sets = reopen(described_folder_opener(), dir / "out", &rig);
        EXPECT_EQ(rig, clip.rig);
        expect_same_frames(sets, clip);
        EXPECT_EQ(sets[3].time, clip.depth[3]->header.host_time);
    }
}

TEST(PngFolder, TakesTheRangeThatIsAskedFor) {
    const TempDir dir;
    const Clip clip = make_clip();
    Job job(clip);
    const auto report =
        job.run(make_png_sink(dir / "out", job.input, {.first_index = 2}), {.from = 2, .count = 2});
    ASSERT_TRUE(report);
    EXPECT_EQ(report->frames, 2);
    EXPECT_THAT(names_in(dir / "out/depth"), ElementsAre("000002.png", "000003.png"));
    const auto sets = reopen(described_folder_opener(), dir / "out");
    ASSERT_EQ(sets.size(), 2u);
    EXPECT_EQ(sets[0].depth->raw, clip.depth[2]->raw);
}

TEST(Ply, HoldsAPointForEachReading) {
    const TempDir dir;
    const Clip clip = make_clip({.frames = 2, .metres_per_unit = 0.0001});
    Job job(clip);
    ASSERT_TRUE(job.run(make_ply_sink(dir / "cloud_%03d.ply", job.input, {.first_index = 7})));
    EXPECT_THAT(names_in(dir.path()), ElementsAre("cloud_007.ply", "cloud_008.ply"));
    std::vector<CloudPoint> points;
    FrameSet set;
    set.depth = clip.depth[1];
    ASSERT_TRUE(job.geometry.points(set, points));
    ASSERT_GT(points.size(), 100u);
    const std::string text = test::read_bytes(dir / "cloud_008.ply");
    EXPECT_THAT(text, HasSubstr("element vertex " + std::to_string(points.size()) + "\n"));
    const std::size_t body = text.find("end_header\n") + std::strlen("end_header\n");
    ASSERT_EQ(text.size() - body, points.size() * 15);
    for (std::size_t i = 0; i < points.size(); ++i) {
        std::array<float, 3> xyz{};
        std::memcpy(xyz.data(), text.data() + body + i * 15, sizeof(xyz));
        EXPECT_THAT(xyz, ElementsAre(points[i].x, points[i].y, points[i].z));
        EXPECT_EQ(text.substr(body + i * 15 + 12, 3), "\x01\x02\x03");
    }
}

TEST(Ply, OneNameHoldsOneFrame) {
    const TempDir dir;
    const Clip clip = make_clip({.frames = 2});
    Job job(clip);
    const auto refused = job.run(make_ply_sink(dir / "a.ply", job.input, {}));
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().hint, HasSubstr("%05d"));
    EXPECT_THAT(names_in(dir.path()), IsEmpty());
    ASSERT_TRUE(job.run(make_ply_sink(dir / "a.ply", job.input, {}), {.from = 1, .count = 1}));
    EXPECT_THAT(names_in(dir.path()), ElementsAre("a.ply"));
    for (const char* bad : {"a%s.ply", "a%d%d.ply", "%", "a%99d.ply", "a%-3d.ply"}) {
        EXPECT_FALSE(make_ply_sink(dir / bad, job.input, {})) << bad;
    }
    EXPECT_THAT(names_in(dir.path()), ElementsAre("a.ply"));
}

TEST(Oni, MillimetresAndRgbComeBackBitByBit) {
    const TempDir dir;
    Clip clip = make_clip({.metres_per_unit = 0.001, .color = PixelFormat::rgb8});
    for (auto& frame : clip.depth) {
        auto near = std::make_shared<DepthFrame>(*frame);
        for (std::uint16_t& raw : near->raw.pixels()) raw = static_cast<std::uint16_t>(raw % 9999);
        frame = near;
    }
    Job job(clip);
    ASSERT_TRUE(job.run(make_oni_sink(dir / "a.oni", job.input, {})));
    EXPECT_THAT(job.losses, Contains(HasSubstr("field of view")));
    expect_same_frames(reopen(oni_opener(), dir / "a.oni"), clip);
}

TEST(Conversions, ThatFailLeaveNothingBehind) {
    const Clip clip = make_clip();
    using Maker = Result<std::unique_ptr<FrameSink>> (*)(const std::filesystem::path&,
                                                         const ConvertInput&, const SinkOptions&);
    for (const Maker maker :
         {Maker(make_tum_sink), Maker(make_png_sink), Maker(make_ply_sink), Maker(make_oni_sink),
          Maker(make_k4a_sink), Maker(make_session_sink)}) {
        const TempDir dir;
        Job job(clip);
        {
            auto sink = maker(dir / "out", job.input, {});
            ASSERT_TRUE(sink) << sink.error().to_string();
            const auto stopped =
                convert_recording(*job.source, nullptr, **sink, {},
                                  [](std::int64_t done, std::int64_t) { return done < 3; });
            ASSERT_FALSE(stopped);
            EXPECT_THAT(stopped.error().what, HasSubstr("interrupted"));
            EXPECT_FALSE(std::filesystem::exists(dir / "out"));
        }
        EXPECT_THAT(names_in(dir.path()), IsEmpty());
        // And a range that is not there.
        {
            auto sink = maker(dir / "out", job.input, {});
            ASSERT_TRUE(sink);
            EXPECT_FALSE(convert_recording(*job.source, nullptr, **sink, {.from = 5}));
        }
        EXPECT_THAT(names_in(dir.path()), IsEmpty());
    }
}

TEST(Conversions, ReplaceOnlyWhenAskedAndOnlyWhatTheyWrite) {
    const TempDir dir;
    const Clip clip = make_clip({.frames = 2});
    Job job(clip);
    ASSERT_TRUE(job.run(make_tum_sink(dir / "out", job.input, {})));
    const auto taken = make_tum_sink(dir / "out", job.input, {});
    ASSERT_FALSE(taken);
    EXPECT_THAT(taken.error().hint, HasSubstr("--force"));
    ASSERT_TRUE(job.run(make_png_sink(dir / "out", job.input, {.replace = true})));
    EXPECT_THAT(names_in(dir / "out"), ElementsAre("color", "depth", "kinoscope.json"));

    dir.write("out/thesis.txt", "years of work");
    const auto precious = make_tum_sink(dir / "out", job.input, {.replace = true});
    ASSERT_FALSE(precious);
    EXPECT_THAT(precious.error().what, HasSubstr("thesis.txt"));
    EXPECT_EQ(test::read_bytes(dir / "out/thesis.txt"), "years of work");

    dir.write("a.mkv", "old");
    EXPECT_FALSE(make_session_sink(dir / "a.mkv", job.input, {}));
    EXPECT_EQ(test::read_bytes(dir / "a.mkv"), "old");
    ASSERT_TRUE(job.run(make_session_sink(dir / "a.mkv", job.input, {.replace = true})));
    EXPECT_GT(test::read_bytes(dir / "a.mkv").size(), 1000u);
    EXPECT_THAT(names_in(dir.path()), ElementsAre("a.mkv", "out"));
}

}  // namespace
}  // namespace kino
