#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <functional>
#include <random>

#include "sensor/clip_depth.h"
#include "sensor/clip_video.h"
#include "sensor/file_bytes.h"
#include "sensor/source.h"
#include "test_folder.h"

namespace kino {
namespace {

using ::testing::HasSubstr;
namespace fs = std::filesystem;

constexpr const char* kPerson = "recordings/person/kinect_0_20s.webm";

/// The ramp black, blue, cyan, white at v in 0..1 as limited-range BT.601, in double.
struct Yuv {
    double y = 0, u = 0, v = 0;
};
Yuv ramp_color(double v) {
    const double b = std::clamp(3 * v, 0.0, 1.0);
    const double g = std::clamp(3 * v - 1, 0.0, 1.0);
    const double r = std::clamp(3 * v - 2, 0.0, 1.0);
    const double luma = 0.299 * r + 0.587 * g + 0.114 * b;
    return {16 + 219 * luma, 128 + 224 * (b - luma) / 1.772, 128 + 224 * (r - luma) / 1.402};
}

std::uint8_t to_byte(double v) {
    return static_cast<std::uint8_t>(std::lround(v));
}

YuvPicture picture_of(int width, int height, const std::function<double(int, int)>& v_at) {
    YuvPicture picture{Image<std::uint8_t>(width, height),
                       Image<std::uint8_t>((width + 1) / 2, (height + 1) / 2),
                       Image<std::uint8_t>((width + 1) / 2, (height + 1) / 2)};
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const Yuv c = ramp_color(v_at(x, y));
            picture.y.at(x, y) = to_byte(c.y);
            picture.u.at(x / 2, y / 2) = to_byte(c.u);
            picture.v.at(x / 2, y / 2) = to_byte(c.v);
        }
    }
    return picture;
}

ClipDescription kinect_clip() {
    return {.file = "a.webm",
            .code = ClipCode::rgb_sum,
            .bright_m = 0.85,
            .dark_m = 4.0,
            .invalid_below = 0.05};
}

double metres(std::uint16_t raw) {
    return raw / kClipUnitsPerMetre;
}

TEST(ClipDepth, EvenColoursOfTheRampComeBackAsTheirDepth) {
    ClipDepth decoder(kinect_clip());
    Image<std::uint16_t> depth;
    for (double v = 0.07; v < 1.0; v += 0.013) {
        decoder.decode(picture_of(16, 12, [&](int, int) { return v; }), depth);
        // Luma and chroma in whole steps leave at most two levels of 765 in doubt.
        const double step = (4.0 - 0.85) / 765;
        EXPECT_NEAR(metres(depth.at(8, 6)), 4.0 - v * 3.15, 2.5 * step) << v;
    }
}

TEST(ClipDepth, TheViewersColoursAreUndoneToItsDisparity) {
    ClipDescription clip = kinect_clip();
    clip.scale = ClipScale::freenect_viewer;
    ClipDepth decoder(clip);
    Image<std::uint16_t> depth;
    for (double raw = 500; raw <= 860; raw += 12) {
        // Forwards, as the viewer has it: its step along the ramp, 256 for each colour change.
        const double step = std::pow(raw / 2048, 3) * 36 * 256;
        const double v = 1 - step / 768;
        decoder.decode(picture_of(16, 12, [&](int, int) { return v; }), depth);
        const auto metres_of = [](double r) { return 0.1236 * std::tan(r / 2842.5 + 1.1863); };
        // Two and a half levels of 765 along the ramp, in steps of disparity there.
        const double per_raw = 3 * std::pow(raw / 2048, 2) * 36 * 256 / 2048;
        const double slack = metres_of(raw + 2.5 * 768 / 765 / per_raw) - metres_of(raw);
        EXPECT_NEAR(metres(depth.at(8, 6)), metres_of(raw), slack + 2e-4) << raw;
    }
}

TEST(ClipDepth, LumaCodeCountsLimitedRange) {
    ClipDescription clip = kinect_clip();
    clip.code = ClipCode::luma;
    ClipDepth decoder(clip);
    YuvPicture picture{Image<std::uint8_t>(8, 8, 235), Image<std::uint8_t>(4, 4, 128),
                       Image<std::uint8_t>(4, 4, 128)};
    Image<std::uint16_t> depth;
    decoder.decode(picture, depth);
    EXPECT_NEAR(metres(depth.at(4, 4)), 0.85, 1e-3);
    picture.y.fill(16);
    decoder.decode(picture, depth);
    EXPECT_EQ(depth.at(4, 4), 0) << "black is no reading";
}

TEST(ClipDepth, NearBlackIsNoReadingEverywhere) {
    ClipDepth decoder(kinect_clip());
    Image<std::uint16_t> depth;
    decoder.decode(picture_of(17, 13, [](int, int) { return 0.03; }), depth);
    for (const std::uint16_t raw : depth.pixels()) EXPECT_EQ(raw, 0);
}

TEST(ClipDepth, SmearBetweenTwoSurfacesIsDropped) {
    // Near surface on the left, far on the right, and a blurred column pair between.
    const auto v_at = [](int x, int) { return x < 20 ? 0.6 : x < 22 ? 0.4 : 0.2; };
    ClipDepth decoder(kinect_clip());
    Image<std::uint16_t> depth;
    decoder.decode(picture_of(40, 20, v_at), depth);
    for (int y = 0; y < 20; ++y) {
        for (int x = 0; x < 40; ++x) {
            const double z = metres(depth.at(x, y));
            if (x < 18) {
                EXPECT_NEAR(z, 4.0 - 0.6 * 3.15, 0.02) << x;
            }
            if (x == 20 || x == 21) {
                EXPECT_EQ(z, 0) << x;
            }
            if (x >= 24) {
                EXPECT_NEAR(z, 4.0 - 0.2 * 3.15, 0.02) << x;
            }
            EXPECT_FALSE(z > 2.2 && z < 3.3) << "a false depth at " << x;
        }
    }
}

TEST(ClipDepth, NothingFloatsBetweenASurfaceAndBlack) {
    const auto v_at = [](int x, int) { return x < 20 ? 0.6 : x < 22 ? 0.12 : 0.0; };
    ClipDepth decoder(kinect_clip());
    Image<std::uint16_t> depth;
    decoder.decode(picture_of(40, 20, v_at), depth);
    for (int y = 0; y < 20; ++y) {
        for (int x = 20; x < 40; ++x) EXPECT_EQ(depth.at(x, y), 0) << x;
        EXPECT_NEAR(metres(depth.at(10, y)), 4.0 - 0.6 * 3.15, 0.02);
    }
}

TEST(ClipDepth, SmoothingNeitherMakesNorLosesPixelsAndKeepsEdges) {
    std::mt19937 random(3);
    Image<std::uint16_t> rough;
    Image<std::uint16_t> smooth;
    const YuvPicture picture = picture_of(64, 48, [&](int x, int y) {
        const double noise = static_cast<double>(random() % 1000) * 1e-5;
        return (x + y < 50 ? 0.55 : 0.40) + noise;
    });
    ClipDescription clip = kinect_clip();
    ClipDepth(clip).decode(picture, smooth);
    clip.smooth_span = 0;
    ClipDepth(clip).decode(picture, rough);
    for (int y = 0; y < 48; ++y) {
        for (int x = 0; x < 64; ++x) {
            EXPECT_EQ(smooth.at(x, y) == 0, rough.at(x, y) == 0);
            EXPECT_NEAR(metres(smooth.at(x, y)), metres(rough.at(x, y)), 0.015 * 3.15 + 0.001);
        }
    }
}

TEST(ClipDepth, OddAndTinySizesWork) {
    ClipDepth decoder(kinect_clip());
    Image<std::uint16_t> depth;
    for (const auto& [w, h] :
         {std::pair(1, 1), std::pair(2, 1), std::pair(1, 7), std::pair(5, 3)}) {
        decoder.decode(picture_of(w, h, [](int, int) { return 0.5; }), depth);
        EXPECT_EQ(depth.width(), w);
        EXPECT_NEAR(metres(depth.at(w - 1, h - 1)), 4.0 - 0.5 * 3.15, 0.02);
    }
}

TEST(ClipVideo, AnyOrderGivesTheSamePictures) {
    auto forward = ClipVideo::open(kPerson);
    ASSERT_TRUE(forward) << forward.error().to_string();
    ASSERT_EQ(forward->frame_count(), 285);
    constexpr std::int64_t kCount = 60;
    std::vector<std::shared_ptr<const YuvPicture>> expected;
    for (std::int64_t i = 0; i < kCount; ++i) {
        expected.push_back(*forward->picture(i));
        if (i > 0) {
            EXPECT_GT(forward->time_of(i), forward->time_of(i - 1));
        }
    }
    const auto check = [&](ClipVideo& video, std::int64_t i) {
        const auto picture = video.picture(i);
        ASSERT_TRUE(picture);
        const auto& want = expected[static_cast<std::size_t>(i)];
        ASSERT_TRUE((*picture)->y == want->y && (*picture)->u == want->u &&
                    (*picture)->v == want->v)
            << i;
    };
    auto backward = *ClipVideo::open(kPerson);
    for (std::int64_t i = kCount; i-- > 0;) check(backward, i);
    auto jumping = *ClipVideo::open(kPerson);
    std::mt19937 random(8);
    for (int i = 0; i < 60; ++i) {
        // Far jumps drop what was kept, so that frames are decoded anew.
        ASSERT_TRUE(jumping.picture(kCount + static_cast<std::int64_t>(random() % 225)));
        check(jumping, static_cast<std::int64_t>(random() % kCount));
    }
}

TEST(ClipVideo, OtherFilesAreClearErrors) {
    const test::TestFolder folder;
    EXPECT_EQ(ClipVideo::open("no/such.webm").error().what, "no such file");
    const auto garbage = ClipVideo::open(folder.write("a.webm", std::string(5000, 'x')));
    ASSERT_FALSE(garbage);
    EXPECT_THAT(garbage.error().what, HasSubstr("not a WebM video"));
    EXPECT_FALSE(ClipVideo::open(folder.write("b.webm", "")));
}

TEST(ClipVideo, ACutOffFileStillGivesTheFramesItHolds) {
    const test::TestFolder folder;
    const std::string whole = *read_file_text(kPerson, std::size_t{1} << 24);
    auto cut = ClipVideo::open(folder.write("cut.webm", whole.substr(0, whole.size() / 3)));
    ASSERT_TRUE(cut) << cut.error().to_string();
    EXPECT_GT(cut->frame_count(), 50);
    EXPECT_LT(cut->frame_count(), 200);
    auto full = *ClipVideo::open(kPerson);
    EXPECT_EQ((*cut->picture(49))->y, (*full.picture(49))->y);
}

TEST(ClipVideo, ADamagedPacketDoesNotChangeWhatASeekGives) {
    const test::TestFolder folder;
    std::string bytes = *read_file_text(kPerson, std::size_t{1} << 24);
    std::mt19937 random(2);
    for (int i = 0; i < 40; ++i) {
        bytes[1000 + random() % (bytes.size() - 1000)] = static_cast<char>(random());
    }
    const fs::path path = folder.write("hurt.webm", bytes);
    auto forward = ClipVideo::open(path);
    auto backward = ClipVideo::open(path);
    if (!forward) GTEST_SKIP() << "the damage hit the container: " << forward.error().to_string();
    const std::int64_t count = std::min<std::int64_t>(forward->frame_count(), 100);
    std::vector<Result<std::shared_ptr<const YuvPicture>>> seen;
    for (std::int64_t i = 0; i < count; ++i) seen.push_back(forward->picture(i));
    for (std::int64_t i = count; i-- > 0;) {
        const auto again = backward->picture(i);
        const auto& before = seen[static_cast<std::size_t>(i)];
        ASSERT_EQ(again.has_value(), before.has_value()) << i;
        if (again) {
            EXPECT_EQ((*again)->y, (*before)->y) << i;
        }
    }
}

}  // namespace
}  // namespace kino
