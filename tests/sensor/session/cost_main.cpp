#include <fmt/format.h>
#include <sys/resource.h>

#include <cstdlib>
#include <filesystem>
#include <string_view>
#include <thread>

#include "sensor/session/recorder.h"
#include "session_frames.h"

/// session_cost FILE ffv1|fast|rvl|raw SECONDS [folder]: records 30 Hz of 640x480 depth and Bayer
/// colour in real time and prints the share of one core that the process took. The frames are made
/// before the clock starts; with a folder (of the TUM kind) they are its own, colour as one Bayer
/// mosaic, else synthetic.
namespace {

using namespace kino;

double cpu_seconds() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    const auto seconds = [](timeval t) {
        return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
    };
    return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

SessionCodec codec_of(std::string_view name) {
    if (name == "fast") return SessionCodec::fast;
    if (name == "rvl") return SessionCodec::rvl;
    return name == "raw" ? SessionCodec::raw : SessionCodec::ffv1;
}

/// A folder's frames; its colours go through a mosaic as a sensor would see them.
std::vector<test::PutFrame> frames_of(const std::string& folder, int count) {
    std::vector<test::PutFrame> frames;
    auto source = open_source(folder);
    if (!source || !subscribe_all(**source)) return frames;
    for (int i = 0; i < count; ++i) {
        auto set = (*source)->next(kNsPerSecond);
        if (!set || !*set || !(*set)->depth) break;
        frames.push_back({{0, StreamKind::depth}, (*set)->depth});
        const auto& color = (*set)->color;
        if (!color || color->format == PixelFormat::mjpeg) continue;
        const int channels = color->format == PixelFormat::rgb8 ? 3 : 4;
        ColorFrame bayer;
        bayer.header = color->header;
        bayer.format = PixelFormat::bayer_grbg8;
        bayer.width = bayer.pitch = color->width;
        bayer.height = color->height;
        for (int y = 0; y < color->height; ++y) {
            for (int x = 0; x < color->width; ++x) {
                const int channel = (x + y) % 2 == 0 ? 1 : (y % 2 == 0 ? 0 : 2);
                bayer.bytes.push_back(color->bytes[static_cast<std::size_t>(
                    y * color->pitch + x * channels + channel)]);
            }
        }
        frames.push_back({{0, StreamKind::color}, std::make_shared<const ColorFrame>(bayer)});
    }
    return frames;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 4) {
        fmt::print(stderr, "session_cost FILE ffv1|fast|rvl|raw SECONDS [folder]\n");
        return 2;
    }
    test::FrameStyle style{.width = 640, .height = 480, .infrared = false, .texts = false};
    constexpr int kKept = 30;
    auto frames = argc > 4 ? frames_of(argv[4], kKept) : test::frames_between(0, kKept, style);
    if (frames.empty()) return 1;
    const int moments = static_cast<int>(frames.size() / 2);
    RecorderOptions options;
    options.codec = codec_of(argv[2]);
    std::filesystem::remove(argv[1]);
    auto recorder = Recorder::create(argv[1], test::source_of(style), test::rig_of(style), options);
    if (!recorder) {
        fmt::print(stderr, "{}\n", recorder.error().to_string());
        return 1;
    }
    const double cpu = cpu_seconds();
    const TimeNs start = now_ns();
    const int total = 30 * std::atoi(argv[3]);
    for (int i = 0; i < total; ++i) {
        const TimeNs due = start + i * kNsPerSecond / 30;
        std::this_thread::sleep_for(std::chrono::nanoseconds(due - now_ns()));
        for (std::size_t k = 0; k < 2; ++k) {
            test::PutFrame put = frames[static_cast<std::size_t>(i % moments) * 2 + k];
            std::visit(
                [&](auto& pointer) {
                    using Frame = std::remove_cvref_t<decltype(*pointer)>;
                    if constexpr (requires { pointer->header; }) {
                        auto copy = std::make_shared<Frame>(*pointer);
                        copy->header.host_time = copy->header.device_time = due;
                        copy->header.sequence = i;
                        pointer = std::move(copy);
                    }
                },
                put.frame);
            (*recorder)->put(put.id, put.frame);
        }
    }
    const double feeding = to_seconds(now_ns() - start);
    const auto closed = (*recorder)->close();
    if (!closed) {
        fmt::print(stderr, "{}\n", closed.error().to_string());
        return 1;
    }
    fmt::print("{}: {:.1f} % of one core, {} frames, {} dropped, {:.1f} MB/s\n", argv[2],
               100 * (cpu_seconds() - cpu) / feeding, closed->frames, closed->dropped,
               1e-6 * static_cast<double>(closed->bytes) / feeding);
    return 0;
}
