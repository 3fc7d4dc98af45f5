#include <gtest/gtest.h>

#include <filesystem>

#include "capture_session.h"
#include "fuzz/targets.h"
#include "sensor/v4l2/v4l2_address.h"
#include "tests/support/random.h"
#include "tests/support/temp_dir.h"

/// The fuzz target on its committed seeds and on seeded mutations of them, addresses that are
/// nearly right, and a driver that answers nonsense.
namespace kino {
namespace {

using Buffer = std::vector<std::uint8_t>;

Buffer mutated(Buffer bytes, test::Random& random) {
    const int changes = random.integer(1, 6);
    for (int i = 0; i < changes && !bytes.empty(); ++i) {
        const auto at =
            static_cast<std::size_t>(random.integer(0, static_cast<int>(bytes.size()) - 1));
        switch (random.integer(0, 3)) {
            case 0:
                bytes[at] = static_cast<std::uint8_t>(random.bits());
                break;
            case 1:
                bytes[at] ^= static_cast<std::uint8_t>(1u << random.integer(0, 7));
                break;
            case 2:
                bytes.resize(at);
                break;
            default:
                bytes.insert(bytes.begin() + static_cast<std::ptrdiff_t>(at),
                             static_cast<std::size_t>(random.integer(1, 40)),
                             static_cast<std::uint8_t>(random.bits()));
        }
    }
    return bytes;
}

TEST(Mutations, V4l2Buffers) {
    std::vector<Buffer> seeds;
    for (const auto& entry : std::filesystem::directory_iterator("tests/data/fuzz/v4l2_buffers")) {
        const std::string text = test::read_bytes(entry.path());
        seeds.emplace_back(text.begin(), text.end());
    }
    ASSERT_GE(seeds.size(), video_formats().size());
    test::Random random(1);
    for (const Buffer& seed : seeds) {
        fuzz::v4l2_buffers(seed);
        for (int i = 0; i < 3000; ++i) fuzz::v4l2_buffers(mutated(seed, random));
    }
}

TEST(Mutations, Addresses) {
    const std::string seed = "/dev/video0?node=1.0.0&as=depth&format=Y16-BE&size=640x480&fps=29.97";
    test::Random random(2);
    int read = 0;
    for (int i = 0; i < 20000; ++i) {
        const Buffer bytes = mutated({seed.begin(), seed.end()}, random);
        const auto address = parse_v4l2_address({bytes.begin(), bytes.end()});
        if (!address) continue;
        ++read;
        const auto again = parse_v4l2_address(address->to_string());
        ASSERT_TRUE(again.has_value()) << address->to_string();
        ASSERT_EQ(*again, *address);
    }
    EXPECT_GT(read, 1000);
}

/// A kernel whose answers are overwritten at random after the fact.
class LyingSystem final : public VideoSystem {
  public:
    LyingSystem(std::shared_ptr<test::FakeVideoSystem> inner, std::uint64_t seed)
        : inner_(std::move(inner)), random_(seed) {}
    std::vector<VideoNode> nodes() override { return inner_->nodes(); }
    std::string resolve(const std::string& path) override { return inner_->resolve(path); }
    int open(const std::string& path) override { return inner_->open(path); }
    int close(int descriptor) override { return inner_->close(descriptor); }
    int ioctl(int descriptor, unsigned long request, void* argument) override {
        const int result = inner_->ioctl(descriptor, request, argument);
        const std::lock_guard lock(mutex_);
        if (result < 0 || !random_.chance(0.1)) return result;
        // Pointers that the caller gave are no answers.
        if (request == VIDIOC_G_EXT_CTRLS || request == VIDIOC_S_EXT_CTRLS) return result;
        auto* const bytes = static_cast<std::uint8_t*>(argument);
        const int size = static_cast<int>(_IOC_SIZE(request));
        for (int i = random_.integer(1, 4); i > 0; --i) {
            const int at = random_.integer(0, size - 1);
            bytes[at] = random_.chance(0.3) ? 0xff : static_cast<std::uint8_t>(random_.bits());
        }
        return result;
    }
    MapResult map(int descriptor, std::size_t length, std::int64_t offset) override {
        // What the kernel would refuse, too.
        if (length > (1u << 20)) return {nullptr, ENOMEM};
        return inner_->map(descriptor, length, offset);
    }
    int unmap(void* data, std::size_t length) override { return inner_->unmap(data, length); }
    int make_event() override { return inner_->make_event(); }
    void set_event(int event) override { inner_->set_event(event); }
    PollResult poll(int descriptor, int event, TimeNs timeout) override {
        return inner_->poll(descriptor, event, timeout);
    }
    TimeNs now() override { return inner_->now(); }

  private:
    std::shared_ptr<test::FakeVideoSystem> inner_;
    std::mutex mutex_;
    test::Random random_;
};

TEST(Mutations, ADriverThatAnswersNonsense) {
    int with_frames = 0;
    for (std::uint64_t seed = 0; seed < 600; ++seed) {
        test::FakeCamera camera;
        if (seed % 2 == 1)
            camera.device_capabilities = V4L2_CAP_VIDEO_CAPTURE_MPLANE | V4L2_CAP_STREAMING;
        camera.has_rate = true;
        camera.controls = {{V4L2_CID_BRIGHTNESS, V4L2_CTRL_TYPE_INTEGER, "Brightness"},
                           {V4L2_CID_GAIN, V4L2_CTRL_TYPE_INTEGER, "Gain"}};
        const auto fake = std::make_shared<test::FakeVideoSystem>(camera);
        for (std::uint64_t i = 0; i < 12; ++i)
            fake->arrive({.bytes = test::random_bytes(96, seed + i)});
        const auto system = std::make_shared<LyingSystem>(fake, seed);
        auto device = v4l2_driver(system).open("");
        if (!device) continue;
        test::CollectingIntake intake;
        const StreamId id = (*device)->info().streams.front().id;
        if ((*device)->start(id, intake)) {
            fake->wait_idle([&] { return intake.is_lost(); });
            (*device)->stop(id);
            with_frames += intake.frames().empty() ? 0 : 1;
        }
        device->reset();
        ASSERT_EQ(fake->held(), test::FakeVideoSystem::Held{});
    }
    EXPECT_GT(with_frames, 50);
}

}  // namespace
}  // namespace kino
