#include "viz/surface/assets/gltf_document.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <optional>
#include <string_view>

#include "sensor/jpeg.h"
#include "sensor/png_io.h"

namespace kino {
namespace {

using Bytes = std::span<const std::uint8_t>;

constexpr std::uint32_t kGlbMagic = 0x46546C67;
constexpr std::uint32_t kJsonChunk = 0x4E4F534A;
constexpr std::uint32_t kBinChunk = 0x004E4942;

std::uint32_t word_at(Bytes bytes, std::size_t at) {
    return static_cast<std::uint32_t>(bytes[at]) | static_cast<std::uint32_t>(bytes[at + 1]) << 8 |
           static_cast<std::uint32_t>(bytes[at + 2]) << 16 |
           static_cast<std::uint32_t>(bytes[at + 3]) << 24;
}

struct Container {
    Bytes json;
    std::optional<Bytes> bin;
};

Result<Container> split(Bytes bytes, const std::string& where) {
    if (bytes.size() < 12 || word_at(bytes, 0) != kGlbMagic) return Container{.json = bytes};
    if (word_at(bytes, 4) != 2) return fail("not a GLB of version 2", where);
    const std::size_t length = word_at(bytes, 8);
    if (length < 20 || length > bytes.size()) return fail("the GLB is cut off", where);
    Container found;
    std::size_t at = 12;
    while (length - at >= 8) {
        const std::size_t size = word_at(bytes, at);
        const std::uint32_t kind = word_at(bytes, at + 4);
        at += 8;
        if (size > length - at) return fail("a chunk of the GLB runs past its end", where);
        const Bytes chunk = bytes.subspan(at, size);
        if (at == 20) {
            if (kind != kJsonChunk) return fail("the GLB does not begin with its JSON", where);
            found.json = chunk;
        } else if (kind == kBinChunk && !found.bin) {
            found.bin = chunk;
        }
        at += size;
        // Chunks are padded to four bytes; a writer that forgot is forgiven at the end.
        at = std::min((at + 3) / 4 * 4, length);
    }
    if (found.json.empty()) return fail("the GLB has no JSON", where);
    return found;
}

/// Parsers recurse; a text of brackets must not use up the stack.
bool nests_deeper(Bytes text, std::size_t limit) {
    std::size_t depth = 0;
    bool quoted = false;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = static_cast<char>(text[i]);
        if (quoted) {
            if (c == '\\') ++i;
            if (c == '"') quoted = false;
        } else if (c == '"') {
            quoted = true;
        } else if (c == '[' || c == '{') {
            if (++depth > limit) return true;
        } else if ((c == ']' || c == '}') && depth > 0) {
            --depth;
        }
    }
    return false;
}

/// RFC 4648, without line breaks.
Result<std::vector<std::uint8_t>> decode_base64(std::string_view text, const std::string& where) {
    static constexpr std::string_view kDigits =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::array<std::int8_t, 256> value{};
    value.fill(-1);
    for (std::size_t i = 0; i < kDigits.size(); ++i) {
        value[static_cast<std::uint8_t>(kDigits[i])] = static_cast<std::int8_t>(i);
    }
    while (!text.empty() && text.back() == '=') text.remove_suffix(1);
    std::vector<std::uint8_t> bytes;
    bytes.reserve(text.size() * 3 / 4);
    std::uint32_t gathered = 0;
    int bits = 0;
    for (const char c : text) {
        const int digit = value[static_cast<std::uint8_t>(c)];
        if (digit < 0) return fail("a data URI is not base64", where);
        gathered = gathered << 6 | static_cast<std::uint32_t>(digit);
        bits += 6;
        if (bits >= 8) {
            bits -= 8;
            bytes.push_back(static_cast<std::uint8_t>(gathered >> bits));
        }
    }
    return bytes;
}

/// %41 -> A. Names that would leave the folder, or that a URI scheme opens, are refused.
Result<std::string> file_name_of(std::string_view uri, const std::string& where) {
    std::string name;
    for (std::size_t i = 0; i < uri.size(); ++i) {
        const auto hex = [&](std::size_t at) {
            if (at >= uri.size()) return -1;
            const char c = uri[at];
            if (c >= '0' && c <= '9') return c - '0';
            if (c >= 'a' && c <= 'f') return c - 'a' + 10;
            if (c >= 'A' && c <= 'F') return c - 'A' + 10;
            return -1;
        };
        if (uri[i] != '%') {
            name += uri[i];
            continue;
        }
        if (hex(i + 1) < 0 || hex(i + 2) < 0) return fail("a URI is damaged", where);
        name += static_cast<char>(hex(i + 1) * 16 + hex(i + 2));
        i += 2;
    }
    const bool plain = !name.empty() && name.front() != '/' &&
                       name.find_first_of(std::string_view(":\\\0", 3)) == std::string::npos;
    bool climbs = false;
    for (std::size_t at = 0; at <= name.size();) {
        const std::size_t end = std::min(name.find('/', at), name.size());
        climbs = climbs || std::string_view(name).substr(at, end - at) == "..";
        at = end + 1;
    }
    if (!plain || climbs) {
        return fail("a file outside of the folder is named", where,
                    "only files beside the model are read");
    }
    return name;
}

Result<std::vector<std::uint8_t>> resolve_uri(const std::string& uri, const std::string& where,
                                              const GltfReadFile& read, const GltfLimits& limits) {
    if (uri.starts_with("data:")) {
        const std::size_t comma = uri.find(',');
        if (comma == std::string::npos ||
            !std::string_view(uri).substr(0, comma).ends_with(";base64")) {
            return fail("a data URI is not base64", where);
        }
        return decode_base64(std::string_view(uri).substr(comma + 1), where);
    }
    KINO_ASSIGN(const std::string name, file_name_of(uri, where));
    return read(name, limits.file_bytes);
}

/// Width and height out of the first frame header.
std::optional<std::array<int, 2>> jpeg_size(Bytes bytes) {
    std::size_t at = 2;
    while (at + 9 < bytes.size() && bytes[at] == 0xFF) {
        const std::uint8_t marker = bytes[at + 1];
        if (marker == 0xFF) {
            ++at;
            continue;
        }
        const bool frame =
            marker >= 0xC0 && marker <= 0xCF && marker != 0xC4 && marker != 0xC8 && marker != 0xCC;
        if (frame) {
            return std::array{bytes[at + 7] << 8 | bytes[at + 8],
                              bytes[at + 5] << 8 | bytes[at + 6]};
        }
        at += 2 + static_cast<std::size_t>(bytes[at + 2] << 8 | bytes[at + 3]);
    }
    return std::nullopt;
}

}  // namespace

Result<GltfDocument> open_gltf(Bytes bytes, const std::string& where, const GltfReadFile& read,
                               const GltfLimits& limits) {
    if (bytes.size() > limits.file_bytes) return fail("the file is too large", where);
    KINO_ASSIGN(const Container container, split(bytes, where));
    if (nests_deeper(container.json, limits.nesting)) {
        return fail("the JSON nests too deeply", where);
    }
    GltfDocument document;
    document.json =
        nlohmann::json::parse(container.json.begin(), container.json.end(), nullptr, false);
    if (!document.json.is_object()) return fail("not a glTF file", where, "JSON or GLB is read");
    const auto buffers = document.json.find("buffers");
    if (buffers == document.json.end()) return document;
    if (!buffers->is_array() || buffers->size() > limits.items) {
        return fail("buffers are not a list", where + "#/buffers");
    }
    std::size_t total = 0;
    for (std::size_t i = 0; i < buffers->size(); ++i) {
        const nlohmann::json& buffer = (*buffers)[i];
        const std::string place = fmt::format("{}#/buffers/{}", where, i);
        if (!buffer.is_object() || !buffer.contains("byteLength") ||
            !buffer["byteLength"].is_number_unsigned()) {
            return fail("a buffer without a length", place);
        }
        const auto length = buffer["byteLength"].get<std::uint64_t>();
        std::vector<std::uint8_t> content;
        if (!buffer.contains("uri")) {
            if (i != 0 || !container.bin) return fail("a buffer without bytes", place);
            content.assign(container.bin->begin(), container.bin->end());
        } else {
            if (!buffer["uri"].is_string()) return fail("a URI that is no text", place);
            KINO_ASSIGN(content, resolve_uri(buffer["uri"].get_ref<const std::string&>(), place,
                                             read, limits));
        }
        if (length == 0 || length > content.size()) {
            return fail(fmt::format("a buffer has {} of its {} bytes", content.size(), length),
                        place);
        }
        content.resize(length);
        total += length;
        if (total > limits.file_bytes) return fail("the buffers are too large", where);
        document.buffers.push_back(std::move(content));
    }
    return document;
}

Result<GltfPicture> gltf_picture(const GltfDocument& document, std::size_t index,
                                 const std::string& where, const GltfReadFile& read,
                                 const GltfLimits& limits) {
    GltfPicture picture{.bytes = {}, .where = fmt::format("{}#/images/{}", where, index)};
    const auto images = document.json.find("images");
    if (images == document.json.end() || !images->is_array() || index >= images->size() ||
        !(*images)[index].is_object()) {
        return fail("no such image", picture.where);
    }
    const nlohmann::json& image = (*images)[index];
    if (image.contains("uri")) {
        if (!image["uri"].is_string()) return fail("a URI that is no text", picture.where);
        KINO_ASSIGN(picture.bytes, resolve_uri(image["uri"].get_ref<const std::string&>(),
                                               picture.where, read, limits));
        return picture;
    }
    const auto view_number = image.find("bufferView");
    if (view_number == image.end() || !view_number->is_number_unsigned() ||
        view_number->get<std::uint64_t>() >= document.json["bufferViews"].size()) {
        return fail("an image without bytes", picture.where);
    }
    // check_gltf() saw every view.
    const nlohmann::json& view = document.json["bufferViews"][view_number->get<std::size_t>()];
    const auto& buffer = document.buffers[view["buffer"].get<std::size_t>()];
    const std::size_t offset = view.value("byteOffset", std::size_t{0});
    const auto begin = buffer.begin() + static_cast<std::ptrdiff_t>(offset);
    picture.bytes.assign(
        begin, begin + static_cast<std::ptrdiff_t>(view["byteLength"].get<std::size_t>()));
    return picture;
}

Result<Image<Rgba8>> decode_picture(const GltfPicture& picture, const GltfLimits& limits) {
    const Bytes bytes = picture.bytes;
    const auto too_large = [&](std::int64_t width, std::int64_t height) {
        return width < 1 || height < 1 || width > limits.texture_px || height > limits.texture_px;
    };
    constexpr std::array<std::uint8_t, 8> kPng = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'};
    if (bytes.size() > 24 && std::equal(kPng.begin(), kPng.end(), bytes.begin())) {
        const auto big_endian = [&](std::size_t at) {
            return std::int64_t{bytes[at]} << 24 | bytes[at + 1] << 16 | bytes[at + 2] << 8 |
                   bytes[at + 3];
        };
        if (too_large(big_endian(16), big_endian(20))) {
            return fail("a texture is too large", picture.where);
        }
        return decode_png_rgba8(bytes, picture.where);
    }
    if (bytes.size() > 4 && bytes[0] == 0xFF && bytes[1] == 0xD8) {
        const auto size = jpeg_size(bytes);
        if (!size || too_large((*size)[0], (*size)[1])) {
            return fail("a texture is damaged or too large", picture.where);
        }
        Image<Rgba8> image((*size)[0], (*size)[1]);
        KINO_TRY(decode_jpeg(bytes, image.width(), image.height(), image));
        return image;
    }
    return fail("a texture that is neither PNG nor JPEG", picture.where);
}

}  // namespace kino
