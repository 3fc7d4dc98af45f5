#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cerrno>
#include <set>

#include "capture_session.h"

/// Every errno at every call of a whole life of a device. Whatever happens: it ends, nothing is
/// held, nothing is used that is not ours, and what is said names the node and the call.
namespace kino {
namespace {

using test::CaptureSession;
using test::FakeArrival;
using test::FakeCamera;
using test::FakeFault;
using test::FakeVideoSystem;
using test::random_bytes;

const FakeVideoSystem::Held kHeldNothing{};
constexpr std::size_t kSmallFrame = 8 * 6 * 2;

const std::vector<int> kErrnos = {EINTR,  EAGAIN, EIO,       EINVAL, EBUSY,     ENOMEM,    ENODEV,
                                  ENXIO,  ENOTTY, EACCES,    EPERM,  ENOSPC,    EPIPE,     EPROTO,
                                  EMFILE, EBADF,  ETIMEDOUT, EFAULT, ESHUTDOWN, EOPNOTSUPP};

std::shared_ptr<FakeVideoSystem> scripted() {
    FakeCamera camera;
    camera.has_rate = true;
    camera.formats[0].intervals = {{1, 30}, {1, 15}};
    camera.controls = {{V4L2_CID_BRIGHTNESS, V4L2_CTRL_TYPE_INTEGER, "Brightness"},
                       {V4L2_CID_POWER_LINE_FREQUENCY,
                        V4L2_CTRL_TYPE_MENU,
                        "Power Line Frequency",
                        0,
                        1,
                        1,
                        0,
                        0,
                        0,
                        {{0, "Disabled"}, {1, "50 Hz"}}}};
    auto system = std::make_shared<FakeVideoSystem>(camera);
    for (std::uint64_t i = 0; i < 4; ++i) system->arrive({.bytes = random_bytes(kSmallFrame, i)});
    system->arrive({.kind = FakeArrival::Kind::stall});
    for (std::uint64_t i = 4; i < 6; ++i) system->arrive({.bytes = random_bytes(kSmallFrame, i)});
    return system;
}

constexpr const char* kAddress = "?fps=15";

void expect_sound(const CaptureSession& session, const FakeVideoSystem& system) {
    EXPECT_EQ(system.held(), kHeldNothing);
    EXPECT_EQ(system.misuses(), 0);
    EXPECT_LE(session.intake.losses().size(), 1u);
    EXPECT_EQ(session.intake.put_after_lost(), 0);
    EXPECT_TRUE(session.error.empty() || session.intake.frames().empty());
    for (const auto& frame : session.intake.all<InfraredFrame>())
        EXPECT_TRUE(frame->damaged_rows.empty());
}

TEST(Faults, OneFailureOfEveryKindAtEveryCall) {
    const auto good = scripted();
    CaptureSession reference;
    reference.run(good, kAddress);
    ASSERT_EQ(reference.error, "");
    ASSERT_EQ(reference.intake.frames().size(), 6u);
    const std::vector<std::string> calls = good->calls();
    const std::set<std::string> distinct(calls.begin(), calls.end());
    for (const char* name : {"open",
                             "close",
                             "mmap",
                             "munmap",
                             "eventfd",
                             "poll",
                             "VIDIOC_QUERYCAP",
                             "VIDIOC_ENUM_FMT",
                             "VIDIOC_ENUM_FRAMESIZES",
                             "VIDIOC_ENUM_FRAMEINTERVALS",
                             "VIDIOC_G_FMT",
                             "VIDIOC_S_FMT",
                             "VIDIOC_G_PARM",
                             "VIDIOC_S_PARM",
                             "VIDIOC_REQBUFS",
                             "VIDIOC_QUERYBUF",
                             "VIDIOC_QBUF",
                             "VIDIOC_DQBUF",
                             "VIDIOC_STREAMON",
                             "VIDIOC_STREAMOFF",
                             "VIDIOC_QUERY_EXT_CTRL",
                             "VIDIOC_QUERYMENU"})
        ASSERT_TRUE(distinct.contains(name)) << name << " is not in the good run";

    for (std::size_t call = 0; call < calls.size(); ++call) {
        for (const int error : kErrnos) {
            SCOPED_TRACE(calls[call] + " #" + std::to_string(call) + " " + strerrorname_np(error));
            const auto system = scripted();
            system->fault({.call = static_cast<std::int64_t>(call), .error = error});
            CaptureSession session;
            session.run(system, kAddress);
            expect_sound(session, *system);
            if (!session.error.empty()) {
                EXPECT_THAT(session.error, testing::HasSubstr("/dev/video0"));
                // The end of a list, or a buffer that is too small, speaks in its own words.
                if (session.error.find("failed:") != std::string::npos) {
                    EXPECT_THAT(session.error, testing::HasSubstr(calls[call]));
                    EXPECT_THAT(session.error, testing::HasSubstr(strerrorname_np(error)));
                }
            }
            for (const std::string& why : session.intake.losses()) {
                EXPECT_THAT(why, testing::HasSubstr("/dev/video0"));
                EXPECT_THAT(why, testing::HasSubstr(calls[call]));
            }
            if (error == EINTR) {
                EXPECT_EQ(session.error, "");
                EXPECT_EQ(session.intake.frames().size(), 6u);
            }
        }
        if (testing::Test::HasFailure()) return;
    }
}

TEST(Faults, FailuresThatDoNotEndFromEveryCallOn) {
    const auto good = scripted();
    CaptureSession reference;
    reference.run(good, kAddress);
    const std::vector<std::string> calls = good->calls();
    for (std::size_t call = 0; call < calls.size(); ++call) {
        for (const int error : {EIO, ENODEV, EINTR, EAGAIN, EINVAL, ENOMEM, EBUSY}) {
            SCOPED_TRACE(calls[call] + " #" + std::to_string(call) + " " + strerrorname_np(error));
            const auto system = scripted();
            system->fault(
                {.call = static_cast<std::int64_t>(call), .error = error, .for_ever = true});
            CaptureSession session;
            session.run(system, kAddress);
            expect_sound(session, *system);
        }
        if (testing::Test::HasFailure()) return;
    }
}

TEST(Faults, UnpluggedAtEveryStep) {
    const auto good = scripted();
    CaptureSession reference;
    reference.run(good, kAddress);
    const std::vector<std::string> calls = good->calls();
    const auto last_poll = std::find(calls.rbegin(), calls.rend(), "poll");
    const auto streaming_ends =
        calls.size() - 1 - static_cast<std::size_t>(last_poll - calls.rbegin());
    for (std::size_t call = 0; call < calls.size(); ++call) {
        SCOPED_TRACE(calls[call] + " #" + std::to_string(call));
        const auto system = scripted();
        system->fault({.call = static_cast<std::int64_t>(call), .error = ENODEV, .for_ever = true});
        CaptureSession session;
        session.run(system, kAddress);
        expect_sound(session, *system);
        // Until the last frame is awaited, somebody is told.
        if (call < streaming_ends) {
            EXPECT_TRUE(!session.error.empty() || session.intake.losses().size() == 1);
        }
        for (const std::string& why : session.intake.losses())
            EXPECT_THAT(why, testing::HasSubstr("unplugged"));
    }
}

TEST(Faults, ThousandTimesUnpluggedAndPluggedIn) {
    const auto system = std::make_shared<FakeVideoSystem>();
    std::size_t frames = 0;
    for (std::uint64_t i = 0; i < 1000; ++i) {
        for (std::uint64_t k = 0; k < i % 4; ++k)
            system->arrive({.bytes = random_bytes(kSmallFrame, i)});
        system->arrive({.kind = FakeArrival::Kind::hang_up});
        CaptureSession session;
        session.run(system);
        ASSERT_EQ(session.error, "");
        ASSERT_EQ(session.intake.losses().size(), 1u);
        ASSERT_EQ(session.intake.frames().size(), i % 4);
        frames += session.intake.frames().size();
        ASSERT_EQ(system->held(), kHeldNothing);
        system->plug_in();
    }
    EXPECT_EQ(frames, 1500u);
    EXPECT_EQ(system->misuses(), 0);
}

TEST(Faults, ClosedToThisUserNamesTheGroup) {
    const auto system = std::make_shared<FakeVideoSystem>();
    system->fault_named("open", EACCES, 2);
    const DeviceDriver driver = v4l2_driver(system);
    const auto entries = driver.list();
    ASSERT_EQ(entries.size(), 1u);
    EXPECT_THAT(entries[0].problem, testing::HasSubstr("group video"));
    EXPECT_THAT(entries[0].problem, testing::HasSubstr("/dev/video0"));
    const auto device = driver.open("");
    ASSERT_FALSE(device.has_value());
    EXPECT_THAT(device.error().to_string(), testing::HasSubstr("group video"));
}

}  // namespace
}  // namespace kino
