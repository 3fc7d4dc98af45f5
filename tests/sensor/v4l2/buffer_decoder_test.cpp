#include "sensor/v4l2/buffer_decoder.h"

#include <gtest/gtest.h>
#include <linux/videodev2.h>

#include "fake_video_system.h"
#include "sensor/color_conversion.h"
#include "sensor/v4l2/pixel_unpack.h"
#include "tests/support/random.h"

namespace kino {
namespace {

using test::random_bytes;

/// Bit `index` of the stream, the most significant bit of the first byte being bit 0.
unsigned bit(const std::vector<std::uint8_t>& bytes, std::size_t index) {
    return bytes[index / 8] >> (7 - index % 8) & 1u;
}

unsigned packed10_reference(const std::vector<std::uint8_t>& bytes, std::size_t pixel) {
    unsigned value = 0;
    for (std::size_t i = 0; i < 10; ++i) value = 2 * value + bit(bytes, 10 * pixel + i);
    return value;
}

BufferLayout layout_of(const char* format, StreamKind kind, int width, int height,
                       std::size_t padding = 0) {
    BufferLayout layout;
    layout.format = find_video_format(std::string(format));
    layout.kind = kind;
    layout.width = width;
    layout.height = height;
    layout.stride = layout.format->row_bytes(width) + padding;
    EXPECT_TRUE(validate(layout).has_value());
    return layout;
}

template <class Frame>
std::shared_ptr<const Frame> decode(const BufferLayout& layout,
                                    std::span<const std::uint8_t> bytes) {
    const auto frame = decode_buffer(layout, bytes, {});
    if (!frame) return nullptr;
    return std::get<std::shared_ptr<const Frame>>(*frame);
}

TEST(PixelUnpack, TenBitsAgreeWithABitByBitReferenceAtEveryCount) {
    for (std::size_t count = 0; count < 70; ++count) {
        // No byte more than the contract says is read: the sanitizer watches.
        const auto bytes = random_bytes((count * 10 + 7) / 8, count);
        std::vector<std::uint16_t> out(count);
        unpack_packed10(bytes.data(), count, out.data());
        for (std::size_t i = 0; i < count; ++i) ASSERT_EQ(out[i], packed10_reference(bytes, i));
    }
}

TEST(PixelUnpack, DisparitiesKeepTheirOrderAndNoReadingIsNoReading) {
    std::vector<std::uint16_t> values(1024);
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<std::uint16_t>(i);
    widen_disparity10(values.data(), values.size());
    for (std::size_t i = 0; i < 1023; ++i) EXPECT_EQ(values[i], 2 * i);
    EXPECT_EQ(values[1023], 2047);
}

TEST(BufferDecoder, PackedRowsOfEveryWidthWithAndWithoutPadding) {
    test::Random random(3);
    for (int width = 1; width < 40; ++width) {
        const auto layout = layout_of("Y10B", StreamKind::infrared, width, 5,
                                      static_cast<std::size_t>(random.integer(0, 9)));
        const auto bytes = random_bytes(layout.whole_bytes(), static_cast<std::uint64_t>(width));
        const auto frame = decode<InfraredFrame>(layout, bytes);
        ASSERT_NE(frame, nullptr);
        EXPECT_EQ(frame->significant_bits, 10);
        for (int y = 0; y < 5; ++y) {
            const auto begin = bytes.begin() + static_cast<std::ptrdiff_t>(layout.stride) * y;
            const std::vector<std::uint8_t> row(
                begin, begin + static_cast<std::ptrdiff_t>(layout.format->row_bytes(width)));
            for (int x = 0; x < width; ++x)
                ASSERT_EQ(frame->raw.at(x, y),
                          packed10_reference(row, static_cast<std::size_t>(x)));
        }
    }
}

TEST(BufferDecoder, KinectDepthIsDisparity) {
    auto layout = layout_of("Y10BPACK", StreamKind::depth, 640, 480);
    layout.unit = DepthUnit::kinect_disparity11;
    EXPECT_EQ(layout.stride, 800u);
    EXPECT_EQ(layout.whole_bytes(), 384000u);
    const auto bytes = random_bytes(384000, 5);
    const auto frame = decode<DepthFrame>(layout, bytes);
    ASSERT_NE(frame, nullptr);
    EXPECT_EQ(frame->unit, DepthUnit::kinect_disparity11);
    for (std::size_t i = 0; i < 640 * 480; ++i) {
        const unsigned count = packed10_reference(bytes, i);
        ASSERT_EQ(frame->raw.pixels()[i], count == 1023 ? 2047 : 2 * count);
    }
}

TEST(BufferDecoder, WordsInBothOrdersKeepTheirSignificantBits) {
    const auto bytes = random_bytes(2 * 12 * 4, 9);
    const struct {
        const char* name;
        bool big;
        unsigned mask;
    } kCases[] = {{"Y16", false, 0xffff},
                  {"Y16_BE", true, 0xffff},
                  {"Y10", false, 0x3ff},
                  {"Y12", false, 0xfff},
                  {"Z16", false, 0xffff}};
    for (const auto& c : kCases) {
        const auto frame =
            decode<InfraredFrame>(layout_of(c.name, StreamKind::infrared, 12, 4), bytes);
        const auto depth = decode<DepthFrame>(layout_of(c.name, StreamKind::depth, 12, 4), bytes);
        ASSERT_TRUE(frame && depth) << c.name;
        for (std::size_t i = 0; i < 48; ++i) {
            const unsigned first = bytes[2 * i], second = bytes[2 * i + 1];
            const unsigned expected = (c.big ? first * 256 + second : second * 256 + first);
            EXPECT_EQ(frame->raw.pixels()[i], expected & c.mask) << c.name;
            EXPECT_EQ(depth->raw.pixels()[i], expected & c.mask) << c.name;
        }
    }
}

TEST(BufferDecoder, ColourIsDeliveredAsItIsWithoutPadding) {
    const struct {
        const char* name;
        PixelFormat format;
        std::size_t pixel_bytes;
    } kCases[] = {{"YUYV", PixelFormat::yuyv, 2},
                  {"UYVY", PixelFormat::uyvy, 2},
                  {"GRBG", PixelFormat::bayer_grbg8, 1},
                  {"GREY", PixelFormat::gray8, 1}};
    for (const auto& c : kCases) {
        const auto layout = layout_of(c.name, StreamKind::color, 10, 6, 7);
        const auto bytes = random_bytes(layout.whole_bytes(), 2);
        const auto frame = decode<ColorFrame>(layout, bytes);
        ASSERT_NE(frame, nullptr);
        EXPECT_EQ(frame->format, c.format);
        const std::size_t row = 10 * c.pixel_bytes;
        ASSERT_EQ(frame->bytes.size(), row * 6);
        EXPECT_EQ(frame->pitch, static_cast<int>(row));
        for (std::size_t i = 0; i < frame->bytes.size(); ++i)
            ASSERT_EQ(frame->bytes[i], bytes[i / row * layout.stride + i % row]);
        Image<Rgba8> out;
        EXPECT_TRUE(to_rgba8(*frame, out).has_value()) << c.name;
    }
}

/// Law: for every format and every length that can arrive, a pixel is either what was sent or no
/// reading, and the damaged rows are just those with a pixel that did not come.
TEST(BufferDecoder, EveryLengthOfEveryFormat) {
    for (const VideoFormat& format : video_formats()) {
        if (!format.has_rows()) continue;
        for (const std::size_t padding : {0u, 3u}) {
            for (const StreamKind kind :
                 {StreamKind::depth, StreamKind::infrared, StreamKind::color}) {
                if (!format.can_be(kind)) continue;
                auto layout = layout_of(format.name, kind, 6, 4, padding);
                if (kind == StreamKind::depth && format.code == PixelCode::packed10)
                    layout.unit = DepthUnit::kinect_disparity11;
                const auto bytes = random_bytes(layout.whole_bytes(), 77);
                const auto whole = decode_buffer(layout, bytes, {});
                ASSERT_TRUE(whole.has_value());
                for (std::size_t length = 0; length <= bytes.size(); ++length) {
                    const std::vector<std::uint8_t> came(
                        bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(length));
                    const auto part = decode_buffer(layout, came, {});
                    const std::size_t row_bytes = format.row_bytes(6);
                    int whole_rows = 0;
                    while (whole_rows < 4 &&
                           static_cast<std::size_t>(whole_rows) * layout.stride + row_bytes <=
                               length)
                        ++whole_rows;
                    ASSERT_EQ(part.has_value(), whole_rows > 0);
                    if (!part) continue;
                    std::vector<RowRange> expected;
                    if (whole_rows < 4) expected = {{whole_rows, 4 - whole_rows}};
                    std::visit(
                        [&](const auto& held) {
                            using Held = std::decay_t<decltype(held)>;
                            if constexpr (requires { held->damaged_rows; }) {
                                ASSERT_EQ(held->damaged_rows, expected);
                                const auto& full = *std::get<Held>(*whole);
                                if constexpr (requires { held->raw; }) {
                                    const int none =
                                        layout.unit == DepthUnit::kinect_disparity11 ? 2047 : 0;
                                    for (int y = 0; y < 4; ++y) {
                                        for (int x = 0; x < 6; ++x) {
                                            const std::size_t bits =
                                                format.code == PixelCode::packed10
                                                    ? 10
                                                    : 8 * row_bytes / 6;
                                            const std::size_t end =
                                                static_cast<std::size_t>(y) * layout.stride * 8 +
                                                static_cast<std::size_t>(x + 1) * bits;
                                            ASSERT_EQ(held->raw.at(x, y),
                                                      end <= 8 * length ? full.raw.at(x, y) : none);
                                        }
                                    }
                                } else {
                                    for (std::size_t i = 0; i < held->bytes.size(); ++i) {
                                        const std::size_t at =
                                            i / row_bytes * layout.stride + i % row_bytes;
                                        ASSERT_EQ(held->bytes[i], at < length ? full.bytes[i] : 0);
                                    }
                                }
                            }
                        },
                        *part);
                }
            }
        }
    }
}

TEST(BufferDecoder, WherePacketsAreStrungTogetherAShortBufferIsNoFrame) {
    auto layout = layout_of("Y10B", StreamKind::depth, 640, 480);
    layout.short_rows_in_place = false;
    EXPECT_EQ(decode<DepthFrame>(layout, random_bytes(384000 - 1748, 1)), nullptr);
    EXPECT_NE(decode<DepthFrame>(layout, random_bytes(384000, 1)), nullptr);
}

TEST(BufferDecoder, JpegIsPassedOnBetweenItsMarkersOrNotAtAll) {
    const auto layout = layout_of("MJPG", StreamKind::color, 640, 480);
    std::vector<std::uint8_t> picture = {0xff, 0xd8, 1, 2, 0xff, 0xd9, 3, 0xff, 0xd9};
    std::vector<std::uint8_t> padded = picture;
    padded.resize(40, 0);
    const auto frame = decode<ColorFrame>(layout, padded);
    ASSERT_NE(frame, nullptr);
    EXPECT_EQ(frame->bytes, picture);
    EXPECT_EQ(frame->format, PixelFormat::mjpeg);
    EXPECT_EQ(frame->pitch, 0);
    for (const std::size_t length : {0u, 1u, 2u, 3u, 5u})
        EXPECT_EQ(decode<ColorFrame>(layout, std::span(picture).first(length)), nullptr) << length;
    padded[0] = 0;
    EXPECT_EQ(decode<ColorFrame>(layout, padded), nullptr);
}

TEST(BufferLayout, RefusesWhatCannotBe) {
    const auto good = layout_of("YUYV", StreamKind::color, 8, 4);
    const auto refused = [&](auto change) {
        BufferLayout layout = good;
        change(layout);
        return !validate(layout).has_value();
    };
    EXPECT_TRUE(refused([](auto& l) { l.width = 7; }));
    EXPECT_TRUE(refused([](auto& l) { l.width = 0; }));
    EXPECT_TRUE(refused([](auto& l) { l.height = kMaxVideoSize + 1; }));
    EXPECT_TRUE(refused([](auto& l) { l.height = -1; }));
    EXPECT_TRUE(refused([](auto& l) { l.stride = 15; }));
    EXPECT_TRUE(refused([](auto& l) { l.stride = std::size_t{1} << 40; }));
    EXPECT_TRUE(refused([](auto& l) { l.kind = StreamKind::depth; }));
    EXPECT_TRUE(refused([](auto& l) { l.format = nullptr; }));
}

TEST(VideoFormats, NamesLeadBackToTheFormat) {
    for (const VideoFormat& format : video_formats()) {
        EXPECT_EQ(find_video_format(format.fourcc), &format);
        EXPECT_EQ(find_video_format(std::string(format.name)), &format);
        EXPECT_EQ(find_video_format(std::string(format.kernel_name)), &format);
        EXPECT_EQ(fourcc_text(format.fourcc), format.name);
        EXPECT_TRUE(format.can_be(format.kind));
    }
    EXPECT_EQ(find_video_format(std::string("mjpeg"))->fourcc, V4L2_PIX_FMT_MJPEG);
    EXPECT_EQ(find_video_format(std::string("NV12")), nullptr);
    EXPECT_EQ(fourcc_text(0x01020304), "....");
}

}  // namespace
}  // namespace kino
