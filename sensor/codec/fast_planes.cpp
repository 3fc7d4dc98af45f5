#include "sensor/codec/fast_planes.h"

#include <algorithm>

namespace kino::fast {
namespace {

/// Where the samples of a plane lie among the pixels' bytes.
struct Samples {
    int first = 0;  ///< byte of the first row
    int first_row = 0;
    int step = 1;      ///< bytes from one to the next
    int row_step = 1;  ///< rows
    bool minus_green = false;
};

Samples samples_of(PixelLayout layout, int plane) {
    constexpr int kChannel[] = {1, 0, 2, 3};  // green, red, blue, alpha
    constexpr Samples kUyvy[] = {{1, 0, 2}, {0, 0, 4}, {2, 0, 4}};
    constexpr Samples kYuyv[] = {{0, 0, 2}, {1, 0, 4}, {3, 0, 4}};
    switch (layout) {
        case PixelLayout::gray16:
        case PixelLayout::gray8:
            break;
        case PixelLayout::bayer8:
            return {plane % 2, plane / 2, 2, 2};
        case PixelLayout::rgb8:
            return {kChannel[plane], 0, 3, 1, plane == 1 || plane == 2};
        case PixelLayout::rgba8:
            return {kChannel[plane], 0, 4, 1, plane == 1 || plane == 2};
        case PixelLayout::yuv422:
            return kUyvy[plane];
        case PixelLayout::yuyv422:
            return kYuyv[plane];
    }
    return {};
}

/// Calls visit(bytes of the row from the first sample on, its samples) for every row of a plane.
template <class Byte, class Sample, class Visit>
void each_row(const ImageFormat& format, int plane, Byte* pixels, Sample* samples, Visit visit) {
    const Samples at = samples_of(format.layout, plane);
    const PlaneSize size = plane_size(format, plane);
    const std::size_t pitch = bytes_per_frame(format) / static_cast<std::size_t>(format.height);
    if (size.width == 0) return;
    for (int y = 0; y < size.height; ++y, samples += size.width) {
        visit(pixels + pitch * static_cast<std::size_t>(at.first_row + y * at.row_step) + at.first,
              samples);
    }
}

/// The step as a constant, so that the loops over a row can be vectorised.
template <class Visit>
void with_step(int step, Visit visit) {
    switch (step) {
        case 1:
            return visit(std::integral_constant<int, 1>());
        case 2:
            return visit(std::integral_constant<int, 2>());
        case 3:
            return visit(std::integral_constant<int, 3>());
        default:
            return visit(std::integral_constant<int, 4>());
    }
}

}  // namespace

int plane_count(PixelLayout layout) {
    switch (layout) {
        case PixelLayout::gray16:
        case PixelLayout::gray8:
            return 1;
        case PixelLayout::rgb8:
        case PixelLayout::yuv422:
        case PixelLayout::yuyv422:
            return 3;
        case PixelLayout::bayer8:
        case PixelLayout::rgba8:
            return 4;
    }
    return 0;
}

PlaneSize plane_size(const ImageFormat& format, int plane) {
    switch (format.layout) {
        case PixelLayout::bayer8:
            return {(format.width + 1 - plane % 2) / 2, (format.height + 1 - plane / 2) / 2};
        case PixelLayout::yuv422:
        case PixelLayout::yuyv422:
            return {plane == 0 ? format.width : format.width / 2, format.height};
        default:
            return {format.width, format.height};
    }
}

void split(const ImageFormat& format, int plane, const std::uint8_t* pixels, std::uint16_t* out) {
    const Samples at = samples_of(format.layout, plane);
    const int width = plane_size(format, plane).width;
    const int green = 1 - at.first;
    with_step(at.step, [&](auto step) {
        each_row(format, plane, pixels, out, [&](const std::uint8_t* in, std::uint16_t* to) {
            if (at.minus_green) {
                for (int x = 0; x < width; ++x) {
                    const int difference = in[x * step] - in[x * step + green] + 128;
                    to[x] = static_cast<std::uint16_t>((difference & 0xFF) + 1);
                }
            } else {
                for (int x = 0; x < width; ++x) {
                    to[x] = static_cast<std::uint16_t>(in[x * step] + 1);
                }
            }
        });
    });
}

void join(const ImageFormat& format, int plane, const std::uint16_t* in, std::uint8_t* pixels) {
    const Samples at = samples_of(format.layout, plane);
    const int width = plane_size(format, plane).width;
    const int green = 1 - at.first;
    with_step(at.step, [&](auto step) {
        each_row(format, plane, pixels, in, [&](std::uint8_t* to, const std::uint16_t* from) {
            if (at.minus_green) {
                for (int x = 0; x < width; ++x) {
                    const int sample = from[x] - 1 - 128 + to[x * step + green];
                    to[x * step] = static_cast<std::uint8_t>(sample);
                }
            } else {
                for (int x = 0; x < width; ++x) {
                    to[x * step] = static_cast<std::uint8_t>(std::max(from[x] - 1, 0));
                }
            }
        });
    });
}

}  // namespace kino::fast
