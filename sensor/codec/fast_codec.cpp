#include <algorithm>
#include <bit>
#include <cstring>

#include "base/check.h"
#include "sensor/codec/codecs.h"
#include "sensor/codec/fast_model.h"
#include "sensor/codec/fast_planes.h"

namespace kino {
namespace {

using namespace fast;
using Bytes = std::vector<std::uint8_t>;

constexpr const char* kFastName = "fast";
constexpr std::uint8_t kStored = 0;
constexpr std::uint8_t kCoded = 1;
constexpr std::size_t kFrameHead = 5;                // kind, checksum
constexpr std::size_t kPlaneHead = 12 + 4 * kLanes;  // three sizes, states

const Kernels& choose_kernels(const CodecOptions& options) {
    static const bool avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
    return options.simd && avx2 ? kAvx2Kernels : kPortableKernels;
}

void put_u32(std::uint8_t* to, std::size_t value) {
    const auto number = static_cast<std::uint32_t>(value);
    std::memcpy(to, &number, 4);
}

std::uint32_t get_u32(const std::uint8_t* from) {
    std::uint32_t value = 0;
    std::memcpy(&value, from, 4);
    return value;
}

Stripes stripes_of(PlaneSize size) {
    return {size.width, (size.height + kLanes - 1) / kLanes};
}

std::size_t cells(Stripes stripes) {
    return static_cast<std::size_t>(stripes.width) * static_cast<std::size_t>(stripes.rows) *
           kLanes;
}

/// Buffers for the largest plane of a format.
struct Workspace {
    explicit Workspace(const ImageFormat& format) {
        std::size_t pixels = 0;
        std::size_t lanes = 0;
        for (int i = 0; i < plane_count(format.layout); ++i) {
            const PlaneSize size = plane_size(format, i);
            pixels = std::max(pixels, static_cast<std::size_t>(size.width) *
                                          static_cast<std::size_t>(size.height));
            lanes = std::max(lanes, cells(stripes_of(size)));
        }
        plane.resize(pixels);
        indices.resize(lanes);
        const auto row = static_cast<std::size_t>(format.width) * kLanes;
        above.resize(row);
        above_hole.resize(row);
    }

    std::vector<std::uint16_t> plane;    ///< rows
    std::vector<std::uint16_t> indices;  ///< stripes
    std::vector<std::uint16_t> above;
    std::vector<std::uint16_t> above_hole;
};

/// The shift that spreads a plane's usual activity over the contexts, from every eighth row.
int choose_shift(const std::vector<std::uint16_t>& plane, PlaneSize size) {
    std::uint64_t bits = 0;
    std::uint64_t count = 1;
    for (int y = 0; y < size.height; y += 8) {
        const std::uint16_t* row =
            plane.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(size.width);
        for (int x = 1; x < size.width; ++x) {
            if (row[x] == 0 || row[x - 1] == 0) continue;
            bits += static_cast<unsigned>(
                std::bit_width(static_cast<unsigned>(std::abs(row[x] - row[x - 1]))));
            ++count;
        }
    }
    return std::max(static_cast<int>((bits + count / 2) / count) - 1, 0);
}

class FastEncoder final : public ImageEncoder {
  public:
    FastEncoder(const ImageFormat& format, const CodecOptions& options)
        : format_(format), kernels_(choose_kernels(options)), work_(format) {
        tokens_.resize(work_.indices.size());
        escapes_.resize(work_.indices.size());
        words_.resize(2 * work_.indices.size() + kPadding);
        if (format.layout == PixelLayout::gray16) index_of_.resize(UINT16_MAX + 1);
    }

    std::span<const std::uint8_t> private_data() const override { return {}; }

    Result<std::span<const std::uint8_t>> encode(std::span<const std::uint8_t> pixels) override {
        KINO_CHECK_EQ(pixels.size(), bytes_per_frame(format_));
        out_.assign(kFrameHead, 0);
        out_[0] = kCoded;
        for (int i = 0; i < plane_count(format_.layout); ++i) {
            encode_plane(pixels, i);
            if (out_.size() - kFrameHead < pixels.size()) continue;
            out_.resize(kFrameHead);
            out_[0] = kStored;
            out_.insert(out_.end(), pixels.begin(), pixels.end());
            break;
        }
        put_u32(&out_[1], kernels_.crc32c(out_.data() + kFrameHead, out_.size() - kFrameHead));
        return std::span<const std::uint8_t>(out_);
    }

  private:
    void encode_plane(std::span<const std::uint8_t> pixels, int plane) {
        const PlaneSize size = plane_size(format_, plane);
        if (size.width == 0 || size.height == 0) return;
        const Stripes stripes = stripes_of(size);
        const std::size_t count = cells(stripes);
        side_.clear();
        BitWriter side(side_);
        if (format_.layout == PixelLayout::gray16) {
            index_depth(pixels, side);
        } else {
            split(format_, plane, pixels.data(), work_.plane.data());
        }
        const int shift = choose_shift(work_.plane, size);
        side.put(static_cast<std::uint32_t>(shift), 4);
        kernels_.to_stripes(work_.plane.data(), size.height, stripes, work_.indices.data());
        const std::size_t escapes =
            kernels_.make_tokens({stripes, shift, work_.indices.data(), work_.above.data(),
                                  work_.above_hole.data(), tokens_.data(), escapes_.data()});
        const Frequencies frequencies = frequencies_of(std::span(tokens_).first(count));
        write_frequencies(frequencies, side);
        side.finish();
        fill(frequencies, table_);

        std::uint32_t states[kLanes];
        std::uint8_t* const words_end = words_.data() + words_.size();
        const std::uint8_t* const words =
            kernels_.encode({count / kLanes, tokens_.data(), table_.data(), words_end, states});

        const std::size_t head = out_.size();
        out_.resize(head + kPlaneHead);
        for (std::size_t i = 0; i < kLanes; ++i) put_u32(&out_[head + 12 + 4 * i], states[i]);
        out_.insert(out_.end(), side_.begin(), side_.end());
        const std::size_t escapes_from = out_.size();
        BitWriter large(out_);
        for (std::size_t i = 0; i < escapes; ++i) {
            const int bits = std::bit_width(escapes_[i]) - 1;
            large.put(escapes_[i] & ((1u << bits) - 1), bits);
        }
        large.finish();
        put_u32(&out_[head], side_.size());
        put_u32(&out_[head + 4], out_.size() - escapes_from);
        put_u32(&out_[head + 8], static_cast<std::size_t>(words_end - words));
        out_.insert(out_.end(), words, static_cast<const std::uint8_t*>(words_end));
    }

    /// What most likely means no reading: 0, or all ones where a device says so (Kinect v1: 2047).
    [[nodiscard]] std::uint16_t hole_value() const {
        if (index_of_[0] != 0) return 0;
        const auto last = std::find(index_of_.rbegin(), index_of_.rend(), std::uint16_t{1});
        const auto largest = static_cast<std::uint32_t>(index_of_.rend() - last - 1);
        return std::has_single_bit(largest + 1) ? static_cast<std::uint16_t>(largest) : 0;
    }

    /// Depth as indices into the values that the picture has: a sensor's steps become 1.
    void index_depth(std::span<const std::uint8_t> pixels, BitWriter& side) {
        const std::size_t count = pixels.size() / 2;
        std::uint16_t* plane = work_.plane.data();
        std::memcpy(plane, pixels.data(), pixels.size());
        std::fill(index_of_.begin(), index_of_.end(), std::uint16_t{0});
        for (std::size_t i = 0; i < count; ++i) index_of_[plane[i]] = 1;
        values_.clear();
        const std::uint16_t hole = hole_value();
        index_of_[hole] = 0;
        side.put(hole, 16);
        for (std::size_t from = 0; from < index_of_.size(); from += 4) {
            std::uint64_t four = 0;
            std::memcpy(&four, &index_of_[from], 8);
            if (four == 0) continue;
            for (std::size_t v = from; v < from + 4; ++v) {
                if (index_of_[v] == 0) continue;
                values_.push_back(static_cast<std::uint16_t>(v));
                index_of_[v] = static_cast<std::uint16_t>(values_.size());
            }
        }
        write_palette(values_, side);
        for (std::size_t i = 0; i < count; ++i) plane[i] = index_of_[plane[i]];
    }

    ImageFormat format_;
    const Kernels& kernels_;
    Workspace work_;
    std::vector<std::uint16_t> tokens_;
    std::vector<std::uint16_t> escapes_;
    std::vector<std::uint16_t> index_of_;
    std::vector<std::uint16_t> values_;
    EncodeTable table_{};
    Bytes words_;
    Bytes side_;
    Bytes out_;
};

class FastDecoder final : public ImageDecoder {
  public:
    FastDecoder(const ImageFormat& format, const CodecOptions& options)
        : format_(format), kernels_(choose_kernels(options)), work_(format) {}

    Result<void> decode(std::span<const std::uint8_t> data,
                        std::span<std::uint8_t> pixels) override {
        KINO_CHECK_EQ(pixels.size(), bytes_per_frame(format_));
        if (data.size() < kFrameHead || data[0] > kCoded) return fail("not a frame", kFastName);
        std::span<const std::uint8_t> rest = data.subspan(kFrameHead);
        // Longer ones are stored.
        if (rest.size() > pixels.size()) return fail("a frame is too long", kFastName);
        if (kernels_.crc32c(rest.data(), rest.size()) != get_u32(&data[1])) {
            return fail("a frame is damaged: its checksum differs", kFastName);
        }
        if (data[0] == kStored) {
            if (rest.size() != pixels.size()) return fail("a frame has another size", kFastName);
            std::memcpy(pixels.data(), rest.data(), rest.size());
            return {};
        }
        for (int i = 0; i < plane_count(format_.layout); ++i) {
            if (const char* wrong = decode_plane(rest, i, pixels)) return fail(wrong, kFastName);
        }
        if (!rest.empty()) return fail("a frame has bytes left over", kFastName);
        return {};
    }

  private:
    /// Takes the plane off the front of `rest`; what is wrong with it, or null.
    const char* decode_plane(std::span<const std::uint8_t>& rest, int plane,
                             std::span<std::uint8_t> pixels) {
        const PlaneSize size = plane_size(format_, plane);
        if (size.width == 0 || size.height == 0) return nullptr;
        const Stripes stripes = stripes_of(size);
        if (rest.size() < kPlaneHead) return "a plane is cut off";
        const std::size_t side_bytes = get_u32(&rest[0]);
        const std::size_t escape_bytes = get_u32(&rest[4]);
        const std::size_t word_bytes = get_u32(&rest[8]);
        std::uint32_t states[kLanes];
        for (std::size_t i = 0; i < kLanes; ++i) {
            states[i] = get_u32(&rest[12 + 4 * i]);
            if (states[i] < kStateFloor || states[i] >> 31 != 0) return "a state is out of range";
        }
        rest = rest.subspan(kPlaneHead);
        // Each below 2^32, so the sum is exact.
        if (side_bytes + escape_bytes + word_bytes > rest.size()) return "a plane is cut off";

        const bool depth = format_.layout == PixelLayout::gray16;
        BitReader side(rest.first(side_bytes));
        std::uint16_t hole = 0;
        if (depth) {
            hole = static_cast<std::uint16_t>(side.get(16));
            if (!read_palette(side, values_)) return "the values are damaged";
        }
        const auto shift = static_cast<int>(side.get(4));
        if (!read_frequencies(side, frequencies_) || !side.at_end()) {
            return "the frequencies are damaged";
        }
        fill(frequencies_, table_);

        const std::uint8_t* escapes = pad(escapes_, rest.subspan(side_bytes, escape_bytes));
        const std::uint8_t* words =
            pad(words_, rest.subspan(side_bytes + escape_bytes, word_bytes));
        rest = rest.subspan(side_bytes + escape_bytes + word_bytes);
        const Decoded decoded = kernels_.decode(
            {stripes, shift, table_.data(), words, words + word_bytes, escapes, 8 * escape_bytes,
             states, work_.above.data(), work_.above_hole.data(), work_.indices.data()});
        const bool states_home =
            std::all_of(states, states + kLanes, [](auto s) { return s == kStateFloor; });
        if (!decoded.whole || decoded.word_bytes != word_bytes || !states_home ||
            (decoded.escape_bits + 7) / 8 != escape_bytes) {
            return "the entropy code does not end where it must";
        }
        const std::size_t largest = depth ? values_.size() : 256;
        if (decoded.largest > largest) return "a value is out of range";
        kernels_.from_stripes(work_.indices.data(), size.height, stripes, work_.plane.data());
        if (depth) {
            values_.insert(values_.begin(), hole);
            std::uint16_t* p = work_.plane.data();
            for (std::size_t i = 0; i < pixels.size() / 2; ++i) p[i] = values_[p[i]];
            std::memcpy(pixels.data(), p, pixels.size());
        } else {
            join(format_, plane, work_.plane.data(), pixels.data());
        }
        return nullptr;
    }

    static const std::uint8_t* pad(Bytes& to, std::span<const std::uint8_t> from) {
        to.assign(from.begin(), from.end());
        to.resize(from.size() + kPadding, 0);
        return to.data();
    }

    ImageFormat format_;
    const Kernels& kernels_;
    Workspace work_;
    std::vector<std::uint16_t> values_;
    Frequencies frequencies_{};
    DecodeTable table_{};
    Bytes escapes_;
    Bytes words_;
};

}  // namespace

std::unique_ptr<ImageEncoder> make_fast_encoder(const ImageFormat& format,
                                                const CodecOptions& options) {
    return std::make_unique<FastEncoder>(format, options);
}

std::unique_ptr<ImageDecoder> make_fast_decoder(const ImageFormat& format,
                                                const CodecOptions& options) {
    return std::make_unique<FastDecoder>(format, options);
}

}  // namespace kino
