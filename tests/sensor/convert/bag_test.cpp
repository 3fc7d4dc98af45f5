#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bag_bytes.h"
#include "recordings.h"
#include "sensor/convert/bag_import.h"
#include "sensor/convert/bag_unpack.h"

namespace kino {
namespace {

using test::BagBytes;
using test::BagPacking;
using test::make_bag;
using test::read_all;
using testing::HasSubstr;
using testing::IsEmpty;

using Bytes = std::vector<std::uint8_t>;

Result<std::unique_ptr<Source>> open(const Bytes& bytes) {
    return make_bag_source(test::owned_bytes(bytes), "test.bag");
}

void expect_frames(const std::vector<FrameSet>& sets, int count) {
    ASSERT_EQ(sets.size(), static_cast<std::size_t>(count));
    for (int i = 0; i < count; ++i) {
        const FrameSet& set = sets[static_cast<std::size_t>(i)];
        ASSERT_TRUE(set.depth && set.color);
        EXPECT_EQ(set.time, test::bag_depth_time(i) - test::bag_depth_time(0));
        EXPECT_EQ(set.depth->header.device_time, test::bag_depth_stamp(i));
        EXPECT_EQ(set.depth->header.sequence, 169 + i);
        EXPECT_EQ(set.color->header.host_time, set.time + 5'000'000);
        EXPECT_TRUE(set.color_paired);
        EXPECT_EQ(set.depth->metres_per_unit, 0.001);
        for (std::size_t p = 0; p < set.depth->raw.size(); ++p) {
            ASSERT_EQ(set.depth->raw.data()[p], test::bag_depth(p, i));
        }
        for (std::size_t b = 0; b < set.color->bytes.size(); ++b) {
            ASSERT_EQ(set.color->bytes[b], test::bag_color(b, i));
        }
    }
}

TEST(BagImport, FramesAreThoseOfAnIndependentWriter) {
    for (const BagPacking packing : {BagPacking::none, BagPacking::lz4, BagPacking::bz2}) {
        auto source = open(make_bag({.packing = packing}));
        ASSERT_TRUE(source) << source.error().to_string();
        EXPECT_THAT((*source)->info().note, IsEmpty());
        EXPECT_EQ((*source)->info().name, "Hand-made D435");
        EXPECT_EQ((*source)->info().serial, "728");
        expect_frames(read_all(**source), 4);
    }
}

TEST(BagImport, CamerasAreThoseOfTheFile) {
    auto source = open(make_bag({}));
    ASSERT_TRUE(source);
    const RigParameters rig = *(*source)->calibration();
    const CameraModel expected{.width = 24,
                               .height = 10,
                               .fx = 20,
                               .fy = 21,
                               .cx = 11.75,
                               .cy = 5,
                               .k1 = 0.1,
                               .k2 = -0.2,
                               .k3 = 0.05,
                               .p1 = 0.003,
                               .p2 = 0.004};
    EXPECT_EQ(rig.depth, expected);
    ASSERT_TRUE(rig.color);
    EXPECT_EQ(rig.color->fx, 15);
    const glm::dvec3 p = rig.color_from_depth * glm::dvec3(1, 0, 0);
    EXPECT_NEAR(p.x, 0.015, 1e-12);
    EXPECT_NEAR(p.y, 1, 1e-12);
    EXPECT_NEAR(p.z, -0.001, 1e-12);
    auto other = open(make_bag({.model = "Inverse Brown Conrady"}));
    ASSERT_TRUE(other);
    EXPECT_FALSE((*other)->calibration()->depth.has_distortion());
    EXPECT_THAT((*other)->info().note, HasSubstr("Inverse Brown Conrady"));
}

TEST(BagImport, UnindexedBagsAreLookedThrough) {
    for (const BagPacking packing : {BagPacking::none, BagPacking::lz4, BagPacking::bz2}) {
        for (const bool records : {true, false}) {
            auto source = open(
                make_bag({.packing = packing, .indexed = false, .with_index_records = records}));
            ASSERT_TRUE(source) << source.error().to_string();
            EXPECT_THAT((*source)->info().note, HasSubstr("never closed"));
            expect_frames(read_all(**source), 4);
        }
    }
}

TEST(BagImport, AChunkThatWasBeingFilledIsRead) {
    auto source = open(make_bag({.indexed = false, .frames_a_chunk = 0}));
    ASSERT_TRUE(source) << source.error().to_string();
    expect_frames(read_all(**source), 4);
}

TEST(BagImport, CutOffBagsPlayWhatIsWhole) {
    for (const BagPacking packing : {BagPacking::none, BagPacking::lz4}) {
        const Bytes whole = make_bag({.packing = packing, .indexed = false});
        std::size_t last = 0;
        std::size_t step = 97;
        for (std::size_t size = 0; size < whole.size(); size += step) {
            auto source =
                open(Bytes(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size)));
            if (!source) {
                EXPECT_EQ(last, 0u) << size;
                EXPECT_THAT(source.error().what, testing::Not(IsEmpty()));
                continue;
            }
            const std::size_t frames = read_all(**source).size();
            EXPECT_GE(frames, last) << size;
            last = frames;
        }
        EXPECT_EQ(last, 4u);
    }
}

TEST(BagImport, ColourEncodings) {
    const auto first = [](const char* encoding) {
        auto source = open(make_bag({.frames = 1, .color_encoding = encoding}));
        EXPECT_TRUE(source);
        return read_all(**source).front().color;
    };
    const auto bgr = first("bgr8");
    EXPECT_EQ(bgr->format, PixelFormat::rgb8);
    EXPECT_EQ(bgr->bytes[0], test::bag_color(2, 0));
    EXPECT_EQ(bgr->bytes[1], test::bag_color(1, 0));
    EXPECT_EQ(bgr->bytes[5], test::bag_color(3, 0));
    const auto bgra = first("bgra8");
    EXPECT_EQ(bgra->format, PixelFormat::rgba8);
    EXPECT_EQ(bgra->bytes[0], test::bag_color(2, 0));
    EXPECT_EQ(bgra->bytes[3], test::bag_color(3, 0));
    const auto yuyv = first("YUYV");
    EXPECT_EQ(yuyv->format, PixelFormat::yuyv);
    EXPECT_EQ(yuyv->bytes[7], test::bag_color(7, 0));
}

TEST(BagImport, WhatIsWrongIsSaid) {
    const auto problem = [](const Bytes& bytes) {
        const auto source = open(bytes);
        return source ? std::string("none") : source.error().to_string();
    };
    EXPECT_THAT(problem(Bytes(50, 'x')), HasSubstr("not a ROS bag"));
    EXPECT_THAT(problem(make_bag({.frames = 0})), HasSubstr("no depth pictures of librealsense"));
    Bytes packed = make_bag({});
    const std::string text(packed.begin(), packed.end());
    const std::size_t at = text.find("compression=none");
    packed[at + 12] = 'z';
    EXPECT_THAT(problem(packed), HasSubstr("\"zone\""));
    auto source = open(make_bag({.depth_unit = -1}));
    ASSERT_TRUE(source);
    EXPECT_THAT((*source)->info().note, HasSubstr("1 mm is assumed"));
}

TEST(BagImport, DepthUnitsAreTheDecimalNumbersThatWereMeant) {
    auto source = open(make_bag({.frames = 1, .depth_unit = 0.0001f}));
    ASSERT_TRUE(source);
    EXPECT_EQ(read_all(**source).front().depth->metres_per_unit, 0.0001);
}

TEST(BagImport, ATapSeesEveryFrameOnce) {
    auto source = open(make_bag({}));
    ASSERT_TRUE(source);
    std::vector<TimeNs> depth;
    std::vector<TimeNs> color;
    ASSERT_TRUE((*source)->set_tap([&](StreamId id, const StreamFrame& frame) {
        if (id.kind == StreamKind::depth) depth.push_back(std::get<0>(frame)->header.host_time);
        if (id.kind == StreamKind::color) color.push_back(std::get<1>(frame)->header.host_time);
    }));
    (void)read_all(**source);
    ASSERT_EQ(depth.size(), 4u);
    ASSERT_EQ(color.size(), 4u);
    for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(color[i], depth[i] + 5'000'000);
}

TEST(BagUnpacking, RefusesMoreThanItWasPromised) {
    // 40 MB of zeros in a few bytes.
    const BagBytes bag{.width = 4000, .height = 1000, .frames = 1, .packing = BagPacking::lz4};
    const Bytes bytes = make_bag(bag);
    EXPECT_TRUE(open(bytes));
    const Bytes nothing;
    EXPECT_FALSE(unpack_lz4(nothing, 10, false));
    EXPECT_TRUE(unpack_lz4(nothing, 10, true));
    EXPECT_FALSE(unpack_bz2(nothing, 10, false));
    EXPECT_FALSE(unpack_lz4(Bytes(100, 0xAB), 10, false));
    EXPECT_FALSE(unpack_bz2(Bytes(100, 0xAB), 10, false));
    // A chunk that says it has less than comes out.
    Bytes lying = bytes;
    const std::string text(lying.begin(), lying.end());
    const std::size_t at = text.find("size=") + 5;
    lying[at] = 10;
    lying[at + 1] = lying[at + 2] = lying[at + 3] = 0;
    EXPECT_FALSE(open(lying));
    // An LZ4 frame of one plain block: magic, flags, sizes, checksum, block, end.
    const Bytes plain{0x04, 0x22, 0x4D, 0x18, 0x60, 0x40, 0x82, 4, 0, 0,
                      0x80, 1,    2,    3,    4,    0,    0,    0, 0};
    EXPECT_EQ(unpack_lz4(plain, 4, false).value_or(Bytes{}), (Bytes{1, 2, 3, 4}));
    const auto more = unpack_lz4(plain, 3, false);
    ASSERT_FALSE(more);
    EXPECT_THAT(more.error().what, HasSubstr("more than it says"));
    EXPECT_FALSE(unpack_lz4(plain, 3, true));
    EXPECT_FALSE(unpack_lz4(plain, 5, false));
}

}  // namespace
}  // namespace kino
