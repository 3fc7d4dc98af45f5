#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sensor/source.h"
#include "test_folder.h"

namespace kino {
namespace {

using test::TestFolder;
using ::testing::HasSubstr;
namespace fs = std::filesystem;

constexpr StreamId kDepth{0, StreamKind::depth};
constexpr StreamId kColor{0, StreamKind::color};
constexpr const char* kCalibration =
    R"({"depth_per_metre": 1000, "depth_is_registered_to_color": true, "cameras": {"depth":
        {"width": 8, "height": 6, "fx": 7, "fy": 7, "cx": 3.5, "cy": 2.5}}})";

/// Five depth frames 33 ms apart (value 1000 + i), colour 15 ms before each but the third, whose
/// colour is missing.
void write_tum(const TestFolder& folder, bool lists) {
    std::string depth_list = "# depth\n";
    std::string color_list = "# colour\n";
    for (int i = 0; i < 5; ++i) {
        const std::string depth = "depth/10." + std::to_string(100 + 33 * i) + ".png";
        const std::string color =
            "rgb/10." + std::to_string(85 + 33 * i).insert(0, i == 0, '0') + ".png";
        folder.write_depth(depth, 8, 6, static_cast<std::uint16_t>(1000 + i));
        depth_list += depth.substr(6, 6) + " " + depth + "\n";
        if (i == 2) continue;
        folder.write_color(color, 8, 6, {static_cast<std::uint8_t>(i), 0, 0, 255});
        color_list += color.substr(4, 6) + " " + color + "\n";
    }
    folder.write("calibration.json", kCalibration);
    if (lists) {
        folder.write("depth.txt", depth_list);
        folder.write("rgb.txt", color_list);
    }
}

std::unique_ptr<Source> open_all(const fs::path& path) {
    auto source = open_source(path.string());
    EXPECT_TRUE(source) << source.error().to_string();
    if (!source) return nullptr;
    EXPECT_TRUE(subscribe_all(**source));
    return *std::move(source);
}

std::string open_error(const fs::path& path) {
    const auto source = open_source(path.string());
    EXPECT_FALSE(source);
    return source ? "" : source.error().to_string();
}

FrameSet next_frame(Source& source) {
    auto set = source.next(0);
    EXPECT_TRUE(set) << set.error().to_string();
    EXPECT_TRUE(set && *set);
    return set && *set ? **set : FrameSet{};
}

TEST(TumFolder, PairsByTimeWithAndWithoutLists) {
    for (const bool lists : {true, false}) {
        const TestFolder folder;
        write_tum(folder, lists);
        const auto source = open_all(folder.path());
        ASSERT_TRUE(source);
        ASSERT_EQ(source->timeline()->frame_count(), 5);
        for (int i = 0; i < 5; ++i) {
            const FrameSet set = next_frame(*source);
            EXPECT_EQ(set.index, i);
            EXPECT_EQ(set.time, i * 33 * kNsPerMs);
            ASSERT_TRUE(set.depth && set.color);
            EXPECT_EQ(set.depth->header.device_time, 10 * kNsPerSecond + (100 + 33 * i) * kNsPerMs);
            EXPECT_EQ(set.depth->header.host_time, set.time);
            EXPECT_EQ(set.depth->raw.at(3, 2), 1000 + i);
            EXPECT_EQ(set.depth->metres_per_unit, 0.001);
            EXPECT_EQ(set.color_paired, i != 2);
            EXPECT_EQ(set.color->bytes[0], i == 2 ? 1 : i) << "unpaired: the last colour is kept";
            EXPECT_EQ(set.color->header.host_time, set.time - (i == 2 ? 48 : 15) * kNsPerMs);
            EXPECT_EQ(set.pose_origin, PoseOrigin::none);
            EXPECT_EQ(set.world_from_depth, world_from_camera_axes());
        }
    }
}

TEST(TumFolder, PosesComeFromTheTrajectoryAtTheFramesTime) {
    const TestFolder folder;
    write_tum(folder, true);
    folder.write("groundtruth.txt",
                 "# t x y z q\n10.090 0 0 0 0 0 0 1\nnan\n10.190 1 0 0 0 0 0 1\n");
    const auto source = open_all(folder.path());
    ASSERT_TRUE(source);
    EXPECT_THAT(source->info().note, HasSubstr("1 poses of groundtruth.txt skipped"));
    const FrameSet first = next_frame(*source);
    EXPECT_EQ(first.pose_origin, PoseOrigin::trajectory);
    EXPECT_NEAR(first.world_from_depth.translation.x, 0.1, 1e-9);
    ASSERT_TRUE(source->timeline()->seek(4));
    EXPECT_EQ(next_frame(*source).pose_origin, PoseOrigin::none) << "after the trajectory's end";
}

TEST(TumFolder, GarbageListsAreErrorsThatNameTheFile) {
    for (const char* file : {"depth.txt", "rgb.txt", "groundtruth.txt"}) {
        const TestFolder folder;
        write_tum(folder, true);
        using namespace std::string_literals;
        folder.write(file, "\x89PNG\r\n\0\0garbage \xFF\xFE\n more\n"s);
        EXPECT_THAT(open_error(folder.path()), HasSubstr(file));
    }
}

TEST(TumFolder, SomeBadLinesAreCountedInTheNote) {
    const TestFolder folder;
    write_tum(folder, true);
    folder.write("depth.txt", "10.100 depth/10.100.png\nbroken\n10.100 depth/10.133.png\n");
    const auto source = open_all(folder.path());
    ASSERT_TRUE(source);
    EXPECT_EQ(source->timeline()->frame_count(), 1);
    EXPECT_THAT(source->info().note, HasSubstr("2 entries of depth.txt skipped"));
}

TEST(TumFolder, BadCalibrationIsRefused) {
    const TestFolder folder;
    write_tum(folder, false);
    const auto with_fx = [](const std::string& fx) {
        std::string text = kCalibration;
        text.replace(text.find("\"fx\": 7"), 7, "\"fx\": " + fx);
        return text;
    };
    folder.write("calibration.json", with_fx("0"));
    EXPECT_THAT(open_error(folder.path()), HasSubstr("focal length"));
    folder.write("calibration.json", with_fx("NaN"));
    EXPECT_THAT(open_error(folder.path()), HasSubstr("calibration.json: not valid JSON"));
    folder.write("calibration.json", R"({"depth_per_metre": 0, "cameras": {}})");
    EXPECT_THAT(open_error(folder.path()), HasSubstr("depth_per_metre"));
    folder.write("calibration.json", "{}");
    EXPECT_THAT(open_error(folder.path()), HasSubstr("\"cameras\" is missing"));
}

TEST(TumFolder, WithoutCalibrationTheBenchmarksCameraIsAssumedAndSaid) {
    const TestFolder folder;
    folder.write_depth("depth/1.0.png", 320, 240, 5000);
    const auto source = open_all(folder.path());
    ASSERT_TRUE(source);
    EXPECT_THAT(source->info().note, HasSubstr("no calibration.json"));
    const auto rig = source->calibration();
    ASSERT_TRUE(rig);
    EXPECT_EQ(rig->depth.width, 320);
    EXPECT_EQ(rig->depth.fx, 262.5);
    EXPECT_FALSE(rig->color) << "there is no rgb folder";
    EXPECT_FALSE(source->subscribe(kColor));
    EXPECT_EQ(next_frame(*source).depth->metres_per_unit, 1.0 / 5000);
}

TEST(TumFolder, ADamagedFrameIsItsOwnErrorAndTheNextOneComes) {
    const TestFolder folder;
    write_tum(folder, true);
    folder.write("depth/10.133.png", std::string(200, 'x'));
    folder.write_depth("depth/10.166.png", 9, 6, 1);
    fs::remove(folder.path() / "depth/10.199.png");
    const auto source = open_all(folder.path());
    ASSERT_TRUE(source);
    EXPECT_EQ(next_frame(*source).index, 0);
    const auto garbage = source->next(0);
    ASSERT_FALSE(garbage);
    EXPECT_THAT(garbage.error().to_string(), HasSubstr("10.133.png: not a PNG file"));
    const auto size = source->next(0);
    ASSERT_FALSE(size);
    EXPECT_THAT(size.error().to_string(), HasSubstr("the image is 9x6, its calibration says 8x6"));
    const auto missing = source->next(0);
    ASSERT_FALSE(missing);
    EXPECT_THAT(missing.error().to_string(), HasSubstr("no such file"));
    EXPECT_EQ(next_frame(*source).index, 4);
    EXPECT_FALSE(*source->next(0));
}

TEST(FolderSource, AnUnsubscribedStreamsFilesAreNotRead) {
    const TestFolder folder;
    write_tum(folder, true);
    auto source = open_source(folder.path().string());
    ASSERT_TRUE(source);
    fs::remove_all(folder.path() / "rgb");
    ASSERT_TRUE((*source)->subscribe(kDepth));
    const FrameSet depth_only = next_frame(**source);
    EXPECT_TRUE(depth_only.depth);
    EXPECT_FALSE(depth_only.color);
    ASSERT_TRUE((*source)->subscribe(kColor));
    EXPECT_FALSE((*source)->next(0)) << "now the missing file is asked for";
    (*source)->unsubscribe(kColor);
    fs::remove_all(folder.path() / "depth");
    (*source)->unsubscribe(kDepth);
    const FrameSet nothing = next_frame(**source);
    EXPECT_EQ(nothing.index, 2);
    EXPECT_FALSE(nothing.depth || nothing.color);
}

TEST(FolderSource, EventsTellStartAndEveryEnd) {
    const TestFolder folder;
    write_tum(folder, true);
    const auto source = open_all(folder.path());
    ASSERT_TRUE(source);
    EXPECT_TRUE(source->take_events().empty());
    next_frame(*source);
    auto events = source->take_events();
    ASSERT_EQ(events.size(), 1u);
    EXPECT_EQ(events[0].kind, EventKind::started);
    for (int round = 0; round < 2; ++round) {
        ASSERT_TRUE(source->timeline()->seek(4));
        next_frame(*source);
        EXPECT_TRUE(source->take_events().empty());
        EXPECT_EQ(source->timeline()->position(), 5);
        EXPECT_FALSE(*source->next(0));
        EXPECT_FALSE(*source->next(0));
        events = source->take_events();
        ASSERT_EQ(events.size(), 1u);
        EXPECT_EQ(events[0].kind, EventKind::ended);
        EXPECT_EQ(events[0].time, 5 * 33 * kNsPerMs);
    }
}

TEST(FolderSource, SeekIsExactAndRefusesTheOutside) {
    const TestFolder folder;
    write_tum(folder, true);
    const auto source = open_all(folder.path());
    ASSERT_TRUE(source);
    Timeline& timeline = *source->timeline();
    for (const std::int64_t i : {3, 0, 4, 1}) {
        ASSERT_TRUE(timeline.seek(i));
        EXPECT_EQ(next_frame(*source).depth->raw.at(0, 0), 1000 + i);
        EXPECT_EQ(timeline.position(), i + 1);
    }
    for (const std::int64_t i : {-1, 5, 100}) {
        EXPECT_FALSE(timeline.seek(i));
        EXPECT_EQ(timeline.position(), 2);
    }
    EXPECT_EQ(timeline.last_frame_duration(), 33 * kNsPerMs);
}

TEST(OpenSource, SaysWhatIsWrong) {
    const TestFolder folder;
    EXPECT_THAT(open_error("no/such/place"), HasSubstr("no/such/place: no such file or folder"));
    EXPECT_THAT(open_error(folder.path()), HasSubstr("looked for: "));
    EXPECT_THAT(open_error(folder.path()), HasSubstr("TUM RGB-D folder"));
    EXPECT_THAT(open_error("martian:canals"), HasSubstr("nothing opens \"martian:\""));
    EXPECT_FALSE(open_source(""));
    EXPECT_FALSE(open_source(std::string("recordings\0", 11)));
    folder.write("depth/readme", "");
    EXPECT_THAT(open_error(folder.path()), HasSubstr("no depth frames"));
}

TEST(OpenSource, LaterOpenersAreAskedFirst) {
    const std::size_t before = source_openers().size();
    EXPECT_GE(before, 2u);
    for (const char* name : {"first", "second"}) {
        register_source({.name = name,
                         .uri_pattern = "registry-test:",
                         .probe = [](const std::string& uri) { return uri == "registry-test:"; },
                         .open = [name](const std::string&) -> Result<std::unique_ptr<Source>> {
                             return fail(name);
                         },
                         .list = nullptr});
    }
    EXPECT_EQ(source_openers().size(), before + 2);
    EXPECT_EQ(open_source("registry-test:").error().what, "second");
}

void write_described(const TestFolder& folder, const std::string& json) {
    for (const char* name : {"depth/a.png", "depth/b.png", "depth/c.png"}) {
        folder.write_depth(name, 8, 6, 700);
    }
    folder.write_color("color/b.png", 8, 6, {9, 0, 0, 255});
    folder.write("kinoscope.json", json);
}

std::string described(const std::string& rest) {
    return R"({"kinoscope": 1, "cameras": {"depth": {"width": 8, "height": 6, "fx": 7, "fy": 7,
               "cx": 3.5, "cy": 2.5}}, )" +
           rest + "}";
}

TEST(DescribedFolder, ColourBelongsToTheFrameOfTheSameName) {
    const TestFolder folder;
    write_described(folder, described(R"("name": "N", "licence": "L", "note": "R", "fps": 4,
        "depth": {"dir": "depth", "unit": "millimetres"}, "color": {"dir": "color"},
        "depth_is_registered_to_color": true, "range_m": [0.5, 4])"));
    const auto source = open_all(folder.path());
    ASSERT_TRUE(source);
    EXPECT_EQ(source->info().name, "N");
    EXPECT_EQ(source->info().licence, "L");
    EXPECT_EQ(source->info().note, "R");
    const auto rig = source->calibration();
    EXPECT_EQ(rig->color, rig->depth);
    EXPECT_EQ(rig->max_depth_m, 4);
    for (int i = 0; i < 3; ++i) {
        const FrameSet set = next_frame(*source);
        EXPECT_EQ(set.time, i * kNsPerSecond / 4);
        EXPECT_EQ(set.color != nullptr, i == 1);
        EXPECT_EQ(set.color_paired, i == 1);
    }
    EXPECT_EQ(source->timeline()->last_frame_duration(), kNsPerSecond / 4);
}

TEST(DescribedFolder, UnitsAndTimesAsStated) {
    const TestFolder folder;
    write_described(folder, described(R"("times_ns": [5, 7, 1000000007],
        "depth": {"dir": "depth", "unit": "kinect_disparity11"})"));
    auto source = open_all(folder.path());
    ASSERT_TRUE(source);
    EXPECT_EQ(source->timeline()->time_of(2), 1000000002);
    EXPECT_EQ(next_frame(*source).depth->unit, DepthUnit::kinect_disparity11);
    write_described(folder,
                    described(R"("fps": 30, "depth": {"dir": "depth", "per_metre": 5000})"));
    source = open_all(folder.path());
    ASSERT_TRUE(source);
    EXPECT_EQ(next_frame(*source).depth->metres_per_unit, 1.0 / 5000);
}

TEST(DescribedFolder, WrongDescriptionsNameTheirPlace) {
    const TestFolder folder;
    const auto error_of = [&](const std::string& json) {
        write_described(folder, json);
        return open_error(folder.path());
    };
    const std::string depth = R"("depth": {"dir": "depth", "unit": "millimetres"})";
    EXPECT_THAT(error_of("{"), HasSubstr("kinoscope.json: not valid JSON"));
    EXPECT_THAT(error_of(described(depth)), HasSubstr("\"fps\" or \"times_ns\""));
    EXPECT_THAT(error_of(described(depth + R"(, "fps": 0)")), HasSubstr("#/fps: must lie between"));
    EXPECT_THAT(error_of(described(depth + R"(, "fps": 30, "colour": 1)")),
                HasSubstr("unknown key \"colour\""));
    EXPECT_THAT(error_of(described(R"("fps": 1, "depth": {"dir": "depth", "unit": "feet"})")),
                HasSubstr("#/depth/unit: unknown unit \"feet\""));
    EXPECT_THAT(error_of(described(depth + R"(, "times_ns": [1, 1, 2])")),
                HasSubstr("#/times_ns/1: times must rise"));
    EXPECT_THAT(error_of(described(depth + R"(, "times_ns": [1, 2])")),
                HasSubstr("times_ns names 2 frames, depth holds 3"));
    EXPECT_THAT(error_of(described(depth + R"(, "fps": 1, "color": {"dir": "color"})")),
                HasSubstr("no colour camera"));
    EXPECT_THAT(error_of(described(R"("fps": 1, "depth": {"dir": "../up", "per_metre": 1})")),
                HasSubstr("leads out of the recording"));
    EXPECT_THAT(error_of(described(R"("fps": 1, "depth": {"dir": "none", "per_metre": 1})")),
                HasSubstr("none"));
    EXPECT_THAT(error_of(described(R"("clip": {"file": "a.webm", "code": "luma"})")),
                HasSubstr("\"bright_m\" is missing"));
    EXPECT_THAT(error_of(described(depth + R"(, "clip": {})")), HasSubstr("cannot be combined"));
    EXPECT_THAT(
        error_of(described(
            R"("clip": {"file": "a", "code": "luma", "scale": "freenect_viewer", "dark_m": 1})")),
        HasSubstr("#/clip/dark_m: the scale freenect_viewer has distances of its own"));
    EXPECT_THAT(error_of(described(R"("clip": {"file": "a", "code": "luma", "scale": "log"})")),
                HasSubstr("unknown scale \"log\""));
    EXPECT_THAT(error_of(described(depth + R"(, "people": "lying")")),
                HasSubstr("known: standing, seated"));
}

TEST(FolderSource, SteppingTwiceIsBitIdentical) {
    const TestFolder folder;
    write_tum(folder, true);
    folder.write("groundtruth.txt", "10 0 0 0 0.1 0.2 0.3 0.9273618\n10.4 1 2 3 0 0 0 1\n");
    const auto first = open_all(folder.path());
    const auto second = open_all(folder.path());
    ASSERT_TRUE(first && second);
    for (int i = 0; i < 5; ++i) {
        const FrameSet a = next_frame(*first);
        const FrameSet b = next_frame(*second);
        EXPECT_EQ(a.time, b.time);
        EXPECT_EQ(a.world_from_depth, b.world_from_depth);
        EXPECT_EQ(a.pose_origin, PoseOrigin::trajectory);
        EXPECT_EQ(a.depth->raw, b.depth->raw);
        EXPECT_EQ(a.color->bytes, b.color->bytes);
    }
}

}  // namespace
}  // namespace kino
