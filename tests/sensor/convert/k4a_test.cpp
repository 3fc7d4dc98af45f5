#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdio>

#include "k4a_bytes.h"
#include "recordings.h"
#include "sensor/convert/k4a_calibration.h"
#include "sensor/convert/k4a_mkv.h"
#include "sensor/convert/sinks.h"
#include "sensor/session/session_source.h"

namespace kino {
namespace {

using test::Bytes;
using test::Clip;
using test::ClipStyle;
using test::K4aBytes;
using test::make_clip;
using test::make_k4a;
using test::read_all;
using test::TempDir;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

Result<std::unique_ptr<Source>> open_k4a(const Bytes& bytes) {
    return make_k4a_source(test::owned_bytes(bytes), "test.mkv");
}

TEST(K4aImport, FramesAreThoseOfAnIndependentWriter) {
    const K4aBytes file{.calibration = test::sample_k4a_calibration()};
    const Bytes bytes = make_k4a(file);
    ASSERT_TRUE(looks_like_k4a(*memory_byte_source(bytes)));
    EXPECT_FALSE(looks_like_session(*memory_byte_source(bytes)));
    auto source = open_k4a(bytes);
    ASSERT_TRUE(source) << source.error().to_string();
    EXPECT_EQ((*source)->info().serial, "000123");
    EXPECT_THAT((*source)->info().note, IsEmpty());
    const auto sets = read_all(**source);
    ASSERT_EQ(sets.size(), 3u);
    for (int i = 0; i < 3; ++i) {
        const FrameSet& set = sets[static_cast<std::size_t>(i)];
        ASSERT_TRUE(set.depth && set.color && set.infrared && set.motion);
        EXPECT_EQ(set.depth->header.device_time, file.start_offset + test::k4a_time(i));
        EXPECT_EQ(set.time, test::k4a_time(i) - test::k4a_time(0));
        EXPECT_EQ(set.depth->header.host_time, set.time);
        EXPECT_EQ(set.color->header.device_time, file.start_offset + test::k4a_time(i) + 2'000'000);
        EXPECT_EQ(set.depth->metres_per_unit, 0.001);
        for (std::size_t p = 0; p < set.depth->raw.size(); ++p) {
            ASSERT_EQ(set.depth->raw.data()[p], test::k4a_depth(p, i));
            ASSERT_EQ(set.infrared->raw.data()[p], test::k4a_infrared(p, i));
        }
        EXPECT_EQ(set.color->format, PixelFormat::mjpeg);
        EXPECT_EQ(set.color->bytes, test::k4a_color_frame(file, i));
        // The mean of two samples (1, -2, 9) and (1, -2, 11), turned into the depth camera's axes.
        EXPECT_THAT(
            set.motion->acceleration_m_s2,
            testing::ElementsAre(testing::DoubleNear(-2, 1e-9), testing::DoubleNear(10, 1e-9),
                                 testing::DoubleNear(1, 1e-9)));
    }
}

TEST(K4aImport, CalibrationIsThatOfTheModes) {
    const auto rig =
        rig_from_k4a(test::sample_k4a_calibration(), {320, 288}, PixelSize{1280, 720}, "here");
    ASSERT_TRUE(rig) << rig.error().to_string();
    // Narrow, binned: the 512 x 512 picture from (96, 90) on; its corner is at (-0.5, -0.5).
    EXPECT_DOUBLE_EQ(rig->depth.cx, 0.5 * 512 - 96 - 0.5);
    EXPECT_DOUBLE_EQ(rig->depth.cy, 0.25 * 512 - 90 - 0.5);
    EXPECT_DOUBLE_EQ(rig->depth.fx, 0.49 * 512);
    EXPECT_DOUBLE_EQ(rig->depth.fy, 0.48 * 512);
    EXPECT_EQ(rig->depth.k1, 0.1);
    EXPECT_EQ(rig->depth.k6, 0.6);
    EXPECT_EQ(rig->depth.p2, 0.007);
    EXPECT_EQ(rig->depth.p1, 0.008);
    EXPECT_DOUBLE_EQ(rig->color->cy, 0.52 * 960 - 120 - 0.5);
    EXPECT_DOUBLE_EQ(rig->color->fy, 0.63 * 960);
    EXPECT_EQ(rig->color_from_depth.translation, glm::dvec3(-0.032, -0.002, 0.004));
    const glm::dvec3 turned = rig->color_from_depth.rotation * glm::dvec3(0, 1, 0);
    EXPECT_NEAR(turned.y, 0.8, 1e-12);
    EXPECT_NEAR(turned.z, -0.6, 1e-12);
}

TEST(K4aImport, CalibrationGoesThereAndBack) {
    for (const auto& [depth, color] : {std::pair(PixelSize{320, 288}, PixelSize{1280, 720}),
                                       std::pair(PixelSize{640, 576}, PixelSize{2048, 1536}),
                                       std::pair(PixelSize{512, 512}, PixelSize{3840, 2160}),
                                       std::pair(PixelSize{1024, 1024}, PixelSize{4096, 3072})}) {
        const auto rig = rig_from_k4a(test::sample_k4a_calibration(), depth, color, "here");
        ASSERT_TRUE(rig);
        const auto text = rig_to_k4a(*rig);
        ASSERT_TRUE(text);
        const auto again = rig_from_k4a(*text, depth, color, "here");
        ASSERT_TRUE(again) << again.error().to_string();
        EXPECT_NEAR(again->depth.cx, rig->depth.cx, 1e-9);
        EXPECT_NEAR(again->color->cy, rig->color->cy, 1e-9);
        EXPECT_NEAR(again->color->fx, rig->color->fx, 1e-9);
        EXPECT_EQ(again->depth.p1, rig->depth.p1);
        EXPECT_NEAR(
            std::abs(glm::dot(again->color_from_depth.rotation, rig->color_from_depth.rotation)), 1,
            1e-12);
    }
}

TEST(K4aImport, RawColourFormatsKeepTheirBytes) {
    for (const char* fourcc : {"NV12", "YUY2", "BGRA"}) {
        const K4aBytes file{.color_width = 16, .color_height = 12, .color_fourcc = fourcc};
        auto source = open_k4a(make_k4a(file));
        ASSERT_TRUE(source) << source.error().to_string();
        EXPECT_THAT((*source)->info().note, HasSubstr("typical values"));
        const auto sets = read_all(**source);
        ASSERT_EQ(sets.size(), 3u);
        const ColorFrame& color = *sets[1].color;
        const Bytes stored = test::k4a_color_frame(file, 1);
        for (std::size_t y = 0; y < 12; ++y) {
            for (std::size_t x = 0; x < 16; ++x) {
                const std::size_t p = y * 16 + x;
                if (std::string(fourcc) == "NV12") {
                    ASSERT_EQ(color.bytes[2 * p], stored[p]);
                    ASSERT_EQ(color.bytes[2 * p + 1], stored[16 * 12 + y / 2 * 16 + x]);
                } else if (std::string(fourcc) == "YUY2") {
                    ASSERT_EQ(color.bytes[2 * p], stored[2 * p]);
                    ASSERT_EQ(color.bytes[2 * p + 1], stored[2 * p + 1]);
                } else {
                    ASSERT_EQ(color.bytes[4 * p], stored[4 * p + 2]);
                    ASSERT_EQ(color.bytes[4 * p + 1], stored[4 * p + 1]);
                    ASSERT_EQ(color.bytes[4 * p + 2], stored[4 * p]);
                    ASSERT_EQ(color.bytes[4 * p + 3], 255);
                }
            }
        }
    }
}

TEST(K4aImport, ARecordingThatWasNeverClosedPlays) {
    const K4aBytes file{.finished = false};
    Bytes bytes = make_k4a(file);
    auto whole = open_k4a(bytes);
    ASSERT_TRUE(whole);
    EXPECT_EQ(read_all(**whole).size(), 3u);
    // Cut inside the third depth frame: two are left.
    const std::size_t cluster = bytes.size() / 3;
    bytes.resize(bytes.size() - cluster + 2000);
    auto cut = open_k4a(bytes);
    ASSERT_TRUE(cut) << cut.error().to_string();
    EXPECT_EQ(read_all(**cut).size(), 2u);
    EXPECT_THAT((*cut)->info().note, HasSubstr("cut off"));
}

TEST(K4aImport, EveryTruncationIsToldOrPlays) {
    const Bytes bytes = make_k4a({.color_width = 16, .color_height = 12, .frames = 1});
    std::size_t most = 0;
    for (std::size_t size = 0; size < bytes.size(); size += size < 4000 ? 1 : 4999) {
        const Bytes part(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
        auto source = open_k4a(part);
        if (!source) {
            EXPECT_FALSE(source.error().what.empty());
            continue;
        }
        most = std::max(most, read_all(**source).size());
    }
    EXPECT_EQ(most, 1u);
}

TEST(K4aImport, WhatIsWrongIsSaid) {
    const auto problem = [](const Bytes& bytes) {
        const auto source = open_k4a(bytes);
        return source ? std::string("none") : source.error().what;
    };
    EXPECT_THAT(problem(Bytes(100, 0)), HasSubstr("not a Matroska file"));
    EXPECT_THAT(problem(make_k4a({.color_fourcc = "H264"})), HasSubstr("pixel format"));
    EXPECT_THAT(problem(make_k4a({.frames = 0, .depth_name = "OTHER"})), HasSubstr("no picture"));
    EXPECT_THAT(problem(make_k4a({.calibration = std::string(9 << 20, ' '), .frames = 0})),
                HasSubstr("an element before the frames has"));
    EXPECT_THAT(problem(make_k4a({.color_width = 15, .color_fourcc = "NV12"})),
                HasSubstr("odd size"));
}

TEST(K4aImport, ACalibrationThatMakesNoSenseIsToldAndPicturesStillPlay) {
    std::string text = test::sample_k4a_calibration();
    for (const char* bad : {"{", "{}", "[1,2]", "null", ""}) {
        const auto rig = rig_from_k4a(bad, {320, 288}, std::nullopt, "here");
        EXPECT_FALSE(rig) << bad;
    }
    text.replace(text.find("0.8,0.6"), 7, "0.8,0.9");
    EXPECT_FALSE(rig_from_k4a(text, {320, 288}, PixelSize{1280, 720}, "here"));
    auto source = open_k4a(make_k4a({.calibration = text}));
    ASSERT_TRUE(source);
    EXPECT_THAT((*source)->info().note, HasSubstr("not a rotation"));
    EXPECT_EQ(read_all(**source).size(), 3u);
}

std::string run(const std::string& command) {
    std::string out;
    FILE* pipe = ::popen(command.c_str(), "r");
    if (!pipe) return out;
    std::array<char, 4096> part{};
    std::size_t got = 0;
    while ((got = std::fread(part.data(), 1, part.size(), pipe)) > 0) out.append(part.data(), got);
    ::pclose(pipe);
    return out;
}

struct Written {
    std::vector<std::string> losses;
    RigParameters rig;
    std::vector<FrameSet> sets;
};

/// Writes a clip as k4a and reads it back.
Written there_and_back(const Clip& clip, const std::filesystem::path& file) {
    const auto source = test::source_of(clip);
    test::TestGeometry geometry(clip.rig);
    Written out;
    auto sink = make_k4a_sink(file, {source->info(), clip.rig, &geometry}, {});
    EXPECT_TRUE(sink);
    if (!sink) return out;
    const auto report = convert_recording(*source, nullptr, **sink, {});
    EXPECT_TRUE(report) << report.error().to_string();
    out.losses = (*sink)->losses().lines();
    EXPECT_TRUE(k4a_opener().probe(file.string()));
    EXPECT_FALSE(session_opener().probe(file.string()));
    auto again = k4a_opener().open(file.string());
    EXPECT_TRUE(again) << again.error().to_string();
    if (!again) return out;
    out.rig = *(*again)->calibration();
    out.sets = read_all(**again);
    return out;
}

TEST(K4aExport, OfADepthModeComesBackAndFfmpegSeesTheSameBits) {
    const TempDir dir;
    ClipStyle style{.frames = 2,
                    .width = 320,
                    .height = 288,
                    .color_width = 1280,
                    .color_height = 720,
                    .metres_per_unit = 0.001};
    style.color = PixelFormat::yuyv;
    const Clip clip = make_clip(style);
    const Written written = there_and_back(clip, dir / "a.mkv");
    EXPECT_EQ(written.rig, clip.rig);
    ASSERT_EQ(written.sets.size(), clip.depth.size());
    std::string depth_bytes;
    for (std::size_t i = 0; i < clip.depth.size(); ++i) {
        const FrameSet& set = written.sets[i];
        EXPECT_TRUE(test::same_pixels(*set.depth, *clip.depth[i]));
        ASSERT_TRUE(set.color);
        EXPECT_EQ(set.color->bytes, clip.color[i]->bytes);
        EXPECT_EQ(set.depth->header.device_time, clip.depth[i]->header.device_time / 1000 * 1000);
        for (const std::uint16_t raw : clip.depth[i]->raw.pixels()) {
            depth_bytes.push_back(static_cast<char>(raw & 0xFF));
            depth_bytes.push_back(static_cast<char>(raw >> 8));
        }
    }
    EXPECT_THAT(written.losses, Contains("times are whole microseconds"));
    const std::string name = (dir / "a.mkv").string();
    const std::string probe = run("ffprobe -v error -show_streams -show_format " + name + " 2>&1");
    EXPECT_THAT(probe, HasSubstr("pix_fmt=gray16be"));
    EXPECT_THAT(probe, HasSubstr("TAG:K4A_DEPTH_MODE=NFOV_2X2BINNED"));
    EXPECT_THAT(probe, HasSubstr("filename=calibration.json"));
    const std::string decoded =
        run("ffmpeg -nostdin -v fatal -i " + name +
            " -map 0:v:1 -fps_mode passthrough -f rawvideo -pix_fmt gray16le - 2>/dev/null");
    EXPECT_TRUE(decoded == depth_bytes) << decoded.size() << " bytes of " << depth_bytes.size();
    EXPECT_THAT(run("mkvinfo " + name + " 2>&1"), testing::Not(HasSubstr("rror")));
}

TEST(K4aExport, OfAnImportIsTheSameRecording) {
    const TempDir dir;
    auto first = open_k4a(make_k4a({.calibration = test::sample_k4a_calibration()}));
    ASSERT_TRUE(first && subscribe_all(**first));
    const RigParameters rig = *(*first)->calibration();
    test::TestGeometry geometry(rig);
    auto sink = make_k4a_sink(dir / "a.mkv", {(*first)->info(), rig, &geometry}, {});
    ASSERT_TRUE(sink);
    ASSERT_TRUE(convert_recording(**first, nullptr, **sink, {}));
    EXPECT_THAT((*sink)->losses().lines(),
                testing::ElementsAre("motion frames, which this format cannot hold: 3"));
    auto second = k4a_opener().open((dir / "a.mkv").string());
    ASSERT_TRUE(second) << second.error().to_string();
    EXPECT_EQ(*(*second)->calibration(), rig);
    ASSERT_TRUE((*first)->timeline()->seek(0));
    const auto was = read_all(**first);
    const auto is = read_all(**second);
    ASSERT_EQ(is.size(), was.size());
    for (std::size_t i = 0; i < is.size(); ++i) {
        EXPECT_TRUE(test::same_pixels(*is[i].depth, *was[i].depth));
        ASSERT_TRUE(is[i].infrared && is[i].color);
        EXPECT_EQ(is[i].infrared->raw, was[i].infrared->raw);
        EXPECT_EQ(is[i].color->bytes, was[i].color->bytes);
        EXPECT_EQ(is[i].depth->header.device_time, was[i].depth->header.device_time);
        EXPECT_EQ(is[i].color->header.device_time, was[i].color->header.device_time);
    }
}

TEST(K4aExport, OfOtherSizesKeepsRawDepthInATrackOfItsOwn) {
    for (const DepthUnit unit : {DepthUnit::linear, DepthUnit::kinect_disparity11}) {
        const TempDir dir;
        const Clip clip = make_clip({.unit = unit, .color = PixelFormat::rgba8});
        const Written written = there_and_back(clip, dir / "a.mkv");
        EXPECT_EQ(written.rig, clip.rig);
        EXPECT_THAT(written.losses, Contains(HasSubstr("no depth mode of 32x24")));
        ASSERT_EQ(written.sets.size(), clip.depth.size());
        for (std::size_t i = 0; i < clip.depth.size(); ++i) {
            EXPECT_TRUE(test::same_pixels(*written.sets[i].depth, *clip.depth[i]));
            EXPECT_TRUE(test::same_picture(*written.sets[i].color, *clip.color[i]));
        }
    }
}

}  // namespace
}  // namespace kino
