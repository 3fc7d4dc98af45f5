#include "sensor/v4l2/capture_loop.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cerrno>

#include "capture_session.h"
#include "tests/support/random.h"

namespace kino {
namespace {

using test::CaptureSession;
using test::FakeArrival;
using test::FakeCamera;
using test::FakeVideoSystem;
using test::random_bytes;
using testing::HasSubstr;

constexpr int kWidth = 8;
constexpr int kHeight = 6;
constexpr std::size_t kWhole = kWidth * kHeight * 2;
const FakeVideoSystem::Held kNothing{};

std::vector<std::uint16_t> words(const std::vector<std::uint8_t>& bytes) {
    std::vector<std::uint16_t> out(bytes.size() / 2);
    for (std::size_t i = 0; i < out.size(); ++i)
        out[i] = static_cast<std::uint16_t>(bytes[2 * i] + 256 * bytes[2 * i + 1]);
    return out;
}

TEST(CaptureLoop, EveryFrameArrivesOnceBitByBitInOrder) {
    for (const std::uint32_t buffers : {0u, 1u, 2u, 3u, 7u, 32u}) {
        FakeCamera camera;
        camera.buffers = buffers;
        camera.row_padding = 6;
        camera.tail_padding = 100;
        const auto system = std::make_shared<FakeVideoSystem>(camera);
        std::vector<std::vector<std::uint8_t>> sent;
        for (std::uint64_t i = 0; i < 20; ++i) {
            sent.push_back(random_bytes(kWhole + 6 * kHeight + 100, i));
            system->arrive({.bytes = sent.back()});
        }
        CaptureSession session;
        session.run(system);
        ASSERT_EQ(session.error, "");
        const auto frames = session.intake.all<InfraredFrame>();
        ASSERT_EQ(frames.size(), 20u) << buffers << " buffers";
        for (std::size_t i = 0; i < frames.size(); ++i) {
            for (int y = 0; y < kHeight; ++y) {
                const auto begin = sent[i].begin() + y * (2 * kWidth + 6);
                const auto row = words({begin, begin + 2 * kWidth});
                EXPECT_TRUE(std::equal(row.begin(), row.end(), frames[i]->raw.row(y)));
            }
            EXPECT_EQ(frames[i]->header.sequence, static_cast<std::int64_t>(i));
            EXPECT_EQ(frames[i]->header.lost_before, 0);
            EXPECT_TRUE(frames[i]->damaged_rows.empty());
            if (i > 0) {
                EXPECT_GT(frames[i]->header.host_time, frames[i - 1]->header.host_time);
                EXPECT_NEAR(
                    to_ms(frames[i]->header.device_time - frames[i - 1]->header.device_time),
                    1000.0 / 30, 0.5);
            }
        }
        EXPECT_EQ(system->held(), kNothing);
        EXPECT_EQ(system->misuses(), 0);
    }
}

/// Law: whatever is lost or broken, sequence numbers count what the camera took, lost_before is
/// the difference, and together they account for every frame.
TEST(CaptureLoop, LossesAreAccountedForExactlyInRandomPatterns) {
    test::Random random(7);
    for (int round = 0; round < 60; ++round) {
        FakeCamera camera;
        camera.bus = random.chance(0.5) ? "usb-1" : "platform:x";
        camera.buffers = static_cast<std::uint32_t>(random.integer(1, 6));
        const auto system = std::make_shared<FakeVideoSystem>(camera);
        struct Sent {
            std::vector<std::uint8_t> bytes;
            std::int64_t number;
            std::size_t arrived;
        };
        std::vector<Sent> expected;
        std::int64_t number = 0;
        // The first buffer of all has no predecessor that a gap could be counted from.
        for (int i = 0; i < 40; ++i) {
            FakeArrival next{.bytes = random_bytes(kWhole, random.bits())};
            if (i > 0 && random.chance(0.2))
                next.skipped = static_cast<std::uint32_t>(random.integer(1, 5));
            number += next.skipped;
            const bool bad = random.chance(0.15);
            if (bad) next.flags |= V4L2_BUF_FLAG_ERROR;
            const std::size_t arrived =
                random.chance(0.25) ? static_cast<std::size_t>(random.integer(0, int{kWhole} - 1))
                                    : kWhole;
            next.bytesused = static_cast<std::uint32_t>(arrived);
            const bool usable =
                arrived == kWhole || (camera.bus[0] == 'p' && arrived >= 2 * kWidth);
            if (!bad && usable) expected.push_back({next.bytes, number, arrived});
            ++number;
            system->arrive(std::move(next));
        }
        CaptureSession session;
        session.run(system);
        const auto frames = session.intake.all<InfraredFrame>();
        ASSERT_EQ(frames.size(), expected.size());
        std::int64_t next = 0;
        for (std::size_t i = 0; i < frames.size(); ++i) {
            const auto& frame = *frames[i];
            ASSERT_EQ(frame.header.sequence, expected[i].number);
            ASSERT_EQ(frame.header.lost_before, expected[i].number - next);
            next = expected[i].number + 1;
            const auto whole_rows = static_cast<int>(expected[i].arrived / (2 * kWidth));
            std::vector<RowRange> damaged;
            if (whole_rows < kHeight) damaged = {{whole_rows, kHeight - whole_rows}};
            ASSERT_EQ(frame.damaged_rows, damaged);
            const auto sent = words(expected[i].bytes);
            for (std::size_t p = 0; p < sent.size(); ++p)
                ASSERT_EQ(frame.raw.pixels()[p], 2 * p + 2 <= expected[i].arrived ? sent[p] : 0);
        }
        EXPECT_EQ(system->held(), kNothing);
    }
}

TEST(CaptureLoop, TimestampsOfAnotherClockGiveWayToTheMomentOfTaking) {
    const auto system = std::make_shared<FakeVideoSystem>();
    system->arrive(
        {.bytes = random_bytes(kWhole, 1), .flags = V4L2_BUF_FLAG_TIMESTAMP_UNKNOWN, .stamp = 5});
    system->arrive({.bytes = random_bytes(kWhole, 2), .stamp = 0});
    system->arrive({.bytes = random_bytes(kWhole, 3), .stamp = 99999 * kNsPerSecond});
    system->arrive({.bytes = random_bytes(kWhole, 4), .stamp = 3 * kNsPerSecond});
    CaptureSession session;
    session.run(system);
    const auto frames = session.intake.all<InfraredFrame>();
    ASSERT_EQ(frames.size(), 4u);
    TimeNs last = 1000 * kNsPerSecond;
    for (const auto& frame : frames) {
        EXPECT_GT(frame->header.host_time, last);
        EXPECT_LT(frame->header.host_time, 1001 * kNsPerSecond);
        EXPECT_EQ(frame->header.device_time, frame->header.host_time);
        last = frame->header.host_time;
    }
}

TEST(CaptureLoop, AStallStartsStreamingAnewAndCountsWhatTheRateWouldHaveGiven) {
    FakeCamera camera;
    camera.has_rate = true;  // 30 Hz
    const auto system = std::make_shared<FakeVideoSystem>(camera);
    system->arrive({.bytes = random_bytes(kWhole, 1)});
    system->arrive({.kind = FakeArrival::Kind::stall});
    system->arrive({.bytes = random_bytes(kWhole, 2)});
    CaptureSession session;
    session.run(system);
    const auto frames = session.intake.all<InfraredFrame>();
    ASSERT_EQ(frames.size(), 2u);
    EXPECT_EQ(system->count("VIDIOC_STREAMON"), 2);
    EXPECT_EQ(frames[1]->header.lost_before, 30);  // one second, and a period until the next
    EXPECT_EQ(frames[1]->header.sequence, 31);
    EXPECT_TRUE(session.intake.losses().empty());
    EXPECT_EQ(system->held(), kNothing);
}

TEST(CaptureLoop, StallsWithoutEndAreReportedAsALostDeviceOnce) {
    const auto system = std::make_shared<FakeVideoSystem>();
    for (int i = 0; i < 50; ++i) system->arrive({.kind = FakeArrival::Kind::stall});
    CaptureSession session;
    session.run(system);
    ASSERT_EQ(session.intake.losses().size(), 1u);
    EXPECT_THAT(session.intake.losses()[0], HasSubstr("/dev/video0: no buffer for 1.0 s"));
    EXPECT_EQ(system->count("VIDIOC_STREAMON"), 4);
    EXPECT_EQ(system->held(), kNothing);
}

TEST(CaptureLoop, BuffersThatAreAllFlaggedBadStartStreamingAnewAfterAWhile) {
    const auto system = std::make_shared<FakeVideoSystem>();
    for (int i = 0; i < 160; ++i)
        system->arrive({.bytes = random_bytes(kWhole, 1),
                        .flags = V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC | V4L2_BUF_FLAG_ERROR});
    system->arrive({.bytes = random_bytes(kWhole, 2)});
    CaptureSession session;
    session.run(system);
    EXPECT_EQ(system->count("VIDIOC_STREAMON"), 2);
    EXPECT_EQ(session.intake.frames().size(), 1u);
}

TEST(CaptureLoop, AnEioMayTakeABufferWithItWhichIsQueuedAgain) {
    FakeCamera camera;
    camera.buffers = 2;
    const auto system = std::make_shared<FakeVideoSystem>(camera);
    // Without the strays being found, two of these would leave no buffer at all.
    for (std::uint64_t i = 0; i < 10; ++i) {
        system->arrive({.kind = FakeArrival::Kind::stray});
        system->arrive({.bytes = random_bytes(kWhole, i)});
    }
    CaptureSession session;
    session.run(system);
    const auto frames = session.intake.all<InfraredFrame>();
    ASSERT_EQ(frames.size(), 10u);
    EXPECT_EQ(system->count("VIDIOC_STREAMON"), 1);
    EXPECT_EQ(frames[9]->header.lost_before, 1);
    EXPECT_EQ(frames[9]->header.sequence, 18);  // the first stray came before anything was counted
}

TEST(CaptureLoop, ThreeEiosInARowStartStreamingAnew) {
    const auto system = std::make_shared<FakeVideoSystem>();
    system->arrive({.bytes = random_bytes(kWhole, 1)});
    system->fault_named("VIDIOC_DQBUF", EIO, 3);
    system->arrive({.bytes = random_bytes(kWhole, 2)});
    CaptureSession session;
    session.run(system);
    EXPECT_EQ(system->count("VIDIOC_STREAMON"), 2);
    EXPECT_TRUE(session.intake.losses().empty());
    EXPECT_EQ(system->held(), kNothing);
}

TEST(CaptureLoop, PollerrAloneIsNoUnplugging) {
    const auto system = std::make_shared<FakeVideoSystem>();
    for (std::uint64_t i = 0; i < 5; ++i) {
        system->arrive({.kind = FakeArrival::Kind::error});
        system->arrive({.bytes = random_bytes(kWhole, i)});
    }
    CaptureSession session;
    session.run(system);
    EXPECT_EQ(session.intake.frames().size(), 5u);
    EXPECT_TRUE(session.intake.losses().empty());
    EXPECT_EQ(system->count("VIDIOC_STREAMON"), 1);
}

TEST(CaptureLoop, PollhupIsUnpluggingAndSaidOnceAndForAll) {
    const auto system = std::make_shared<FakeVideoSystem>();
    system->arrive({.bytes = random_bytes(kWhole, 1)});
    system->arrive({.kind = FakeArrival::Kind::hang_up});
    auto device = v4l2_driver(system).open("");
    ASSERT_TRUE(device.has_value());
    const StreamId id = (*device)->info().streams.front().id;
    test::CollectingIntake intake;
    ASSERT_TRUE((*device)->start(id, intake).has_value());
    system->wait_idle([&] { return intake.is_lost(); });
    (*device)->stop(id);
    (*device)->stop(id);
    ASSERT_EQ(intake.losses().size(), 1u);
    EXPECT_THAT(intake.losses()[0], HasSubstr("unplugged"));
    EXPECT_EQ(intake.frames().size(), 1u);
    // Plugged in again, this one stays lost: a new device has to be opened.
    system->plug_in();
    EXPECT_FALSE((*device)->start(id, intake).has_value());
    device->reset();
    EXPECT_EQ(system->held(), kNothing);
    CaptureSession again;
    system->arrive({.bytes = random_bytes(kWhole, 3)});
    again.run(system);
    EXPECT_EQ(again.error, "");
    EXPECT_EQ(again.intake.frames().size(), 1u);
}

TEST(CaptureLoop, TheEndOfAStreamIsALostDevice) {
    const auto system = std::make_shared<FakeVideoSystem>();
    system->fault_named("VIDIOC_DQBUF", EPIPE, 1);
    system->arrive({.bytes = random_bytes(kWhole, 1)});
    CaptureSession session;
    session.run(system);
    ASSERT_EQ(session.intake.losses().size(), 1u);
    EXPECT_THAT(session.intake.losses()[0], HasSubstr("ended"));
}

TEST(CaptureLoop, ManyStartsAndStopsLeaveNothing) {
    const auto system = std::make_shared<FakeVideoSystem>();
    auto device = v4l2_driver(system).open("/dev/video0");
    ASSERT_TRUE(device.has_value());
    const StreamId id = (*device)->info().streams.front().id;
    TimeNs last = 0;
    for (std::uint64_t i = 0; i < 50; ++i) {
        test::CollectingIntake intake;
        system->arrive({.bytes = random_bytes(kWhole, i)});
        ASSERT_TRUE((*device)->start(id, intake).has_value());
        EXPECT_FALSE((*device)->start(id, intake).has_value());
        if (i % 3 != 0) system->wait_idle([] { return false; });
        (*device)->stop(id);
        EXPECT_EQ(system->held().mappings, 0);
        EXPECT_EQ(system->held().events, 0);
        EXPECT_EQ(system->held().buffers, 0u);
        for (const auto& frame : intake.all<InfraredFrame>()) {
            EXPECT_GT(frame->header.host_time, last);
            last = frame->header.host_time;
        }
    }
    device->reset();
    EXPECT_EQ(system->held(), kNothing);
    EXPECT_EQ(system->misuses(), 0);
}

TEST(CaptureLoop, MultiPlanarCaptureSkipsTheDataOffset) {
    FakeCamera camera;
    camera.device_capabilities = V4L2_CAP_VIDEO_CAPTURE_MPLANE | V4L2_CAP_STREAMING;
    camera.data_offset = 32;
    const auto system = std::make_shared<FakeVideoSystem>(camera);
    const auto sent = random_bytes(kWhole, 3);
    system->arrive({.bytes = sent});
    system->arrive({.bytes = sent, .bytesused = 16});        // less than the offset
    system->arrive({.bytes = sent, .bytesused = 1u << 30});  // beyond the mapping
    system->arrive({.bytes = sent});
    CaptureSession session;
    session.run(system);
    ASSERT_EQ(session.error, "");
    const auto frames = session.intake.all<InfraredFrame>();
    ASSERT_EQ(frames.size(), 2u);
    const auto expected = words(sent);
    EXPECT_TRUE(std::equal(expected.begin(), expected.end(), frames[0]->raw.data()));
    EXPECT_EQ(frames[1]->header.lost_before, 2);
    EXPECT_EQ(system->held(), kNothing);
}

}  // namespace
}  // namespace kino
