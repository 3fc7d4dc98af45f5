#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <random>
#include <set>

#include "fuzz/oni_targets.h"
#include "oni_samples.h"
#include "openni_runtime.h"
#include "sensor/openni2/oni_depth_codec.h"
#include "sensor/openni2/oni_frames.h"
#include "sensor/openni2/openni2.h"
#include "sensor/openni2/openni_library.h"
#include "tests/support/temp_dir.h"

namespace kino {
namespace {

using test::TempDir;
using testing::HasSubstr;

class Oni : public testing::Test {
  protected:
    Oni() { (void)test::OpenniRuntime::get(); }

    std::unique_ptr<Source> open_all(const std::filesystem::path& file) {
        EXPECT_TRUE(oni_opener().probe(file.string()));
        auto source = oni_opener().open(file.string());
        if (!source) {
            ADD_FAILURE() << source.error().to_string();
            return nullptr;
        }
        EXPECT_TRUE(subscribe_all(**source));
        return std::move(*source);
    }

    TempDir folder_;
};

FrameSet next_frame(Source& source) {
    auto set = source.next(0);
    EXPECT_TRUE(set && *set) << (set ? "the end" : set.error().to_string());
    return set && *set ? std::move(**set) : FrameSet{};
}

void expect_sample(const FrameSet& set, int index, bool color) {
    ASSERT_TRUE(set.depth);
    EXPECT_EQ(set.depth->raw, test::sample_depth(index).raw) << "frame " << index;
    EXPECT_EQ(set.depth->metres_per_unit, 0.001);
    ASSERT_EQ(set.color != nullptr, color);
    if (color) {
        EXPECT_EQ(set.color->bytes, test::sample_color(index).bytes) << "frame " << index;
        EXPECT_TRUE(set.color_paired);
    }
}

TEST_F(Oni, WhatIsWrittenComesBackInAnyOrder) {
    for (const bool color : {false, true}) {
        const auto file = folder_ / (color ? "both.oni" : "depth.oni");
        constexpr int kCount = 12;
        test::write_sample(file, kCount, color);
        const auto source = open_all(file);
        ASSERT_TRUE(source);
        Timeline& timeline = *source->timeline();
        ASSERT_EQ(timeline.frame_count(), kCount);
        for (int i = 1; i <= kCount; ++i) expect_sample(next_frame(*source), i, color);
        const auto end = source->next(0);
        EXPECT_TRUE(end && !*end);
        std::mt19937 random(3);
        for (int i = 0; i < 60; ++i) {
            const auto index = static_cast<std::int64_t>(random() % kCount);
            ASSERT_TRUE(timeline.seek(index));
            expect_sample(next_frame(*source), static_cast<int>(index) + 1, color);
        }
        for (int i = 0; i < kCount; ++i) {
            // Times are whole microseconds, rounded to even ones.
            EXPECT_NEAR(static_cast<double>(timeline.time_of(i)), i * 33'333'333.0, 1000);
        }
    }
}

/// Debian's player as witness: it plays our file from the start, and what it gives is the same.
TEST_F(Oni, TheLibrarysPlayerGivesTheSameFrames) {
    const auto file = folder_ / "a.oni";
    constexpr int kCount = 15;
    test::write_sample(file, kCount, true);
    auto frames = *OniFrames::open(file);
    std::set<int> depths;
    std::set<int> colors;
    const bool returned = run_bounded(
        [&] {
            const openni::Api& api = (*OpenniLibrary::get())->api();
            openni::Device* device = nullptr;
            ASSERT_EQ(api.DeviceOpen(file.c_str(), &device), openni::kOk);
            openni::Stream* streams[2]{};
            ASSERT_EQ(api.DeviceCreateStream(device, openni::kSensorDepth, &streams[0]), 0);
            ASSERT_EQ(api.DeviceCreateStream(device, openni::kSensorColor, &streams[1]), 0);
            ASSERT_EQ(api.StreamStart(streams[0]), 0);
            ASSERT_EQ(api.StreamStart(streams[1]), 0);
            for (int i = 0; i < 400 && (depths.size() < 10 || colors.size() < 10); ++i) {
                int index = 0;
                openni::Frame* frame = nullptr;
                if (api.WaitForAnyStream(streams, 2, &index, 500) != 0) continue;
                ASSERT_EQ(api.StreamReadFrame(streams[index], &frame), 0);
                const auto number = static_cast<std::size_t>(frame->index - 1);
                const auto own_depth = frames->depth(number);
                const auto own_color = frames->color(number);
                ASSERT_TRUE(own_depth && own_color);
                const void* own = index == 0 ? static_cast<const void*>(own_depth->raw.data())
                                             : own_color->bytes.data();
                const std::size_t bytes =
                    index == 0 ? own_depth->raw.size() * 2 : own_color->bytes.size();
                ASSERT_EQ(static_cast<std::size_t>(frame->bytes), bytes);
                EXPECT_EQ(std::memcmp(frame->data, own, bytes), 0) << frame->index;
                (index == 0 ? depths : colors).insert(frame->index);
                api.FrameRelease(frame);
            }
            // Paused, and left open: the player's thread walks its list of streams without a lock,
            // and may crash while they are taken away.
            const float manual = -1;
            (void)api.DeviceSetProperty(device, openni::kDevicePlaybackSpeed, &manual,
                                        sizeof(manual));
        },
        std::chrono::seconds(30));
    EXPECT_TRUE(returned);
    EXPECT_GE(depths.size(), 10u);
    EXPECT_GE(colors.size(), 10u);
    for (const DeviceEntry& entry : openni2_driver().list()) {
        EXPECT_THAT(entry.uri, testing::Not(HasSubstr(".oni"))) << "files are no devices";
    }
}

TEST_F(Oni, AFileOfOneFrame) {
    test::write_sample(folder_ / "one.oni", 1, true);
    const auto source = open_all(folder_ / "one.oni");
    ASSERT_TRUE(source);
    for (int i = 0; i < 5; ++i) {
        expect_sample(next_frame(*source), 1, true);
        ASSERT_TRUE(source->timeline()->seek(0));
    }
}

TEST_F(Oni, ManyFilesOpenAtOnceAndClose) {
    test::write_sample(folder_ / "a.oni", 5, true);
    test::write_sample(folder_ / "b.oni", 3, false);
    for (int round = 0; round < 3; ++round) {
        const auto a = open_all(folder_ / "a.oni");
        const auto b = open_all(folder_ / "b.oni");
        ASSERT_TRUE(a && b);
        for (int i = 1; i <= 3; ++i) {
            expect_sample(next_frame(*a), i, true);
            expect_sample(next_frame(*b), i, false);
        }
    }
}

TEST_F(Oni, CamerasKeepTheirFieldOfView) {
    const RigParameters rig = test::sample_rig(true);
    test::write_sample(folder_ / "a.oni", 2, true);
    const auto source = open_all(folder_ / "a.oni");
    ASSERT_TRUE(source);
    const auto back = source->calibration();
    ASSERT_TRUE(back && validate(*back));
    EXPECT_NEAR(back->depth.fx, rig.depth.fx, 1e-9);
    EXPECT_NEAR(back->depth.fy, rig.depth.fy, 1e-9);
    EXPECT_NEAR(back->color->fx, rig.color->fx, 1e-9);
    EXPECT_THAT(back->note, HasSubstr("field of view"));
}

TEST_F(Oni, CutAtEveryByteItIsRefusedOrWhole) {
    const auto file = folder_ / "a.oni";
    auto writer = *OniWriter::create(file, test::sample_rig(false, 4, 3));
    ASSERT_TRUE(writer->write(test::sample_depth(1, 4, 3), nullptr));
    ASSERT_TRUE(writer->close());
    const std::string whole = test::read_bytes(file);
    for (std::size_t size = 0; size < whole.size(); ++size) {
        const std::string cut = whole.substr(0, size);
        const auto* bytes = reinterpret_cast<const std::uint8_t*>(cut.data());
        ASSERT_FALSE(walk_oni(fuzz::MemoryInput({bytes, size}))) << size;
    }
    const auto cut = folder_.write("cut.oni", whole.substr(0, whole.size() / 2));
    EXPECT_TRUE(oni_opener().probe(cut.string()));
    const auto source = oni_opener().open(cut.string());
    ASSERT_FALSE(source);
    EXPECT_THAT(source.error().to_string(), HasSubstr("cut.oni"));
}

TEST_F(Oni, ADamagedFrameIsAnErrorAndTheOthersAreFine) {
    const auto file = folder_ / "a.oni";
    test::write_sample(file, 6, true);
    std::string bytes = test::read_bytes(file);
    {
        const auto records = *walk_oni(**open_oni_input(file));
        const OniData& third = records.data[records.nodes[0].frames[2]];
        // The last byte of the frame: a run that leads beyond the frame's end.
        bytes[third.next - 1] = static_cast<char>(0xEF);
    }
    const auto source = open_all(folder_.write("b.oni", bytes));
    ASSERT_TRUE(source);
    for (int i = 1; i <= 6; ++i) {
        if (i != 3) {
            expect_sample(next_frame(*source), i, true);
            continue;
        }
        const auto set = source->next(0);
        ASSERT_FALSE(set);
        EXPECT_THAT(set.error().to_string(), HasSubstr("frame 2 of depth is damaged"));
    }
}

TEST_F(Oni, ATableThatHangsTheLibrarysPlayerIsNoMatter) {
    // As the library's own recorder writes it: place 0 of the tables is no record at all, and
    // colour has the times of depth. The player's seek never returns from that.
    const auto file = folder_ / "a.oni";
    constexpr int kCount = 6;
    test::write_sample(file, kCount, true);
    std::string bytes = test::read_bytes(file);
    const auto records = *walk_oni(**open_oni_input(file));
    for (const OniNode& node : records.nodes) {
        for (std::size_t i = 0; i < node.frames.size(); ++i) {
            const std::uint64_t time = 1 + i * 33332;
            const OniData& data = records.data[node.frames[i]];
            std::memcpy(&bytes[data.position + oni::kRecordHeadBytes], &time, 8);
        }
        const std::size_t entries = (node.frames.size() + 1) * oni::kSeekEntryBytes;
        // Its place is known by its last entry.
        std::string last(8, '\0');
        std::memcpy(last.data(), &records.data[node.frames.back()].position, 8);
        const std::size_t end = bytes.rfind(last) + 8;
        char* const table = &bytes[end - entries];
        std::memset(table, 0, oni::kSeekEntryBytes);
        for (std::size_t i = 1; i <= node.frames.size(); ++i) {
            const std::uint64_t time = 1 + (i - 1) * 33332;
            std::memcpy(table + i * oni::kSeekEntryBytes, &time, 8);
        }
    }
    const auto changed = folder_.write("b.oni", bytes);
    const auto again = *walk_oni(**open_oni_input(changed));
    ASSERT_FALSE(again.nodes[0].seek_table.empty());
    const auto source = open_all(changed);
    ASSERT_TRUE(source);
    for (const int index : {0, 1, 2, 3, 4, 5, 0, 5, 1}) {
        ASSERT_TRUE(source->timeline()->seek(index));
        expect_sample(next_frame(*source), index + 1, true);
    }
}

TEST_F(Oni, MirroredFilesAreTurned) {
    const auto file = folder_ / "a.oni";
    test::write_sample(file, 2, true);
    std::string bytes = test::read_bytes(file);
    int turned = 0;
    for (std::size_t at = 0; (at = bytes.find("xnMirror", at)) != std::string::npos; at += 8) {
        bytes[at + 9 + 4] = 1;  // behind the name and the size
        ++turned;
    }
    ASSERT_EQ(turned, 2);
    const auto source = open_all(folder_.write("b.oni", bytes));
    ASSERT_TRUE(source);
    const FrameSet set = next_frame(*source);
    const Image<std::uint16_t> straight = test::sample_depth(1).raw;
    for (int y = 0; y < straight.height(); ++y) {
        for (int x = 0; x < straight.width(); ++x) {
            ASSERT_EQ(set.depth->raw.at(x, y), straight.at(straight.width() - 1 - x, y));
        }
    }
    const ColorFrame color = test::sample_color(1);
    EXPECT_EQ(set.color->bytes[0], color.bytes[static_cast<std::size_t>(color.pitch) - 3]);
}

TEST_F(Oni, TheWriterRefusesWhatTheFormatCannotHold) {
    const auto file = folder_ / "a.oni";
    auto writer = *OniWriter::create(file, test::sample_rig(true));
    EXPECT_FALSE(OniWriter::create(file, test::sample_rig(true))) << "exists";
    EXPECT_FALSE(OniWriter::create(folder_ / "none/a.oni", test::sample_rig(true)));
    EXPECT_FALSE(OniWriter::create(folder_ / "big.oni", test::sample_rig(false, 3000, 2000)));
    DepthFrame depth = test::sample_depth(1);
    depth.metres_per_unit = 0.0002;
    EXPECT_FALSE(writer->write(depth, nullptr));
    EXPECT_FALSE(writer->write(test::sample_depth(1, 10, 10), nullptr));
    ColorFrame color = test::sample_color(1);
    color.format = PixelFormat::gray8;
    EXPECT_FALSE(writer->write(test::sample_depth(1), &color));
    ASSERT_TRUE(writer->write(test::sample_depth(1), nullptr));
    EXPECT_FALSE(writer->write(test::sample_depth(1), nullptr)) << "the same time";
    ASSERT_TRUE(writer->write(test::sample_depth(2), nullptr));
    ASSERT_TRUE(writer->close());
    ASSERT_TRUE(writer->close());
    EXPECT_FALSE(writer->write(test::sample_depth(3), nullptr));
    const auto records = walk_oni(**open_oni_input(file));
    ASSERT_TRUE(records) << records.error().to_string();
    EXPECT_EQ(records->nodes[0].frames.size(), 2u);
}

TEST_F(Oni, GarbageIsRefused) {
    for (const std::string& text : {std::string("NI10"), "NI10" + std::string(20, '\0'),
                                    "NI10" + std::string(4000, '\xFF'), std::string("RIFF")}) {
        EXPECT_FALSE(oni_opener().open(folder_.write("a.oni", text).string()));
    }
    EXPECT_FALSE(oni_opener().probe(folder_.write("b.oni", "PNG").string()));
    EXPECT_FALSE(oni_opener().probe((folder_ / "none.oni").string()));
}

}  // namespace
}  // namespace kino
