#include <fmt/format.h>

#include <cstdio>
#include <fstream>

#include "codec_pictures.h"
#include "tests/support/temp_dir.h"

extern "C" {
#include <libavformat/avformat.h>
}

namespace kino {
namespace {

using test::Bytes;

/// What a plain player is given: Matroska with V_FFV1 and our private data.
void mux(const std::filesystem::path& path, const ImageFormat& format, const Bytes& private_data,
         const std::vector<Bytes>& packets) {
    AVFormatContext* file = nullptr;
    ASSERT_GE(avformat_alloc_output_context2(&file, nullptr, "matroska", path.c_str()), 0);
    AVStream* stream = avformat_new_stream(file, nullptr);
    stream->time_base = {1, 1000};
    stream->codecpar->codec_type = AVMEDIA_TYPE_VIDEO;
    stream->codecpar->codec_id = AV_CODEC_ID_FFV1;
    stream->codecpar->width = format.width;
    stream->codecpar->height = format.height;
    stream->codecpar->extradata =
        static_cast<std::uint8_t*>(av_mallocz(private_data.size() + AV_INPUT_BUFFER_PADDING_SIZE));
    std::copy(private_data.begin(), private_data.end(), stream->codecpar->extradata);
    stream->codecpar->extradata_size = static_cast<int>(private_data.size());
    ASSERT_GE(avio_open(&file->pb, path.c_str(), AVIO_FLAG_WRITE), 0);
    ASSERT_GE(avformat_write_header(file, nullptr), 0);
    AVPacket* packet = av_packet_alloc();
    for (std::size_t i = 0; i < packets.size(); ++i) {
        ASSERT_GE(av_new_packet(packet, static_cast<int>(packets[i].size())), 0);
        std::copy(packets[i].begin(), packets[i].end(), packet->data);
        packet->pts = packet->dts = static_cast<std::int64_t>(i) * 33;
        packet->flags = AV_PKT_FLAG_KEY;
        ASSERT_GE(av_interleaved_write_frame(file, packet), 0);
    }
    av_packet_free(&packet);
    ASSERT_GE(av_write_trailer(file), 0);
    avio_closep(&file->pb);
    avformat_free_context(file);
}

Bytes file_bytes(const std::filesystem::path& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

/// Every frame as the ffmpeg program decodes it.
Bytes decoded_by_ffmpeg(const std::filesystem::path& folder, const ImageFormat& format,
                        const Bytes& private_data, const std::vector<Bytes>& packets,
                        const char* pixel_format) {
    const auto video = folder / "a.mkv";
    const auto raw = folder / "a.raw";
    mux(video, format, private_data, packets);
    const std::string command = fmt::format(
        "ffmpeg -nostdin -v error -xerror -y -i '{}' -fps_mode passthrough -f rawvideo -pix_fmt {} "
        "'{}'",
        video.string(), pixel_format, raw.string());
    EXPECT_EQ(std::system(command.c_str()), 0) << command;
    return file_bytes(raw);
}

TEST(Ffv1, TheFfmpegProgramDecodesTheSamePixels) {
    const test::TempDir folder;
    const struct {
        PixelLayout layout;
        const char* name;
    } cases[] = {{PixelLayout::gray16, "gray16le"}, {PixelLayout::gray8, "gray"},
                 {PixelLayout::bayer8, "gray"},     {PixelLayout::rgb8, "rgb24"},
                 {PixelLayout::rgba8, "rgba"},      {PixelLayout::yuv422, "uyvy422"},
                 {PixelLayout::yuyv422, "yuyv422"}};
    for (const auto& [layout, name] : cases) {
        for (const int width : {640, 98}) {
            const ImageFormat format{ImageCodec::ffv1, layout, width, width * 3 / 4};
            auto encoder = make_image_encoder(format, {.threads = 2});
            ASSERT_TRUE(encoder);
            std::vector<Bytes> packets;
            Bytes pixels;
            for (const auto content : {test::Content::scene, test::Content::noise}) {
                const Bytes frame = test::make_picture(format, content, 5);
                packets.push_back(test::encoded(**encoder, frame));
                pixels.insert(pixels.end(), frame.begin(), frame.end());
            }
            EXPECT_TRUE(decoded_by_ffmpeg(folder.path(), format, test::private_of(**encoder),
                                          packets, name) == pixels)
                << name << " " << width;
        }
    }
}

TEST(Ffv1, TheFfmpegProgramDecodesTheRealRecordings) {
    const test::TempDir folder;
    std::vector<Bytes> packets;
    Bytes pixels;
    const ImageFormat format{ImageCodec::ffv1, PixelLayout::gray16, 640, 480};
    auto encoder = make_image_encoder(format);
    ASSERT_TRUE(encoder);
    for (const test::RealDepth& frame : test::real_depth()) {
        if (frame.image.width() != 640 || frame.image.height() != 480) continue;
        const Bytes bytes = test::bytes_of(frame.image);
        packets.push_back(test::encoded(**encoder, bytes));
        pixels.insert(pixels.end(), bytes.begin(), bytes.end());
    }
    ASSERT_GE(packets.size(), 10u);
    EXPECT_TRUE(decoded_by_ffmpeg(folder.path(), format, test::private_of(**encoder), packets,
                                  "gray16le") == pixels);
}

TEST(Ffv1, ThreadsDoNotChangeTheBytes) {
    const ImageFormat format{ImageCodec::ffv1, PixelLayout::gray16, 640, 480};
    const Bytes pixels = test::make_picture(format, test::Content::scene, 9);
    auto one = make_image_encoder(format);
    auto two = make_image_encoder(format, {.threads = 2});
    ASSERT_TRUE(one && two);
    const Bytes data = test::encoded(**one, pixels);
    EXPECT_EQ(data, test::encoded(**two, pixels));
    auto decoder = make_image_decoder(format, (*two)->private_data(), {.threads = 2});
    ASSERT_TRUE(decoder);
    Bytes back(pixels.size());
    ASSERT_TRUE((*decoder)->decode(data, back));
    EXPECT_EQ(back, pixels);
}

// libavcodec alone shows such a frame with the slice of the frame before in it.
TEST(Ffv1, ADamagedSliceIsNotPaintedOver) {
    const ImageFormat format{ImageCodec::ffv1, PixelLayout::gray16, 640, 480};
    auto encoder = make_image_encoder(format);
    ASSERT_TRUE(encoder);
    auto decoder = make_image_decoder(format, (*encoder)->private_data());
    ASSERT_TRUE(decoder);
    const Bytes first =
        test::encoded(**encoder, test::make_picture(format, test::Content::scene, 1));
    Bytes back(bytes_per_frame(format));
    ASSERT_TRUE((*decoder)->decode(first, back));
    Bytes second = test::encoded(**encoder, test::make_picture(format, test::Content::scene, 2));
    second[second.size() * 2 / 3] ^= 1;
    EXPECT_FALSE((*decoder)->decode(second, back));
}

}  // namespace
}  // namespace kino
