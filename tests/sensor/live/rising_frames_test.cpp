#include "sensor/live/rising_frames.h"

#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "fake_device.h"
#include "tests/support/random.h"

namespace kino {
namespace {

using test::fake_frame;
using test::header_of;

constexpr StreamId kDepth{0, StreamKind::depth};
constexpr StreamId kColor{0, StreamKind::color};

const void* address(const StreamFrame& frame) {
    return std::visit([](const auto& f) { return static_cast<const void*>(f.get()); }, frame);
}

StreamFrame depth_frame(std::int64_t sequence, TimeNs host, TimeNs device, std::int64_t lost) {
    auto frame = std::make_shared<DepthFrame>();
    frame->header = {device, host, sequence, lost};
    frame->raw = Image<std::uint16_t>(2, 2);
    frame->raw.at(1, 1) = 77;
    frame->damaged_rows = {{1, 1}};
    return std::shared_ptr<const DepthFrame>(std::move(frame));
}

TEST(RisingFrames, WhatRisesByItselfIsNotCopied) {
    RisingFrames rising;
    for (int i = 0; i < 10; ++i) {
        const StreamFrame frame = fake_frame(StreamKind::depth, i * 2, i * 10 + 5, 3);
        EXPECT_EQ(address(rising.pass(kDepth, frame)), address(frame));
    }
}

TEST(RisingFrames, WhateverComesRisesAndKeepsItsPixels) {
    test::Random random(4);
    RisingFrames rising;
    FrameHeader last{-1, -1, -1, 0};
    for (int i = 0; i < 2000; ++i) {
        if (random.chance(0.05)) rising.begin_epoch();
        const auto passed =
            rising.pass(kDepth, depth_frame(random.integer(0, 50), random.integer(0, 1000),
                                            random.integer(0, 1000), random.integer(0, 3)));
        const auto& depth = *std::get<std::shared_ptr<const DepthFrame>>(passed);
        if (i > 0) {
            ASSERT_GT(depth.header.sequence, last.sequence);
            ASSERT_GT(depth.header.host_time, last.host_time);
            ASSERT_GT(depth.header.device_time, last.device_time);
        }
        ASSERT_EQ(depth.raw.at(1, 1), 77);
        ASSERT_EQ(depth.damaged_rows.size(), 1u);
        last = depth.header;
    }
}

TEST(RisingFrames, TheSequenceGoesOnByOneAndWhatWasLost) {
    RisingFrames rising;
    (void)rising.pass(kDepth, depth_frame(41, 100, 100, 0));
    rising.begin_epoch();
    EXPECT_EQ(header_of(rising.pass(kDepth, depth_frame(0, 500, 0, 2))).sequence, 44);
    EXPECT_EQ(header_of(rising.pass(kDepth, depth_frame(1, 530, 30, 0))).sequence, 45);
    EXPECT_EQ(header_of(rising.pass(kDepth, depth_frame(4, 560, 60, 2))).sequence, 48);
}

TEST(RisingFrames, DeviceTimeGoesOnByWhatTheHostSaysAndAlikeForAllStreams) {
    RisingFrames rising;
    (void)rising.pass(kDepth, fake_frame(StreamKind::depth, 0, 1000, 900));
    (void)rising.pass(kColor, fake_frame(StreamKind::color, 0, 1010, 900));
    rising.begin_epoch();
    const auto depth = header_of(rising.pass(kDepth, fake_frame(StreamKind::depth, 0, 5000, 5000)));
    const auto color = header_of(rising.pass(kColor, fake_frame(StreamKind::color, 0, 5007, 5000)));
    EXPECT_EQ(depth.device_time, 110 + 3990);
    EXPECT_EQ(color.device_time - depth.device_time, 7);
}

TEST(RisingFrames, BodiesHaveATimeOnly) {
    constexpr StreamId kBodies{0, StreamKind::bodies};
    RisingFrames rising;
    const auto bodies = [](TimeNs time) {
        return StreamFrame(std::make_shared<const BodyFrame>(BodyFrame{time, {}}));
    };
    const StreamFrame first = bodies(10);
    const StreamFrame second = bodies(20);
    EXPECT_EQ(address(rising.pass(kBodies, first)), address(first));
    EXPECT_EQ(address(rising.pass(kBodies, second)), address(second));
    EXPECT_EQ(header_of(rising.pass(kBodies, bodies(15))).host_time, 21);
}

}  // namespace
}  // namespace kino
