#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <cerrno>
#include <thread>

#include "capture_session.h"
#include "nodes_only.h"
#include "sensor/v4l2/v4l2_address.h"
#include "sensor/v4l2/video_device.h"
#include "sensor/v4l2/video_nodes.h"
#include "tests/support/temp_dir.h"

namespace kino {
namespace {

namespace fs = std::filesystem;
using test::FakeCamera;
using test::FakeVideoSystem;

/// A /sys with two cameras on USB, one of them with two nodes, and one that is on no bus.
class SysTree {
  public:
    SysTree() {
        usb("1-2", "A00364A07684047A");
        usb("1-3", "0000000000000000");
        node("video10", "devices/usb1/1-2/1-2:1.0", "Kinect", "0", "81:5");
        node("video2", "devices/usb1/1-3/1-3:1.0", "Webcam", "0", "81:2");
        node("video3", "devices/usb1/1-3/1-3:1.0", "Webcam", "1", "81:3");
        node("video0", "devices/platform/vivid.0", "vivid", "0", "81:0");
        folder_.write("class/vbi0/name", "not a video node\n");
        folder_.write("class/videoX/name", "neither\n");
        folder_.write("udev/c81:5",
                      "S:v4l/by-id/x\nE:ID_SERIAL=Microsoft_Kinect_A00364A07684047A\n"
                      "E:ID_PATH=pci-0000:00:14.0-usb-0:2:1.0\n");
    }
    [[nodiscard]] std::vector<VideoNode> list() const {
        return list_video_nodes({folder_ / "class", folder_ / "udev", "/dev"});
    }

  private:
    void usb(const std::string& port, const std::string& serial) {
        folder_.write("devices/usb1/" + port + "/idVendor", "045e\n");
        folder_.write("devices/usb1/" + port + "/serial", serial + "\n");
    }
    void node(const std::string& name, const std::string& parent, const std::string& title,
              const std::string& index, const std::string& number) {
        fs::create_directories(folder_ / parent);
        folder_.write("class/" + name + "/name", title + "\n");
        folder_.write("class/" + name + "/index", index + "\n");
        folder_.write("class/" + name + "/dev", number + "\n");
        fs::create_directory_symlink(folder_ / parent, folder_ / ("class/" + name + "/device"));
    }
    test::TempDir folder_;
};

TEST(VideoNodes, AreKnownBySerialPortAndPart) {
    const SysTree tree;
    const auto nodes = tree.list();
    ASSERT_EQ(nodes.size(), 4u);
    EXPECT_EQ(nodes[0].path, "/dev/video0");
    EXPECT_EQ(nodes[0].serial, "");
    EXPECT_EQ(nodes[0].bus_path, "vivid.0");
    EXPECT_EQ(nodes[0].part, "0");
    EXPECT_EQ(nodes[1].path, "/dev/video2");
    EXPECT_EQ(nodes[1].serial, "");  // zeros are no serial
    EXPECT_EQ(nodes[1].bus_path, "1-3:1.0");
    EXPECT_EQ(nodes[1].part, "1.0.0");
    EXPECT_EQ(nodes[2].part, "1.0.1");
    EXPECT_EQ(nodes[3].path, "/dev/video10");  // by number, not by letter
    EXPECT_EQ(nodes[3].name, "Kinect");
    EXPECT_EQ(nodes[3].serial, "A00364A07684047A");
    EXPECT_EQ(nodes[3].udev_serial, "Microsoft_Kinect_A00364A07684047A");
    EXPECT_EQ(nodes[3].bus_path, "pci-0000:00:14.0-usb-0:2:1.0");
    EXPECT_TRUE(list_video_nodes({"/nowhere", "/nowhere", "/dev"}).empty());
}

/// A system that knows the nodes of the tree and nothing else.
class TreeSystem final : public test::NodesOnly {
  public:
    std::vector<VideoNode> nodes() override { return tree_.list(); }

  private:
    SysTree tree_;
};

std::vector<std::string> paths(const std::string& address, VideoSystem& system) {
    std::vector<std::string> out;
    for (const VideoNode& node : matching_nodes(*parse_v4l2_address(address), system))
        out.push_back(node.path);
    return out;
}

TEST(V4l2Addresses, FindTheUnitByAnyOfItsNames) {
    TreeSystem system;
    using testing::ElementsAre;
    EXPECT_THAT(paths("A00364A07684047A", system), ElementsAre("/dev/video10"));
    EXPECT_THAT(paths("Microsoft_Kinect_A00364A07684047A", system), ElementsAre("/dev/video10"));
    EXPECT_THAT(paths("pci-0000:00:14.0-usb-0:2:1.0", system), ElementsAre("/dev/video10"));
    EXPECT_THAT(paths("1-3:1.0", system), ElementsAre("/dev/video2", "/dev/video3"));
    EXPECT_THAT(paths("1-3:1.0?node=1.0.1", system), ElementsAre("/dev/video3"));
    EXPECT_THAT(paths("/dev/video3", system), ElementsAre("/dev/video3"));
    EXPECT_THAT(paths("/dev/video77", system), ElementsAre("/dev/video77"));
    EXPECT_THAT(paths("0000000000000000", system), ElementsAre());
    EXPECT_EQ(paths("", system).size(), 4u);
}

/// Law: the lasting address of every node finds that node, and that node first.
TEST(V4l2Addresses, ThatLastLeadBackToTheirNode) {
    TreeSystem system;
    const auto nodes = system.nodes();
    for (const VideoNode& node : nodes) {
        const auto lasting = lasting_address({}, node, nodes);
        const auto found = paths(lasting.to_string(), system);
        ASSERT_FALSE(found.empty()) << lasting.to_string();
        EXPECT_EQ(found[0], node.path) << lasting.to_string();
        EXPECT_NE(lasting.unit, node.path) << "a node's number does not last";
    }
}

TEST(V4l2Addresses, TwinsWithOneSerialAreToldApartByPort) {
    const VideoNode first{"/dev/video0", "", "SN0001", "", "1-1:1.0", "1.0.0"};
    const VideoNode second{"/dev/video2", "", "SN0001", "", "1-4:1.0", "1.0.0"};
    EXPECT_EQ(lasting_address({}, second, {first, second}).unit, "1-4:1.0");
    EXPECT_EQ(lasting_address({}, second, {second}).unit, "SN0001");
}

TEST(V4l2Addresses, ReadBackWhatTheyWrite) {
    V4l2Address address;
    address.unit = "/dev/v4l/by-id/a+b?c&d=%e #\x01";
    address.node = "1.0.0";
    address.as = StreamKind::infrared;
    address.format = "Y16-BE";
    address.width = 1280;
    address.height = 1024;
    address.fps = 29.97;
    address.calibration = "/a b/&+.json";
    const std::string text = address.to_string();
    EXPECT_EQ(text.find('+'), std::string::npos);
    EXPECT_EQ(*parse_v4l2_address(text), address);
    EXPECT_EQ(*parse_v4l2_address(""), V4l2Address{});
    EXPECT_EQ(V4l2Address{}.to_string(), "");
}

TEST(V4l2Addresses, WrongOptionsSayWhatIsRight) {
    for (const char* text : {"?as=bodies", "?as=", "?format=NV12", "?size=640", "?size=0x480",
                             "?size=640x480x3", "?size=99999x1", "?fps=0", "?fps=-1", "?fps=nan",
                             "?fps=inf", "?fps=30x", "?speed=1", "?as"}) {
        const auto address = parse_v4l2_address(text);
        ASSERT_FALSE(address.has_value()) << text;
        EXPECT_FALSE(address.error().hint.empty()) << text;
    }
}

TEST(KernelVideoSystem, OpensWaitsAndIsStopped) {
    const auto system = real_video_system();
    EXPECT_EQ(system->open("/nowhere/video0"), -ENOENT);
    const auto missing = VideoDevice::open(system, "/nowhere/video0");
    ASSERT_FALSE(missing.has_value());
    EXPECT_EQ(missing.error().where, "/nowhere/video0");

    const auto device = VideoDevice::open(system, "/dev/null");
    ASSERT_TRUE(device.has_value());
    v4l2_capability capability{};
    const Called called = device->call(VIDIOC_QUERYCAP, capability);
    ASSERT_FALSE(called.has_value());
    EXPECT_EQ(called.error().error, ENOTTY);
    EXPECT_STREQ(called.error().call, "VIDIOC_QUERYCAP");
    EXPECT_NE(device->map(4096, 0).error, 0);

    const int event = system->make_event();
    ASSERT_GE(event, 0);
    const TimeNs before = system->now();
    const PollResult nothing = system->poll(-1, event, 2 * kNsPerMs);
    EXPECT_FALSE(nothing.stopped);
    EXPECT_EQ(nothing.events, 0);
    EXPECT_GE(system->now() - before, 2 * kNsPerMs);
    std::thread setter([&] { system->set_event(event); });
    EXPECT_TRUE(system->poll(-1, event, 60 * kNsPerSecond).stopped);
    setter.join();
    EXPECT_TRUE(system->poll(-1, event, 0).stopped);  // until it is closed
    EXPECT_EQ(system->close(event), 0);
    EXPECT_EQ(system->close(event), -EBADF);
}

TEST(V4l2Driver, FindsTheSameUnitAgainAndListsItByItsSerial) {
    FakeCamera camera;
    camera.node.serial = "SN7";
    const auto system = std::make_shared<FakeVideoSystem>(camera);
    const DeviceDriver driver = v4l2_driver(system);
    const auto entries = driver.list();
    ASSERT_EQ(entries.size(), 1u);
    EXPECT_EQ(entries[0].uri, "v4l2:SN7?node=1.0.0");
    EXPECT_EQ(entries[0].problem, "");
    auto device = driver.open("/dev/v4l/by-id/fake?as=depth");
    ASSERT_TRUE(device.has_value());
    const std::string address = (*device)->address();
    EXPECT_EQ(address, "SN7?node=1.0.0&as=depth");
    device->reset();
    system->camera().node.path = "/dev/video4";  // plugged in elsewhere
    EXPECT_TRUE(driver.open(address).has_value());
    EXPECT_FALSE(driver.open("/dev/video0").has_value());
    EXPECT_FALSE(driver.open("SN8").has_value());
    EXPECT_FALSE(driver.open("?as=nothing").has_value());
    system->unplug();
    EXPECT_TRUE(driver.list().empty());
    const auto none = driver.open("");
    ASSERT_FALSE(none.has_value());
    EXPECT_THAT(none.error().to_string(), testing::HasSubstr("no camera"));
}

TEST(V4l2Opener, IsASourceThatDeliversFrames) {
    const auto system = std::make_shared<FakeVideoSystem>();
    const SourceOpener opener = v4l2_opener(system);
    EXPECT_TRUE(opener.probe("v4l2:/dev/video0"));
    EXPECT_TRUE(opener.probe("v4l2:"));
    EXPECT_FALSE(opener.probe("v4l2:/dev/video0+v4l2:/dev/video2"));
    EXPECT_FALSE(opener.probe("/dev/video0"));
    auto source = opener.open("v4l2:?as=depth");
    ASSERT_TRUE(source.has_value());
    ASSERT_TRUE(subscribe_all(**source).has_value());
    system->arrive({.bytes = test::random_bytes(96, 1)});
    const auto set = (*source)->next(20 * kNsPerSecond);
    ASSERT_TRUE(set.has_value() && set->has_value());
    EXPECT_EQ((*set)->depth->raw.width(), 8);
    source->reset();
    EXPECT_EQ(system->held(), FakeVideoSystem::Held{});
}

}  // namespace
}  // namespace kino
