#include "sensor/png_io.h"

#include <fmt/format.h>
#include <spng.h>

#include <algorithm>
#include <cstdlib>
#include <memory>

#include "sensor/file_bytes.h"

namespace kino {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxFileBytes = std::size_t{1} << 30;
constexpr std::size_t kMaxChunkBytes = std::size_t{4} << 20;
constexpr std::size_t kMaxChunkCache = std::size_t{16} << 20;

struct ContextFree {
    void operator()(spng_ctx* context) const { spng_ctx_free(context); }
};
using Context = std::unique_ptr<spng_ctx, ContextFree>;

struct Decoder {
    Context context;
    spng_ihdr header{};
};

Result<void> check(int code, const std::string& where) {
    if (code == SPNG_OK) return {};
    if (code == SPNG_IO_EOF || code == SPNG_EIDAT_TOO_SHORT) {
        return fail("the PNG is cut off before its end", where);
    }
    if (code == SPNG_ESIGNATURE) return fail("not a PNG file", where);
    if (code == SPNG_EUSER_WIDTH || code == SPNG_EUSER_HEIGHT) {
        return fail(fmt::format("the PNG is larger than {0}x{0}", kMaxPngSize), where);
    }
    return fail(fmt::format("the PNG is damaged: {}", spng_strerror(code)), where);
}

std::string layout_name(const spng_ihdr& header) {
    const char* kind = "grey";
    switch (header.color_type) {
        case SPNG_COLOR_TYPE_TRUECOLOR:
            kind = "RGB";
            break;
        case SPNG_COLOR_TYPE_INDEXED:
            kind = "palette";
            break;
        case SPNG_COLOR_TYPE_GRAYSCALE_ALPHA:
            kind = "grey with alpha";
            break;
        case SPNG_COLOR_TYPE_TRUECOLOR_ALPHA:
            kind = "RGBA";
            break;
        default:
            break;
    }
    return fmt::format("{} bit {}", header.bit_depth, kind);
}

Result<Decoder> open_decoder(std::span<const std::uint8_t> bytes, const std::string& where) {
    Decoder decoder{Context(spng_ctx_new(0)), {}};
    spng_ctx* context = decoder.context.get();
    if (!context) return fail("out of memory", where);
    KINO_TRY(check(spng_set_image_limits(context, kMaxPngSize, kMaxPngSize), where));
    KINO_TRY(check(spng_set_chunk_limits(context, kMaxChunkBytes, kMaxChunkCache), where));
    KINO_TRY(check(spng_set_png_buffer(context, bytes.data(), bytes.size()), where));
    KINO_TRY(check(spng_get_ihdr(context, &decoder.header), where));
    return decoder;
}

/// A deflate stream shrinks at most 1032 to 1 (zlib's technical notes), so a picture that cannot
/// come from so few bytes is refused before its memory is asked for.
Result<void> check_plausible(std::size_t pixel_bytes, std::size_t file_bytes,
                             const std::string& where) {
    if (pixel_bytes / 1100 > file_bytes) return fail("the PNG is cut off before its end", where);
    return {};
}

Result<void> decode_into(Decoder& decoder, void* pixels, std::size_t size, int format,
                         const std::string& where) {
    std::size_t needed = 0;
    KINO_TRY(check(spng_decoded_image_size(decoder.context.get(), format, &needed), where));
    if (needed != size) return fail("the PNG's layout does not fit its header", where);
    return check(spng_decode_image(decoder.context.get(), pixels, size, format, SPNG_DECODE_TRNS),
                 where);
}

struct Encoded {
    std::unique_ptr<void, decltype(&std::free)> data{nullptr, &std::free};
    std::size_t size = 0;
};

Result<Encoded> encode(int width, int height, int bit_depth, int color_type, const void* pixels,
                       std::size_t size, PngWriteOptions options) {
    if (width <= 0 || height <= 0 || width > kMaxPngSize || height > kMaxPngSize) {
        return fail(fmt::format("a picture of {}x{} cannot be written", width, height));
    }
    const Context context(spng_ctx_new(SPNG_CTX_ENCODER));
    if (!context) return fail("out of memory");
    spng_ctx* c = context.get();
    spng_ihdr header{};
    header.width = static_cast<std::uint32_t>(width);
    header.height = static_cast<std::uint32_t>(height);
    header.bit_depth = static_cast<std::uint8_t>(bit_depth);
    header.color_type = static_cast<std::uint8_t>(color_type);
    KINO_TRY(check(spng_set_option(c, SPNG_ENCODE_TO_BUFFER, 1), {}));
    KINO_TRY(check(
        spng_set_option(c, SPNG_IMG_COMPRESSION_LEVEL, std::clamp(options.compression, 0, 9)), {}));
    // Trying all five filters costs more than deflate at the fast levels.
    const int filters = options.compression >= 5 ? SPNG_FILTER_CHOICE_ALL : SPNG_FILTER_CHOICE_SUB;
    KINO_TRY(check(spng_set_option(c, SPNG_FILTER_CHOICE, filters), {}));
    KINO_TRY(check(spng_set_ihdr(c, &header), {}));
    KINO_TRY(check(spng_encode_image(c, pixels, size, SPNG_FMT_PNG, SPNG_ENCODE_FINALIZE), {}));
    int code = 0;
    Encoded out;
    out.data.reset(spng_get_png_buffer(c, &out.size, &code));
    KINO_TRY(check(code, {}));
    return out;
}

template <class T>
Result<Encoded> encode_view(ImageView<const T> image, int bit_depth, int color_type,
                            PngWriteOptions options) {
    const std::size_t row = static_cast<std::size_t>(std::max(image.width, 0)) * sizeof(T);
    const std::size_t size = row * static_cast<std::size_t>(std::max(image.height, 0));
    if (image.pitch == image.width) {
        return encode(image.width, image.height, bit_depth, color_type, image.data, size, options);
    }
    std::vector<T> packed;
    for (int y = 0; y < image.height; ++y) {
        packed.insert(packed.end(), image.row(y), image.row(y) + image.width);
    }
    return encode(image.width, image.height, bit_depth, color_type, packed.data(), size, options);
}

Result<void> save(Result<Encoded> encoded, const fs::path& path) {
    if (!encoded) return fail(encoded.error(), path.string());
    return write_file_bytes(path, encoded->data.get(), encoded->size);
}

}  // namespace

Result<PngSize> read_png_size(const fs::path& path) {
    KINO_ASSIGN(const auto bytes, read_file_bytes(path, kMaxFileBytes));
    KINO_ASSIGN(const Decoder decoder, open_decoder(bytes, path.string()));
    return PngSize{static_cast<int>(decoder.header.width), static_cast<int>(decoder.header.height)};
}

Result<Image<std::uint16_t>> decode_png_gray16(std::span<const std::uint8_t> bytes,
                                               const std::string& where) {
    KINO_ASSIGN(Decoder decoder, open_decoder(bytes, where));
    if (decoder.header.color_type != SPNG_COLOR_TYPE_GRAYSCALE || decoder.header.bit_depth != 16) {
        return fail(
            fmt::format("depth must be 16 bit grey, this PNG is {}", layout_name(decoder.header)),
            where);
    }
    const auto width = static_cast<std::size_t>(decoder.header.width);
    const auto height = static_cast<std::size_t>(decoder.header.height);
    KINO_TRY(check_plausible(width * height * 2, bytes.size(), where));
    Image<std::uint16_t> image(static_cast<int>(width), static_cast<int>(height));
    KINO_TRY(decode_into(decoder, image.data(), image.size() * 2, SPNG_FMT_PNG, where));
    return image;
}

Result<Image<std::uint16_t>> read_png_gray16(const fs::path& path) {
    KINO_ASSIGN(const auto bytes, read_file_bytes(path, kMaxFileBytes));
    return decode_png_gray16(bytes, path.string());
}

Result<Image<Rgba8>> decode_png_rgba8(std::span<const std::uint8_t> bytes,
                                      const std::string& where) {
    KINO_ASSIGN(Decoder decoder, open_decoder(bytes, where));
    if (decoder.header.bit_depth > 8) {
        return fail(fmt::format("a picture must have 8 bits a channel, this PNG is {}",
                                layout_name(decoder.header)),
                    where);
    }
    const auto width = static_cast<std::size_t>(decoder.header.width);
    const auto height = static_cast<std::size_t>(decoder.header.height);
    KINO_TRY(check_plausible(width * height * decoder.header.bit_depth / 8, bytes.size(), where));
    Image<Rgba8> image(static_cast<int>(width), static_cast<int>(height));
    KINO_TRY(decode_into(decoder, image.data(), image.size() * 4, SPNG_FMT_RGBA8, where));
    return image;
}

Result<Image<Rgba8>> read_png_rgba8(const fs::path& path) {
    KINO_ASSIGN(const auto bytes, read_file_bytes(path, kMaxFileBytes));
    return decode_png_rgba8(bytes, path.string());
}

Result<void> write_png_gray16(const fs::path& path, ImageView<const std::uint16_t> image,
                              PngWriteOptions options) {
    return save(encode_view(image, 16, SPNG_COLOR_TYPE_GRAYSCALE, options), path);
}

Result<void> write_png_rgba8(const fs::path& path, ImageView<const Rgba8> image,
                             PngWriteOptions options) {
    return save(encode_view(image, 8, SPNG_COLOR_TYPE_TRUECOLOR_ALPHA, options), path);
}

Result<void> write_png_gray16(const fs::path& path, const Image<std::uint16_t>& image,
                              PngWriteOptions options) {
    return write_png_gray16(path, image.view(), options);
}

Result<void> write_png_rgba8(const fs::path& path, const Image<Rgba8>& image,
                             PngWriteOptions options) {
    return write_png_rgba8(path, image.view(), options);
}

Result<std::vector<std::uint8_t>> encode_png_rgba8(ImageView<const Rgba8> image,
                                                   PngWriteOptions options) {
    KINO_ASSIGN(const Encoded encoded,
                encode_view(image, 8, SPNG_COLOR_TYPE_TRUECOLOR_ALPHA, options));
    const auto* bytes = static_cast<const std::uint8_t*>(encoded.data.get());
    return std::vector<std::uint8_t>(bytes, bytes + encoded.size);
}

}  // namespace kino
