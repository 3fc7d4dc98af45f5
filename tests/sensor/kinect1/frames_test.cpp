#include <gtest/gtest.h>

#include "bit_reference.h"
#include "collected.h"
#include "fake_kinect.h"
#include "sensor/kinect1/frame_clock.h"
#include "sensor/kinect1/frame_maker.h"
#include "sensor/kinect1/kinect1_driver.h"
#include "support/random.h"

namespace kino::kinect1 {
namespace {

using test::Bytes;

struct Pixels {
    std::vector<unsigned> values;
    std::vector<RowRange> damaged_rows;
    FrameHeader header;
};

// Any frame as numbers, one a pixel.
Pixels pixels_of(const StreamFrame& frame) {
    Pixels out;
    if (const auto* depth = std::get_if<std::shared_ptr<const DepthFrame>>(&frame)) {
        out.values.assign((*depth)->raw.pixels().begin(), (*depth)->raw.pixels().end());
        out.damaged_rows = (*depth)->damaged_rows;
        out.header = (*depth)->header;
    } else if (const auto* infrared = std::get_if<std::shared_ptr<const InfraredFrame>>(&frame)) {
        out.values.assign((*infrared)->raw.pixels().begin(), (*infrared)->raw.pixels().end());
        out.damaged_rows = (*infrared)->damaged_rows;
        out.header = (*infrared)->header;
    } else {
        const auto& color = *std::get<std::shared_ptr<const ColorFrame>>(frame);
        const bool pairs = color.format == PixelFormat::uyvy;
        for (std::size_t i = 0; i < color.bytes.size(); i += pairs ? 2 : 1) {
            out.values.push_back(pairs ? color.bytes[i] * 256u + color.bytes[i + 1]
                                       : color.bytes[i]);
        }
        out.damaged_rows = color.damaged_rows;
        out.header = color.header;
    }
    return out;
}

struct Expected {
    std::vector<unsigned> values;
    std::vector<RowRange> damaged_rows;
};

// Bit by bit, from what the header of frame_maker.h promises.
Expected expected_of(CameraMode mode, const Bytes& source, const std::vector<bool>& missing) {
    const bool depth = mode == CameraMode::depth_11bit || mode == CameraMode::depth_10bit;
    const int bits = mode == CameraMode::depth_11bit                                   ? 11
                     : mode == CameraMode::depth_10bit || mode == CameraMode::infrared ? 10
                     : mode == CameraMode::color_yuv                                   ? 16
                                                                                       : 8;
    const std::size_t n = source.size() * 8 / static_cast<std::size_t>(bits);
    std::vector<bool> lost = mode == CameraMode::color_yuv ? test::lost_pixels(n / 2, 32, missing)
                                                           : test::lost_pixels(n, bits, missing);
    if (mode == CameraMode::color_yuv) {
        std::vector<bool> both;
        for (const bool pair : lost) both.insert(both.end(), 2, pair);
        lost = both;
    }
    Expected out;
    for (std::size_t i = 0; i < n; ++i) {
        unsigned value = test::value_at(source, i, bits);
        if (mode == CameraMode::depth_10bit) value = value == 1023 ? 2047 : 2 * value;
        out.values.push_back(lost[i] ? (depth ? 2047 : 0) : value);
    }
    out.damaged_rows = test::rows_with(lost, mode == CameraMode::color_bayer_high ? 1280 : 640);
    return out;
}

class EveryModeFrames : public testing::TestWithParam<CameraMode> {};

// Damage in any byte ranges at all, whole packets or not.
TEST_P(EveryModeFrames, DamageIsExactToThePixelAndTheRow) {
    const CameraMode mode = GetParam();
    const int size = packet_layout(mode).frame_bytes;
    test::Random random(21);
    for (int round = 0; round < 4; ++round) {
        const Bytes source = test::random_frame(mode, 40 + static_cast<std::uint64_t>(round));
        Bytes bytes = source;
        std::vector<bool> missing(source.size());
        std::vector<ByteRange> ranges;
        // The first round is undamaged, the second loses the very first and last bytes.
        std::vector<int> cuts;
        if (round == 1) cuts = {0, 1, size - 1, size};
        for (int i = 0; round > 1 && i < 8; ++i) cuts.push_back(random.integer(0, size));
        std::sort(cuts.begin(), cuts.end());
        cuts.erase(std::unique(cuts.begin(), cuts.end()), cuts.end());
        for (std::size_t i = 0; i + 1 < cuts.size(); i += 2) {
            const int end = std::min(cuts[i] + 3000, cuts[i + 1]);
            ranges.push_back({cuts[i], end});
            for (int b = cuts[i]; b < end; ++b) {
                missing[static_cast<std::size_t>(b)] = true;
                bytes[static_cast<std::size_t>(b)] = 0;
            }
        }
        AssembledFrame frame;
        frame.bytes = bytes;
        frame.missing = ranges;
        frame.lost_before = 3;
        const Pixels got = pixels_of(make_frame(mode, frame, {1, 2, 4, 0}));
        const Expected want = expected_of(mode, source, missing);
        EXPECT_EQ(got.damaged_rows, want.damaged_rows);
        EXPECT_TRUE(got.values == want.values) << "round " << round;
        EXPECT_EQ(got.header.lost_before, 3);
        EXPECT_EQ(got.header.sequence, 4);
    }
}

// Through the driver: what the camera sends is what arrives, and packets that are dropped on the
// way show as exactly their rows.
TEST_P(EveryModeFrames, ThroughTheDriverWithAndWithoutLoss) {
    const CameraMode mode = GetParam();
    const auto device = test::FakeKinect::make();
    const char* options = mode == CameraMode::depth_10bit        ? "?depth=10"
                          : mode == CameraMode::color_bayer_high ? "?color=bayer-high"
                          : mode == CameraMode::color_yuv        ? "?color=yuv"
                                                                 : "";
    auto opened = kinect1_driver(device).open(options);
    ASSERT_TRUE(opened) << opened.error().to_string();
    test::Collected collected;
    const StreamId id{0, traits(mode).kind};
    ASSERT_TRUE((*opened)->start(id, collected));
    const auto layout = packet_layout(mode);
    test::Random random(5);
    std::uint8_t sequence = 17;
    std::vector<Bytes> sources;
    std::vector<std::vector<bool>> missing;
    for (std::uint32_t f = 0; f < 3; ++f) {
        sources.push_back(test::random_frame(mode, 60 + f));
        missing.emplace_back(sources.back().size());
        auto packets = test::packets_of(mode, sources.back(), sequence, f * 6'000'000);
        for (std::size_t p = 1; f > 0 && p + 1 < packets.size(); ++p) {
            if (!random.chance(0.03)) continue;
            packets[p].clear();
            const auto first = p * static_cast<std::size_t>(layout.payload_bytes);
            for (std::size_t b = first; b < first + static_cast<std::size_t>(layout.payload_bytes);
                 ++b) {
                missing.back()[b] = true;
            }
        }
        ASSERT_TRUE(device->send(traits(mode).endpoint, packets));
    }
    std::vector<StreamFrame> frames;
    if (id.kind == StreamKind::depth) {
        for (auto& frame : collected.of<DepthFrame>(id.kind)) {
            EXPECT_EQ(frame->unit, DepthUnit::kinect_disparity11);
            frames.emplace_back(frame);
        }
    } else if (id.kind == StreamKind::infrared) {
        for (auto& frame : collected.of<InfraredFrame>(id.kind)) frames.emplace_back(frame);
    } else {
        for (auto& frame : collected.of<ColorFrame>(id.kind)) frames.emplace_back(frame);
    }
    ASSERT_EQ(frames.size(), 3u);
    TimeNs last_time = -1;
    for (std::size_t f = 0; f < 3; ++f) {
        const Pixels got = pixels_of(frames[f]);
        const Expected want = expected_of(mode, sources[f], missing[f]);
        EXPECT_TRUE(got.values == want.values) << f;
        EXPECT_EQ(got.damaged_rows, want.damaged_rows) << f;
        EXPECT_EQ(got.header.sequence, static_cast<std::int64_t>(f));
        EXPECT_GT(got.header.device_time, last_time);
        last_time = got.header.device_time;
    }
    EXPECT_TRUE(frames.size() == 3 && pixels_of(frames[0]).damaged_rows.empty());
}

INSTANTIATE_TEST_SUITE_P(Modes, EveryModeFrames,
                         testing::Values(CameraMode::depth_11bit, CameraMode::depth_10bit,
                                         CameraMode::color_bayer, CameraMode::color_bayer_high,
                                         CameraMode::color_yuv, CameraMode::infrared),
                         [](const auto& test) {
                             return "mode" + std::to_string(static_cast<int>(test.param));
                         });

TEST(FrameClock, OneCounterGivesComparableTimes) {
    FrameClock clock;
    const TimeNs t0 = 50 * kNsPerSecond;
    const auto depth = clock.at(0, 1'000'000, t0);
    // 10 ms of the counter later, at the other endpoint.
    const auto color = clock.at(1, 1'600'000, t0 + 10 * kNsPerMs);
    EXPECT_EQ(color.device_time - depth.device_time, 10 * kNsPerMs);
}

// With one clock for both, every stamp would be a jump and its time the arrival's.
TEST(FrameClock, CountersThatDisagreeGetAClockEach) {
    FrameClock clock;
    const TimeNs t0 = 50 * kNsPerSecond;
    TimeNs depth_before = clock.at(0, 1'000'000, t0).device_time;
    TimeNs color_before = clock.at(1, 3'000'000'000u, t0 + 10 * kNsPerMs).device_time;
    for (std::uint32_t i = 1; i < 50; ++i) {
        const TimeNs arrival = t0 + i * kNsPerSecond / 30 + (i * 7 % 5) * kNsPerMs;
        const TimeNs depth = clock.at(0, 1'000'000 + i * 2'000'000, arrival).device_time;
        const TimeNs color =
            clock.at(1, 3'000'000'000u + i * 2'000'000, arrival + 10 * kNsPerMs).device_time;
        EXPECT_NEAR(static_cast<double>(depth - depth_before), 1e9 / 30, 10);
        EXPECT_NEAR(static_cast<double>(color - color_before), 1e9 / 30, 10);
        depth_before = depth;
        color_before = color;
    }
}

}  // namespace
}  // namespace kino::kinect1
