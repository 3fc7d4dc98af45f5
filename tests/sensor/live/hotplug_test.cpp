#include "sensor/live/hotplug.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <thread>

#include "sensor/live/permission_hint.h"
#include "tests/support/temp_dir.h"

namespace kino {
namespace {

/// A wait that is not ended by what it waits for runs into the test's time limit.
constexpr TimeNs kLong = 3600 * kNsPerSecond;
using Change = HotplugEvent::Change;

void plug_usb(const test::TempDir& sys, const std::string& port, const std::string& product,
              const std::string& device_number) {
    const std::string folder = "bus/usb/devices/" + port + "/";
    sys.write(folder + "idVendor", "045e\n");
    sys.write(folder + "idProduct", product + "\n");
    sys.write(folder + "serial", "A00\n");
    sys.write(folder + "busnum", "1\n");
    sys.write(folder + "devnum", device_number + "\n");
}

TEST(PollingWatch, SaysWhatCameAndWhatWent) {
    const test::TempDir sys;
    plug_usb(sys, "1-1", "02c2", "4");
    sys.write("bus/usb/devices/1-1:1.0/bInterfaceNumber", "00\n");
    const auto watch = make_polling_watch(sys.path(), kNsPerMs);
    EXPECT_TRUE(watch->wait(0).empty());

    plug_usb(sys, "1-1.2", "02ae", "17");
    const HotplugEvent camera{Change::added, "usb", "045e", "02ae", "A00", "/dev/bus/usb/001/017"};
    auto events = watch->wait(kLong);
    ASSERT_EQ(events.size(), 1u);
    EXPECT_EQ(events[0], camera);
    std::filesystem::remove_all(sys / "bus/usb/devices/1-1.2");
    events = watch->wait(kLong);
    ASSERT_EQ(events.size(), 1u);
    EXPECT_EQ(events[0].change, Change::removed);
    EXPECT_EQ(events[0].node, "/dev/bus/usb/001/017");
    EXPECT_TRUE(watch->wait(0).empty());
}

TEST(PollingWatch, AnotherDeviceAtTheSamePortIsGoneAndThere) {
    const test::TempDir sys;
    plug_usb(sys, "1-1", "02ae", "4");
    const auto watch = make_polling_watch(sys.path(), kNsPerMs);
    sys.write("bus/usb/devices/1-1/devnum", "5\n");
    const auto events = watch->wait(kLong);
    ASSERT_EQ(events.size(), 2u);
    EXPECT_EQ(events[0].change, Change::removed);
    EXPECT_EQ(events[0].node, "/dev/bus/usb/001/004");
    EXPECT_EQ(events[1].change, Change::added);
    EXPECT_EQ(events[1].node, "/dev/bus/usb/001/005");
}

TEST(PollingWatch, SeesVideoNodes) {
    const test::TempDir sys;
    const auto watch = make_polling_watch(sys.path(), kNsPerMs);
    sys.write("class/video4linux/video3/dev", "81:3\n");
    const auto events = watch->wait(kLong);
    ASSERT_FALSE(events.empty());
    EXPECT_EQ(events[0].subsystem, "video4linux");
    EXPECT_EQ(events[0].node, "/dev/video3");
}

TEST(PollingWatch, WithoutSysThereIsNothingAndNoError) {
    const test::TempDir sys;
    EXPECT_TRUE(make_polling_watch(sys / "none", kNsPerMs)->wait(3 * kNsPerMs).empty());
}

void expect_interruptible(HotplugWatch& watch) {
    // Before the wait and during it.
    watch.interrupt();
    (void)watch.wait(kLong);
    std::thread interrupter([&] {
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
        watch.interrupt();
    });
    (void)watch.wait(kLong);
    interrupter.join();
}

TEST(PollingWatch, IsInterruptible) {
    const test::TempDir sys;
    expect_interruptible(*make_polling_watch(sys.path(), kLong));
}

TEST(HotplugWatch, OfThisMachineIsThereAndInterruptible) {
    const auto watch = make_hotplug_watch();
    ASSERT_NE(watch, nullptr);
    (void)watch->wait(0);
    (void)watch->wait(-5);
    (void)watch->wait(2 * kNsPerMs);
    expect_interruptible(*watch);
}

TEST(UdevRule, CoversEveryDeviceAndIsWhatTheHintNames) {
    const std::string hint = permission_hint();
    ASSERT_NE(hint.find("udev/60-kinoscope.rules"), std::string::npos);
    EXPECT_NE(hint.find("/etc/udev/rules.d/"), std::string::npos);
    const std::string rules = test::read_bytes("udev/60-kinoscope.rules");
    for (const char* id : {"02ae", "02b0", "02ad", "02bf", "02be", "02c3", "02bb", "02c4", "02d8",
                           "02d9", "1d27", "045e"}) {
        EXPECT_NE(rules.find(id), std::string::npos) << id;
    }
    // Every line that names a vendor opens the device in both ways.
    for (std::size_t at = 0; (at = rules.find("ATTR{idVendor}", at)) != std::string::npos;) {
        const std::string line = rules.substr(at, rules.find('\n', at) - at);
        for (const char* part : {"MODE=\"0660\"", "GROUP=\"plugdev\"", "TAG+=\"uaccess\""}) {
            EXPECT_NE(line.find(part), std::string::npos) << line;
        }
        at += line.size();
    }
}

}  // namespace
}  // namespace kino
