#include "sensor/kinect1/packet_assembler.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <string>

#include "fake_camera.h"
#include "support/random.h"

namespace kino::kinect1 {
namespace {

using test::Bytes;

struct Delivered {
    Bytes bytes;
    std::vector<ByteRange> missing;
    std::uint32_t ticks = 0;
    std::int64_t lost_before = 0;
};

/// A stream of frames, frame f having ticks from f * period on; packets can be spoilt before they
/// are fed.
class Wire {
  public:
    explicit Wire(CameraMode mode) : mode_(mode) {
        period_ = static_cast<std::uint32_t>(kTicksPerSecond / traits(mode).nominal_hz);
    }
    std::vector<Bytes> next() {
        const auto f = static_cast<std::uint32_t>(frames.size());
        frames.push_back(test::random_frame(mode_, 100 + f));
        return test::packets_of(mode_, frames.back(), sequence_, f * period_);
    }
    [[nodiscard]] std::size_t frame_of(std::uint32_t ticks) const { return ticks / period_; }
    [[nodiscard]] std::size_t per_frame() const {
        return static_cast<std::size_t>(packet_layout(mode_).packets());
    }
    std::vector<Bytes> frames;

  private:
    CameraMode mode_;
    std::uint32_t period_ = 0;
    std::uint8_t sequence_ = 200;
};

class Receiver {
  public:
    explicit Receiver(CameraMode mode)
        : assembler(packet_layout(mode), [this](const AssembledFrame& frame) {
              delivered.push_back({Bytes(frame.bytes.begin(), frame.bytes.end()),
                                   {frame.missing.begin(), frame.missing.end()},
                                   frame.ticks,
                                   frame.lost_before});
          }) {}
    void feed(const Bytes& packet) { assembler.feed(packet, 0); }
    void feed(const std::vector<Bytes>& packets) {
        for (const Bytes& packet : packets) feed(packet);
    }
    std::vector<Delivered> delivered;
    PacketAssembler assembler;
};

std::vector<bool> mask_of(const std::vector<ByteRange>& missing, std::size_t size) {
    std::vector<bool> out(size);
    int last = -1;
    for (const ByteRange& range : missing) {
        EXPECT_GT(range.first, last) << "ranges must rise and stand apart";
        EXPECT_LT(range.first, range.end);
        last = range.end;
        for (int i = range.first; i < range.end; ++i) out[static_cast<std::size_t>(i)] = true;
    }
    return out;
}

// The promise of the class: every byte is that frame's own or listed as missing, and then 0.
void expect_no_stale_byte(const Delivered& got, const Wire& wire) {
    const Bytes& source = wire.frames.at(wire.frame_of(got.ticks));
    const std::vector<bool> lost = mask_of(got.missing, source.size());
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < source.size(); ++i) {
        wrong += got.bytes[i] != (lost[i] ? 0 : source[i]) ? 1u : 0u;
    }
    EXPECT_EQ(wrong, 0u) << "frame " << wire.frame_of(got.ticks);
}

class EveryMode : public testing::TestWithParam<CameraMode> {};

TEST_P(EveryMode, WithoutLossEveryFrameIsBitEqual) {
    Wire wire(GetParam());
    Receiver receiver(GetParam());
    for (int f = 0; f < 6; ++f) receiver.feed(wire.next());
    ASSERT_EQ(receiver.delivered.size(), 6u);
    for (std::size_t f = 0; f < 6; ++f) {
        EXPECT_EQ(receiver.delivered[f].bytes, wire.frames[f]);
        EXPECT_TRUE(receiver.delivered[f].missing.empty());
        EXPECT_EQ(receiver.delivered[f].lost_before, 0);
    }
    EXPECT_EQ(receiver.assembler.counts().lost, 0);
}

// The law of loss: what arrives decides alone, frame by frame, and by the rules of the header.
void check_law_of_loss(CameraMode mode, double loss, std::uint64_t seed) {
    constexpr int kFrames = 14;
    test::Random random(seed);
    Wire wire(mode);
    Receiver receiver(mode);
    const PacketLayout layout = packet_layout(mode);
    std::vector<std::vector<ByteRange>> expected_missing;
    std::vector<std::size_t> expected_frames;
    std::vector<std::int64_t> expected_lost;
    std::int64_t dropped = 0;
    for (std::size_t f = 0; f < kFrames; ++f) {
        const auto packets = wire.next();
        std::vector<ByteRange> missing;
        int missing_bytes = 0;
        bool start_lost = false;
        for (std::size_t p = 0; p < packets.size(); ++p) {
            // The first and the last frame arrive, so that all between them are decided.
            if (f > 0 && f + 1 < kFrames && random.chance(loss)) {
                const int first = static_cast<int>(p) * layout.payload_bytes;
                const int end = std::min(first + layout.payload_bytes, layout.frame_bytes);
                if (!missing.empty() && missing.back().end == first) {
                    missing.back().end = end;
                } else {
                    missing.push_back({first, end});
                }
                missing_bytes += end - first;
                start_lost |= p == 0;
            } else {
                receiver.feed(packets[p]);
            }
        }
        if (start_lost || missing_bytes > layout.frame_bytes / 4) {
            ++dropped;
            continue;
        }
        expected_frames.push_back(f);
        expected_missing.push_back(missing);
        expected_lost.push_back(dropped);
        dropped = 0;
    }
    ASSERT_EQ(receiver.delivered.size(), expected_frames.size());
    for (std::size_t i = 0; i < expected_frames.size(); ++i) {
        const Delivered& got = receiver.delivered[i];
        EXPECT_EQ(wire.frame_of(got.ticks), expected_frames[i]);
        EXPECT_EQ(got.missing, expected_missing[i]) << "frame " << expected_frames[i];
        EXPECT_EQ(got.lost_before, expected_lost[i]) << "frame " << expected_frames[i];
        expect_no_stale_byte(got, wire);
    }
}

TEST_P(EveryMode, LawOfLossAtOneFiveAndTenPercent) {
    for (const double loss : {0.01, 0.05, 0.1}) {
        SCOPED_TRACE(loss);
        check_law_of_loss(GetParam(), loss, 11);
        check_law_of_loss(GetParam(), loss, 12);
    }
}

TEST_P(EveryMode, LawOfLossWhereMostIsLost) {
    check_law_of_loss(GetParam(), 0.3, 13);
    check_law_of_loss(GetParam(), 0.6, 14);
}

// Bursts of any length, those included at which the 8-bit numbers wrap unseen: what is handed on
// is still true to its frame, and the stream is whole again two frames later.
TEST_P(EveryMode, ABurstOfAnyLengthLeavesNothingStale) {
    for (const std::size_t burst : {1u,   5u,   64u,  200u, 241u, 242u, 250u, 252u, 253u, 254u,
                                    255u, 256u, 257u, 270u, 400u, 511u, 512u, 513u, 768u, 1500u}) {
        SCOPED_TRACE(burst);
        for (const std::size_t from : {0u, 1u, 77u, 160u}) {
            Wire wire(GetParam());
            Receiver receiver(GetParam());
            receiver.feed(wire.next());
            std::size_t fed = 0;
            const std::size_t frames = (from + burst) / wire.per_frame() + 4;
            for (std::size_t f = 1; f < frames; ++f) {
                for (const Bytes& packet : wire.next()) {
                    if (fed < from || fed >= from + burst) receiver.feed(packet);
                    ++fed;
                }
            }
            for (const Delivered& got : receiver.delivered) expect_no_stale_byte(got, wire);
            ASSERT_GE(receiver.delivered.size(), 2u);
            EXPECT_EQ(wire.frame_of(receiver.delivered.back().ticks), frames - 1);
            EXPECT_TRUE(receiver.delivered.back().missing.empty());
        }
    }
}

TEST_P(EveryMode, ChaosLeavesNothingStale) {
    test::Random random(99);
    Wire wire(GetParam());
    Receiver receiver(GetParam());
    int burst = 0;
    for (int f = 0; f < 40; ++f) {
        std::vector<Bytes> packets = wire.next();
        if (f < 30) {
            for (std::size_t p = 0; p + 1 < packets.size(); ++p) {
                const double kind = random.real(0, 1);
                if (kind < 0.004) std::swap(packets[p], packets[p + 1]);
                if (kind > 0.004 && kind < 0.01) {
                    packets.insert(packets.begin() + static_cast<std::ptrdiff_t>(p), packets[p]);
                }
                if (kind > 0.01 && kind < 0.014) packets[p][0] = 'X';
                if (kind > 0.014 && kind < 0.018) {
                    packets[p].resize(static_cast<std::size_t>(random.integer(0, 1000)));
                }
                if (kind > 0.018 && kind < 0.02) packets[p].resize(2400, 0x5A);
                if (kind > 0.02 && kind < 0.022) packets[p][3] = 0x33;
                if (kind > 0.022 && kind < 0.03) packets[p].clear();
                if (kind > 0.03 && kind < 0.032 && burst == 0) burst = random.integer(1, 700);
                if (burst > 0) {
                    --burst;
                    packets[p].clear();
                }
            }
        }
        receiver.feed(packets);
    }
    for (const Delivered& got : receiver.delivered) expect_no_stale_byte(got, wire);
    EXPECT_EQ(receiver.delivered.back().bytes, wire.frames.back());
    EXPECT_GT(receiver.delivered.size(), 9u);
}

INSTANTIATE_TEST_SUITE_P(Modes, EveryMode,
                         testing::Values(CameraMode::depth_11bit, CameraMode::depth_10bit,
                                         CameraMode::color_bayer, CameraMode::color_bayer_high,
                                         CameraMode::color_yuv, CameraMode::infrared),
                         [](const auto& test) {
                             return "mode" + std::to_string(static_cast<int>(test.param));
                         });

constexpr CameraMode kDepthMode = CameraMode::depth_11bit;
constexpr int kPayload = 1748;

// One frame in the middle of five whose packets are changed; what comes of it.
template <class Change>
std::vector<Delivered> spoil_one(Change change, PacketCounts* counts = nullptr) {
    Wire wire(kDepthMode);
    Receiver receiver(kDepthMode);
    for (int f = 0; f < 5; ++f) {
        auto packets = wire.next();
        if (f == 2) change(packets);
        receiver.feed(packets);
    }
    for (const Delivered& got : receiver.delivered) expect_no_stale_byte(got, wire);
    if (counts) *counts = receiver.assembler.counts();
    return receiver.delivered;
}

TEST(PacketAssembler, TheProtocolsNumbers) {
    EXPECT_EQ(packet_layout(CameraMode::depth_11bit).packets(), 242);
    EXPECT_EQ(packet_layout(CameraMode::depth_11bit).frame_bytes, 422400);
    EXPECT_EQ(packet_layout(CameraMode::depth_10bit).frame_bytes, 384000);
    EXPECT_EQ(packet_layout(CameraMode::color_bayer).packets(), 162);
    EXPECT_EQ(packet_layout(CameraMode::infrared).frame_bytes, 390400);
    EXPECT_EQ(traits(CameraMode::depth_11bit).packet_bytes, 1760);
    EXPECT_EQ(traits(CameraMode::color_bayer).packet_bytes, 1920);
}

TEST(PacketAssembler, NeighboursSwappedAreWhole) {
    PacketCounts counts;
    const auto got = spoil_one([](auto& packets) { std::swap(packets[50], packets[51]); }, &counts);
    ASSERT_EQ(got.size(), 5u);
    EXPECT_TRUE(got[2].missing.empty());
    EXPECT_EQ(counts.lost, 0);
}

TEST(PacketAssembler, DuplicatesChangeNothing) {
    PacketCounts counts;
    const auto got = spoil_one(
        [](auto& packets) {
            packets.insert(packets.begin() + 50, packets[50]);
            packets.insert(packets.begin(), packets[0]);
            packets.push_back(packets.back());
        },
        &counts);
    ASSERT_EQ(got.size(), 5u);
    EXPECT_TRUE(got[2].missing.empty());
    EXPECT_EQ(counts.duplicates, 3);
}

TEST(PacketAssembler, WrongMagicIsALostPacket) {
    const auto got = spoil_one([](auto& packets) { packets[10][1] = 'b'; });
    ASSERT_EQ(got.size(), 5u);
    EXPECT_EQ(got[2].missing, (std::vector<ByteRange>{{10 * kPayload, 11 * kPayload}}));
}

TEST(PacketAssembler, AShortPacketLosesItsTail) {
    const auto got = spoil_one([](auto& packets) { packets[10].resize(12 + 100); });
    ASSERT_EQ(got.size(), 5u);
    EXPECT_EQ(got[2].missing, (std::vector<ByteRange>{{10 * kPayload + 100, 11 * kPayload}}));
}

TEST(PacketAssembler, AHeaderAloneIsALostPacket) {
    const auto got = spoil_one([](auto& packets) { packets[10].resize(12); });
    ASSERT_EQ(got.size(), 5u);
    EXPECT_EQ(got[2].missing, (std::vector<ByteRange>{{10 * kPayload, 11 * kPayload}}));
}

TEST(PacketAssembler, ATooLongPacketIsALostOne) {
    const auto got = spoil_one([](auto& packets) {
        packets[10].push_back(1);
        packets[241].push_back(1);  // still shorter than the others
    });
    ASSERT_EQ(got.size(), 5u);
    EXPECT_EQ(got[2].missing,
              (std::vector<ByteRange>{{10 * kPayload, 11 * kPayload}, {241 * kPayload, 422400}}));
}

TEST(PacketAssembler, TheLastPacketLostIsFoundAtTheNextFrame) {
    const auto got = spoil_one([](auto& packets) { packets.pop_back(); });
    ASSERT_EQ(got.size(), 5u);
    EXPECT_EQ(got[2].missing, (std::vector<ByteRange>{{241 * kPayload, 422400}}));
}

TEST(PacketAssembler, TheFirstPacketLostDropsTheFrame) {
    const auto got = spoil_one([](auto& packets) { packets.erase(packets.begin()); });
    ASSERT_EQ(got.size(), 4u);
    EXPECT_EQ(got[2].lost_before, 1);
    EXPECT_EQ(got[3].lost_before, 0);
}

TEST(PacketAssembler, AQuarterMayBeMissingAndNotMore) {
    // 242 packets of which a quarter is 60.4.
    const auto cut = [](std::size_t n) {
        return [n](auto& packets) {
            packets.erase(packets.begin() + 1,
                          packets.begin() + 1 + static_cast<std::ptrdiff_t>(n));
        };
    };
    EXPECT_EQ(spoil_one(cut(60)).size(), 5u);
    EXPECT_EQ(spoil_one(cut(61)).size(), 4u);
}

TEST(PacketAssembler, AFrameAllLostIsCounted) {
    const auto got = spoil_one([](auto& packets) { packets.clear(); });
    ASSERT_EQ(got.size(), 4u);
    EXPECT_EQ(got[2].lost_before, 1);
}

TEST(PacketAssembler, AFlagInTheWrongPlaceDropsTheFrame) {
    const auto got = spoil_one([](auto& packets) { packets[100][3] = 0x75; });
    ASSERT_EQ(got.size(), 4u);
    EXPECT_EQ(got[2].lost_before, 1);
}

// 276 packets go missing, which the sequence shows as 20, and then just those packets whose flags
// would have shown it: only the device time tells.
TEST(PacketAssembler, AWrapThatNoFlagShowsIsFoundByDeviceTime) {
    Wire wire(kDepthMode);
    Receiver receiver(kDepthMode);
    for (std::size_t f = 0; f < 6; ++f) {
        const auto packets = wire.next();
        for (std::size_t p = 0; p < packets.size(); ++p) {
            const bool lost = (f == 1 && p > 100) || (f == 2 && (p < 135 || p == 241)) ||
                              (f == 3 && (p == 0 || p == 13 || p == 14));
            if (!lost) receiver.feed(packets[p]);
        }
    }
    for (const Delivered& got : receiver.delivered) expect_no_stale_byte(got, wire);
    EXPECT_EQ(wire.frame_of(receiver.delivered.back().ticks), 5u);
}

TEST(PacketAssembler, NothingBeforeTheFirstStartIsCounted) {
    Wire wire(kDepthMode);
    Receiver receiver(kDepthMode);
    auto packets = wire.next();
    packets.erase(packets.begin(), packets.begin() + 100);
    receiver.feed(packets);
    receiver.feed(wire.next());
    ASSERT_EQ(receiver.delivered.size(), 1u);
    EXPECT_EQ(receiver.delivered[0].lost_before, 0);
    EXPECT_EQ(receiver.delivered[0].bytes, wire.frames[1]);
}

TEST(PacketAssembler, AnotherModesFramesAreNotTakenForThisOnes) {
    // A camera left running by a program that died sends its old mode for a while.
    Wire before(CameraMode::depth_10bit);
    Wire wire(kDepthMode);
    Receiver receiver(kDepthMode);
    for (int f = 0; f < 3; ++f) receiver.feed(before.next());
    EXPECT_TRUE(receiver.delivered.empty());
    for (int f = 0; f < 3; ++f) receiver.feed(wire.next());
    ASSERT_GE(receiver.delivered.size(), 2u);
    for (const Delivered& got : receiver.delivered) expect_no_stale_byte(got, wire);
}

}  // namespace
}  // namespace kino::kinect1
