#include "codec_reference.h"

#include <algorithm>
#include <cstdlib>

namespace kino::reference {
namespace {

using Bytes = std::vector<std::uint8_t>;

/// Thrown by anything that runs out, and caught at the top: the simplest way to be safe.
struct NoFrame {};

std::uint32_t checksum(const Bytes& bytes, std::size_t from) {
    std::uint32_t crc = 0xFFFFFFFF;
    for (std::size_t i = from; i < bytes.size(); ++i) {
        crc ^= bytes[i];
        for (int bit = 0; bit < 8; ++bit) {
            // 0x1EDC6F41 with its bits in the opposite order.
            crc = (crc & 1) != 0 ? crc >> 1 ^ 0x82F63B78 : crc >> 1;
        }
    }
    return crc ^ 0xFFFFFFFF;
}

struct Input {
    const Bytes& bytes;
    std::size_t at = 0;

    std::uint32_t take(int count) {
        std::uint32_t value = 0;
        for (int i = 0; i < count; ++i) {
            if (at == bytes.size()) throw NoFrame();
            value += std::uint32_t{bytes[at++]} << 8 * i;
        }
        return value;
    }

    Bytes part(std::size_t count) {
        if (count > bytes.size() - at) throw NoFrame();
        const auto from = bytes.begin() + static_cast<std::ptrdiff_t>(at);
        at += count;
        return {from, from + static_cast<std::ptrdiff_t>(count)};
    }
};

struct Bits {
    Bytes bytes;
    std::size_t at = 0;

    int bit() {
        if (at == 8 * bytes.size()) throw NoFrame();
        const int value = bytes[at / 8] >> at % 8 & 1;
        ++at;
        return value;
    }
    int bits(int count) {
        int value = 0;
        for (int i = 0; i < count; ++i) value += bit() << i;
        return value;
    }
    int number() {
        int count = 0;
        while (bit() == 0) {
            if (++count > 16) throw NoFrame();
        }
        return (1 << count) + bits(count) - 1;
    }
    void end() {
        if (8 * bytes.size() - at >= 8) throw NoFrame();
        while (at < 8 * bytes.size()) {
            if (bit() != 0) throw NoFrame();
        }
    }
};

struct Plane {
    int width = 0;
    int height = 0;
    std::vector<int> indices;
    std::vector<int> values{};  ///< gray16: of the indices from 1 on
    int hole = 0;
};

struct Pixel {
    int filled = 0;
    bool hole = true;
    int index = 0;
};

/// One stripe as rows of pixels decoded so far.
using Stripe = std::vector<std::vector<Pixel>>;

struct Expectation {
    int prediction = 0;
    int context = 0;
};

Expectation expect(const Stripe& stripe, int row, int x, int width, int shift) {
    Pixel w;
    if (x > 0) w = stripe[row][x - 1];
    Pixel n = w;
    Pixel nw = w;
    Pixel ne = w;
    if (row > 0) {
        n = stripe[row - 1][x];
        nw = x > 0 ? stripe[row - 1][x - 1] : n;
        ne = x < width - 1 ? stripe[row - 1][x + 1] : n;
        if (x == 0) w = n;
    }
    Expectation out;
    if (nw.filled >= std::max(w.filled, n.filled)) {
        out.prediction = std::min(w.filled, n.filled);
    } else if (nw.filled <= std::min(w.filled, n.filled)) {
        out.prediction = std::max(w.filled, n.filled);
    } else {
        out.prediction = w.filled + n.filled - nw.filled;
    }
    if (w.hole || n.hole) {
        out.context = 6 + (w.hole ? 1 : 0) + (n.hole ? 2 : 0);
    } else {
        const int activity = std::abs(nw.filled - n.filled) + std::abs(ne.filled - n.filled) +
                             std::abs(w.filled - nw.filled);
        const int place = std::min(std::min(activity, 65535) >> shift, 15);
        out.context = std::vector{0, 1, 2, 3, 3, 4, 4, 4, 4, 5, 5, 5, 5, 5, 5, 6}[place];
    }
    return out;
}

int decode_symbol(const std::vector<int>& frequencies, std::uint32_t& x) {
    if (frequencies.empty()) return 0;
    const int slot = static_cast<int>(x % 1024);
    int start = 0;
    int symbol = 0;
    while (start + frequencies[symbol] <= slot) start += frequencies[symbol++];
    x = static_cast<std::uint32_t>(frequencies[symbol]) * (x / 1024) +
        static_cast<std::uint32_t>(slot - start);
    return symbol;
}

void decode_stripes(Plane& plane, std::vector<std::uint32_t> states, int shift,
                    const std::vector<std::vector<int>>& frequencies, Input words, Bits escapes) {
    const int rows = (plane.height + 15) / 16;
    std::vector<Stripe> stripes(16, Stripe(rows, std::vector<Pixel>(plane.width)));
    for (int row = 0; row < rows; ++row) {
        for (int x = 0; x < plane.width; ++x) {
            std::vector<int> symbols;
            std::vector<int> predictions;
            for (int k = 0; k < 16; ++k) {
                const Expectation e = expect(stripes[k], row, x, plane.width, shift);
                predictions.push_back(e.prediction);
                symbols.push_back(decode_symbol(frequencies[e.context], states[k]));
            }
            for (const int k : {0, 1, 2, 3, 8, 9, 10, 11, 4, 5, 6, 7, 12, 13, 14, 15}) {
                if (states[k] < 32768) states[k] = states[k] * 65536 + words.take(2);
            }
            for (int k = 0; k < 16; ++k) {
                Pixel& pixel = stripes[k][row][x];
                pixel = {predictions[k], true, 0};
                if (symbols[k] == 0) continue;
                int z = symbols[k] - 1;
                if (symbols[k] >= 47) {
                    const int b = symbols[k] - 47;
                    z = (45 + (1 << b) + escapes.bits(b)) % 65536;
                }
                const int residual = z % 2 == 0 ? z / 2 : -(z + 1) / 2;
                pixel.index = (predictions[k] + residual + 65536) % 65536;
                pixel.filled = pixel.index;
                pixel.hole = false;
            }
        }
    }
    for (const std::uint32_t state : states) {
        if (state != 32768) throw NoFrame();
    }
    if (words.at != words.bytes.size()) throw NoFrame();
    escapes.end();
    for (int y = 0; y < plane.height; ++y) {
        for (int x = 0; x < plane.width; ++x) {
            plane.indices.push_back(stripes[y / rows][y % rows][x].index);
        }
    }
}

Plane decode_plane(Input& in, int width, int height, bool depth) {
    Plane plane{width, height, {}};
    if (width == 0 || height == 0) return plane;
    const std::uint32_t side_bytes = in.take(4);
    const std::uint32_t escape_bytes = in.take(4);
    const std::uint32_t word_bytes = in.take(4);
    std::vector<std::uint32_t> states;
    for (int k = 0; k < 16; ++k) {
        states.push_back(in.take(4));
        if (states.back() < 32768 || states.back() >= 0x80000000) throw NoFrame();
    }
    Bits side{in.part(side_bytes)};
    if (depth) {
        plane.hole = side.bits(16);
        const int count = side.number();
        int value = -1;
        for (int i = 0; i < count; ++i) {
            value += side.number() + 1;
            if (value > 65535) throw NoFrame();
            plane.values.push_back(value);
        }
    }
    const int shift = side.bits(4);
    std::vector<std::vector<int>> frequencies(10);
    for (auto& context : frequencies) {
        const int count = side.number();
        if (count > 62) throw NoFrame();
        int sum = 0;
        for (int i = 0; i < count; ++i) {
            context.push_back(side.number());
            sum += context.back();
        }
        if (count > 0 && sum != 1024) throw NoFrame();
    }
    side.end();
    const Bits escapes{in.part(escape_bytes)};
    const Bytes words = in.part(word_bytes);
    decode_stripes(plane, states, shift, frequencies, Input{words}, escapes);
    const int largest = depth ? static_cast<int>(plane.values.size()) : 256;
    for (const int index : plane.indices) {
        if (index > largest) throw NoFrame();
    }
    return plane;
}

Bytes decode_pixels(const ImageFormat& format, Input& in) {
    const int w = format.width;
    const int h = format.height;
    Bytes out(bytes_per_frame(format));
    // Puts sample (x, y) of a plane to a byte.
    const auto put = [&](const Plane& plane, auto place) {
        for (int y = 0; y < plane.height; ++y) {
            for (int x = 0; x < plane.width; ++x) {
                const int index = plane.indices[static_cast<std::size_t>(y * plane.width + x)];
                out[static_cast<std::size_t>(place(x, y))] =
                    static_cast<std::uint8_t>(index == 0 ? 0 : index - 1);
            }
        }
    };
    switch (format.layout) {
        case PixelLayout::gray16: {
            const Plane plane = decode_plane(in, w, h, true);
            for (std::size_t i = 0; i < plane.indices.size(); ++i) {
                const int index = plane.indices[i];
                const int value =
                    index == 0 ? plane.hole : plane.values[static_cast<std::size_t>(index) - 1];
                out[2 * i] = static_cast<std::uint8_t>(value % 256);
                out[2 * i + 1] = static_cast<std::uint8_t>(value / 256);
            }
            break;
        }
        case PixelLayout::gray8:
            put(decode_plane(in, w, h, false), [&](int x, int y) { return y * w + x; });
            break;
        case PixelLayout::bayer8:
            for (const int down : {0, 1}) {
                for (const int right : {0, 1}) {
                    put(decode_plane(in, (w + 1 - right) / 2, (h + 1 - down) / 2, false),
                        [&](int x, int y) { return (2 * y + down) * w + 2 * x + right; });
                }
            }
            break;
        case PixelLayout::rgb8:
        case PixelLayout::rgba8: {
            const int channels = format.layout == PixelLayout::rgb8 ? 3 : 4;
            for (const int channel : {1, 0, 2, 3}) {
                if (channel == channels) break;
                put(decode_plane(in, w, h, false),
                    [&](int x, int y) { return (y * w + x) * channels + channel; });
            }
            for (std::size_t i = 0; i < out.size(); i += static_cast<std::size_t>(channels)) {
                out[i] = static_cast<std::uint8_t>(out[i] + out[i + 1] - 128);
                out[i + 2] = static_cast<std::uint8_t>(out[i + 2] + out[i + 1] - 128);
            }
            break;
        }
        case PixelLayout::yuv422:
        case PixelLayout::yuyv422: {
            const bool y_first = format.layout == PixelLayout::yuyv422;
            put(decode_plane(in, w, h, false),
                [&](int x, int y) { return (y * w + x) * 2 + (y_first ? 0 : 1); });
            for (const int v : {0, 1}) {
                put(decode_plane(in, w / 2, h, false),
                    [&](int x, int y) { return y * w * 2 + x * 4 + 2 * v + (y_first ? 1 : 0); });
            }
        }
    }
    return out;
}

}  // namespace

std::optional<Bytes> decode_fast(const ImageFormat& format, const Bytes& frame) {
    try {
        Input in{frame};
        const std::uint32_t kind = in.take(1);
        if (in.take(4) != checksum(frame, 5)) return std::nullopt;
        const std::size_t size = bytes_per_frame(format);
        if (kind == 0) {
            if (frame.size() - 5 != size) return std::nullopt;
            return in.part(size);
        }
        if (kind != 1 || frame.size() - 5 >= size) return std::nullopt;
        Bytes out = decode_pixels(format, in);
        if (in.at != frame.size()) return std::nullopt;
        return out;
    } catch (const NoFrame&) {
        return std::nullopt;
    }
}

std::optional<Bytes> decode_rvl(const Bytes& groups, std::size_t pixels) {
    std::size_t at = 0;
    const auto group = [&] {
        const std::size_t byte = at / 8 * 4 + 3 - at % 8 / 2;
        if (byte >= groups.size()) throw NoFrame();
        return groups[byte] >> (at++ % 2 == 0 ? 4 : 0) & 15;
    };
    const auto number = [&] {
        std::uint64_t value = 0;
        for (int place = 0;; place += 3) {
            const int g = group();
            value += std::uint64_t(g & 7) << place;
            if (g < 8) return value;
            if (place > 30) throw NoFrame();
        }
    };
    try {
        Bytes out;
        std::int64_t last = 0;
        while (out.size() < 2 * pixels) {
            const std::size_t zeros = number();
            if (out.size() + 2 * zeros > 2 * pixels) return std::nullopt;
            out.resize(out.size() + 2 * zeros, 0);
            const std::size_t others = number();
            if (out.size() + 2 * others > 2 * pixels) return std::nullopt;
            for (std::size_t i = 0; i < others; ++i) {
                const auto code = static_cast<std::int64_t>(number());
                last += code % 2 == 0 ? code / 2 : -(code + 1) / 2;
                if (last < 1 || last > 65535) return std::nullopt;
                out.push_back(static_cast<std::uint8_t>(last % 256));
                out.push_back(static_cast<std::uint8_t>(last / 256));
            }
        }
        return out;
    } catch (const NoFrame&) {
        return std::nullopt;
    }
}

}  // namespace kino::reference
