#include "sensor/jpeg.h"

#include <fmt/format.h>
#include <turbojpeg.h>

#include <algorithm>
#include <array>
#include <memory>

namespace kino {
namespace {

constexpr int kMaxJpegEdge = 16384;

struct HandleClose {
    void operator()(void* handle) const { tjDestroy(handle); }
};
using Handle = std::unique_ptr<void, HandleClose>;

bool has_end_marker(std::span<const std::uint8_t> bytes) {
    constexpr std::array<std::uint8_t, 2> kEndOfImage = {0xFF, 0xD9};
    return std::search(bytes.begin(), bytes.end(), kEndOfImage.begin(), kEndOfImage.end()) !=
           bytes.end();
}

}  // namespace

Result<void> decode_jpeg(std::span<const std::uint8_t> bytes, int width, int height,
                         Image<Rgba8>& out) {
    const Handle handle(tjInitDecompress());
    if (!handle) return fail("the JPEG decoder could not be opened");
    int real_width = 0;
    int real_height = 0;
    int subsampling = 0;
    int color_space = 0;
    if (bytes.empty() || tjDecompressHeader3(handle.get(), bytes.data(), bytes.size(), &real_width,
                                             &real_height, &subsampling, &color_space) != 0) {
        return fail("not a JPEG picture");
    }
    if (real_width != width || real_height != height || width > kMaxJpegEdge ||
        height > kMaxJpegEdge) {
        return fail(fmt::format("the JPEG is {}x{}, the frame {}x{}", real_width, real_height,
                                width, height));
    }
    out.resize(width, height);
    // A scan limit (TJFLAG_LIMITSCANS) stops progressive files made to decode for minutes.
    const int code = tjDecompress2(handle.get(), bytes.data(), bytes.size(),
                                   reinterpret_cast<unsigned char*>(out.data()), width, width * 4,
                                   height, TJPF_RGBA, TJFLAG_ACCURATEDCT | TJFLAG_LIMITSCANS);
    if (code == 0) return {};
    // Webcams pad and misplace markers; only a picture without an end has missing pixels.
    const bool harmless = tjGetErrorCode(handle.get()) == TJERR_WARNING && has_end_marker(bytes);
    if (harmless) return {};
    return fail(fmt::format("the JPEG is damaged: {}", tjGetErrorStr2(handle.get())));
}

}  // namespace kino
