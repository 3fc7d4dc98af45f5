#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/image.h"

namespace kino {

/// Widest and highest picture that is read; larger ones are refused before anything is allocated.
constexpr int kMaxPngSize = 16384;

struct PngSize {
    int width = 0;
    int height = 0;
};

/// Size from the header alone; nothing is decoded.
[[nodiscard]] Result<PngSize> read_png_size(const std::filesystem::path& path);

/// 16-bit grey, host byte order: raw depth. Any other layout is an error that names it.
[[nodiscard]] Result<Image<std::uint16_t>> read_png_gray16(const std::filesystem::path& path);
[[nodiscard]] Result<Image<std::uint16_t>> decode_png_gray16(std::span<const std::uint8_t> bytes,
                                                             const std::string& where);

/// 8-bit grey, grey-alpha, palette, RGB or RGBA as RGBA; alpha 255 where the file has none.
/// 16-bit files are refused, so that a depth image is never taken for a picture.
[[nodiscard]] Result<Image<Rgba8>> read_png_rgba8(const std::filesystem::path& path);
[[nodiscard]] Result<Image<Rgba8>> decode_png_rgba8(std::span<const std::uint8_t> bytes,
                                                    const std::string& where);

struct PngWriteOptions {
    int compression = 1;  ///< zlib level 0..9; 1 writes a 1280x720 picture in some 20 ms
};

/// Lossless: reading back gives the same pixels. Rows may be padded (view.pitch counts pixels).
[[nodiscard]] Result<void> write_png_gray16(const std::filesystem::path& path,
                                            ImageView<const std::uint16_t> image,
                                            PngWriteOptions options = {});
[[nodiscard]] Result<void> write_png_rgba8(const std::filesystem::path& path,
                                           ImageView<const Rgba8> image,
                                           PngWriteOptions options = {});
[[nodiscard]] Result<void> write_png_gray16(const std::filesystem::path& path,
                                            const Image<std::uint16_t>& image,
                                            PngWriteOptions options = {});
[[nodiscard]] Result<void> write_png_rgba8(const std::filesystem::path& path,
                                           const Image<Rgba8>& image, PngWriteOptions options = {});
[[nodiscard]] Result<std::vector<std::uint8_t>> encode_png_rgba8(ImageView<const Rgba8> image,
                                                                 PngWriteOptions options = {});

}  // namespace kino
