#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <sstream>

#include "logged_file.h"
#include "sensor/session/session_source.h"
#include "session_frames.h"
#include "tests/support/random.h"

/// Other people's programs read our sessions and see the same pixels.
namespace kino {
namespace {

using test::count_exact;
using test::frames_between;
using test::FrameStyle;
using test::PutFrame;

struct Answer {
    int status = -1;
    std::string out;
};

Answer run(const std::string& command) {
    Answer answer;
    FILE* pipe = ::popen(command.c_str(), "r");
    if (pipe == nullptr) return answer;
    std::vector<char> part(1 << 16);
    std::size_t got = 0;
    while ((got = std::fread(part.data(), 1, part.size(), pipe)) > 0) {
        answer.out.append(part.data(), got);
    }
    const int status = ::pclose(pipe);
    answer.status = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    return answer;
}

std::filesystem::path write(const test::TempDir& dir, const std::string& name,
                            std::span<const std::uint8_t> bytes) {
    return dir.write(name, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

std::string decoded_by_ffmpeg(const std::filesystem::path& path, int stream, const char* pixels) {
    return run("ffmpeg -nostdin -v fatal -i " + path.string() +
               " -map 0:v:" + std::to_string(stream) +
               " -fps_mode passthrough -f rawvideo -pix_fmt " + pixels + " - 2>/dev/null")
        .out;
}

std::string pixels_of(const std::vector<PutFrame>& frames, StreamKind kind) {
    std::string all;
    for (const PutFrame& put : frames) {
        if (put.id.kind != kind) continue;
        if (const auto* color = std::get_if<1>(&put.frame)) {
            std::vector<std::uint8_t> store;
            const auto pixels = packed_pixels(**color, store);
            all.append(pixels->begin(), pixels->end());
        } else {
            const auto& image = kind == StreamKind::depth ? std::get<0>(put.frame)->raw
                                                          : std::get<2>(put.frame)->raw;
            all.append(reinterpret_cast<const char*>(image.data()), image.size() * 2);
        }
    }
    return all;
}

/// Sizes and the first difference, not the pixels themselves.
testing::AssertionResult same_bits(const std::string& a, const std::string& b) {
    if (a == b) return testing::AssertionSuccess();
    const auto [at, other] = std::mismatch(a.begin(), a.end(), b.begin(), b.end());
    return testing::AssertionFailure()
           << a.size() << " and " << b.size() << " bytes, first difference at " << at - a.begin();
}

TEST(Witness, FfmpegDecodesTheSameBits) {
    const test::TempDir dir;
    const auto frames = frames_between(0, 40);
    for (const SessionCodec codec : {SessionCodec::ffv1, SessionCodec::raw}) {
        RecorderOptions options;
        options.codec = codec;
        const auto path = write(dir, "a.mkv", test::session_of(frames, options));
        EXPECT_TRUE(same_bits(decoded_by_ffmpeg(path, 0, "gray16le"),
                              pixels_of(frames, StreamKind::depth)));
        EXPECT_TRUE(
            same_bits(decoded_by_ffmpeg(path, 1, "gray"), pixels_of(frames, StreamKind::color)));
        EXPECT_TRUE(same_bits(decoded_by_ffmpeg(path, 2, "gray16le"),
                              pixels_of(frames, StreamKind::infrared)));
    }
}

TEST(Witness, FfmpegDecodesColoursTheSame) {
    const test::TempDir dir;
    const std::vector<std::pair<PixelFormat, const char*>> formats = {
        {PixelFormat::rgb8, "rgb24"},
        {PixelFormat::rgba8, "rgba"},
        {PixelFormat::gray8, "gray"},
        {PixelFormat::uyvy, "uyvy422"},
        {PixelFormat::yuyv, "yuyv422"}};
    for (const SessionCodec codec : {SessionCodec::ffv1, SessionCodec::raw}) {
        for (const auto& [format, pixels] : formats) {
            FrameStyle style{.color = format, .infrared = false, .texts = false};
            const auto frames = frames_between(0, 3, style);
            RecorderOptions options;
            options.codec = codec;
            const auto path = write(dir, "a.mkv", test::session_of(frames, options, style));
            EXPECT_TRUE(
                same_bits(decoded_by_ffmpeg(path, 1, pixels), pixels_of(frames, StreamKind::color)))
                << pixels << " codec " << static_cast<int>(codec);
        }
    }
}

TEST(Witness, FfprobeSeesEveryStreamAndTimeAndText) {
    const test::TempDir dir;
    const auto path = write(dir, "a.mkv", test::session_of(frames_between(0, 40)));
    const Answer streams = run(
        "ffprobe -v error -count_packets -show_entries "
        "stream=codec_name,width,height,nb_read_packets:stream_tags=KINO_FORMAT,title -of csv " +
        path.string() + " 2>&1");
    EXPECT_EQ(streams.status, 0);
    EXPECT_NE(streams.out.find("ffv1,48,36,40"), std::string::npos) << streams.out;
    EXPECT_NE(streams.out.find("kinect_disparity11"), std::string::npos) << streams.out;
    EXPECT_NE(streams.out.find("motion"), std::string::npos) << streams.out;
    EXPECT_EQ(streams.out.find("rror"), std::string::npos) << streams.out;

    const Answer text = run("ffmpeg -nostdin -v error -i " + path.string() +
                            " -map 0:s:0 -c:s copy -f data - 2>&1");
    EXPECT_NE(text.out.find("\"acceleration_m_s2\":["), std::string::npos) << text.out;

    // Times of the depth track: one every 33.3667 ms, to a tenth of a millisecond.
    const Answer times =
        run("ffprobe -v error -select_streams v:0 -show_entries packet=pts -of "
            "csv=p=0 " +
            path.string());
    std::istringstream lines(times.out);
    std::string line;
    std::int64_t count = 0;
    while (std::getline(lines, line)) {
        if (line.empty()) continue;
        EXPECT_EQ(std::atoll(line.c_str()), count++ * 33'366'700 / 100'000) << line;
    }
    EXPECT_EQ(count, 40);
}

TEST(Witness, MkvinfoFindsNothingOdd) {
    const test::TempDir dir;
    const auto path = write(dir, "a.mkv", test::session_of(frames_between(0, 40)));
    const Answer info = run("mkvinfo --ui-language en_US -v -v " + path.string() + " 2>&1");
    EXPECT_EQ(info.status, 0);
    for (const char* word :
         {"Attachments", "calibration.json", "Cluster", "Cues", "Block addition mapping",
          "Block additional", "KINO_FORMAT", "Seek head", "Duration"}) {
        EXPECT_NE(info.out.find(word), std::string::npos) << word;
    }
    EXPECT_EQ(info.out.find("Unknown element"), std::string::npos);
    EXPECT_EQ(info.out.find("rror"), std::string::npos);
}

TEST(Witness, WhatMkvmergeCopiesIsStillOurs) {
    const test::TempDir dir;
    auto frames = frames_between(0, 40);
    const auto path = write(dir, "a.mkv", test::session_of(frames));
    const auto copy = dir / "copy.mkv";
    const Answer merge =
        run("mkvmerge --ui-language en_US -o " + copy.string() + " " + path.string() + " 2>&1");
    EXPECT_LE(merge.status, 1) << merge.out;
    EXPECT_TRUE(session_opener().probe(copy.string()));
    const auto reader = SessionReader::open(copy);
    ASSERT_TRUE(reader.has_value()) << reader.error().to_string();
    EXPECT_EQ(count_exact(**reader, frames), static_cast<int>(frames.size()));
    EXPECT_EQ((*reader)->index().rig, test::rig_of());
}

TEST(Witness, FfmpegReadsWhatATruncatedSessionStillHolds) {
    const test::TempDir dir;
    const auto frames = frames_between(0, 45);
    const auto bytes = test::session_of(frames);
    const std::string depth = pixels_of(frames, StreamKind::depth);
    const SessionIndex index = test::reader_of(bytes)->index();
    test::Random random(8);
    for (int sample = 0; sample < 12; ++sample) {
        const auto size = static_cast<std::size_t>(random.integer(
            static_cast<int>(index.clusters.front().end + 1), static_cast<int>(bytes.size() - 1)));
        const std::span<const std::uint8_t> cut(bytes.data(), size);
        const auto path = write(dir, "cut.mkv", cut);
        const auto reader = SessionReader::open(path);
        ASSERT_TRUE(reader.has_value());
        const auto ours = std::ranges::count_if((*reader)->frames(), [](const SessionEntry& e) {
            return e.id.kind == StreamKind::depth;
        });
        // It may give frames of the unfinished cluster too, the last of them in part.
        const std::string theirs = decoded_by_ffmpeg(path, 0, "gray16le");
        const std::size_t whole = static_cast<std::size_t>(ours) * 48 * 36 * 2;
        ASSERT_GE(theirs.size(), whole) << size;
        EXPECT_TRUE(same_bits(theirs.substr(0, whole), depth.substr(0, whole))) << size;
    }
}

TEST(Witness, FfmpegReadsWhatAPowerCutLeaves) {
    const test::TempDir dir;
    const FrameStyle style{.infrared = false, .texts = false};
    const auto frames = frames_between(0, 75, style);
    test::FileLog log;
    SessionWriter writer(std::make_unique<test::LoggedFile>(log), test::source_of(style),
                         test::rig_of(style), {}, 0);
    ASSERT_TRUE(test::write_all(writer, frames).has_value());
    ASSERT_TRUE(writer.finish(1).has_value());
    const std::string depth = pixels_of(frames, StreamKind::depth);
    const auto whole = test::reader_of(log.content);
    test::Random random(21);
    for (std::size_t steps = 3; steps <= log.steps.size(); ++steps) {
        const auto left = test::after_power_cut(log, steps, random);
        const std::uint64_t safe = test::synced_size(log, steps);
        const auto safe_frames = std::ranges::count_if(whole->frames(), [&](const auto& entry) {
            return entry.id.kind == StreamKind::depth &&
                   whole->index().clusters[entry.cluster].end <= safe;
        });
        const std::string theirs = decoded_by_ffmpeg(write(dir, "cut.mkv", left), 0, "gray16le");
        const std::size_t size = static_cast<std::size_t>(safe_frames) * 48 * 36 * 2;
        ASSERT_GE(theirs.size(), size) << steps;
        EXPECT_TRUE(same_bits(theirs.substr(0, size), depth.substr(0, size))) << steps;
    }
}

TEST(Witness, OtherMatroskaFilesAreNotTaken) {
    const test::TempDir dir;
    const auto path = dir / "b.mkv";
    ASSERT_EQ(
        run("ffmpeg -nostdin -v error -f lavfi -i testsrc=size=64x48:duration=0.2 -c:v ffv1 " +
            path.string() + " 2>&1")
            .status,
        0);
    EXPECT_FALSE(session_opener().probe(path.string()));
    EXPECT_FALSE(session_opener().open(path.string()).has_value());
    EXPECT_FALSE(session_opener().probe("recordings/person/kinect_0_20s.webm"));
    EXPECT_FALSE(session_opener().probe(dir.path().string()));
    EXPECT_FALSE(session_opener().probe("synthetic:"));
}

}  // namespace
}  // namespace kino
