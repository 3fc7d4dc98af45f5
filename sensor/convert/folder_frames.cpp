#include "sensor/convert/folder_frames.h"

#include <fmt/format.h>

#include "sensor/color_conversion.h"
#include "sensor/png_io.h"

namespace kino {

Result<void> write_color_png(const std::filesystem::path& file, const ColorFrame& frame,
                             Losses& losses) {
    Image<Rgba8> image;
    KINO_TRY(to_rgba8(frame, image));
    const bool plain = frame.format == PixelFormat::rgba8 || frame.format == PixelFormat::rgb8 ||
                       frame.format == PixelFormat::gray8;
    if (!plain) losses.state("colour as the camera sent it (Bayer, YUV or JPEG) became RGB");
    return write_png_rgba8(file, image);
}

void add_unheld(StreamKind kind, Losses& losses) {
    losses.add(fmt::format("{} frames, which this format cannot hold", stream_name(kind)));
}

Result<void> check_size(const char* stream, int width, int height, const CameraModel& camera) {
    if (width == camera.width && height == camera.height) return {};
    return fail(fmt::format("a {} frame has {}x{} pixels, its camera {}x{}", stream, width, height,
                            camera.width, camera.height));
}

}  // namespace kino
