#include "sensor/codec/rvl.h"

#include <bit>
#include <cstring>

#include "base/check.h"

static_assert(std::endian::native == std::endian::little);

namespace kino {
namespace {

std::uint16_t pixel(const std::uint8_t* pixels, std::size_t i) {
    std::uint16_t value;
    std::memcpy(&value, pixels + 2 * i, 2);
    return value;
}

class GroupWriter {
  public:
    explicit GroupWriter(std::uint8_t* out) : begin_(out), out_(out) {}

    void put(std::uint32_t value) {
        do {
            const std::uint32_t group = (value & 7) | (value > 7 ? 8 : 0);
            value >>= 3;
            word_ = word_ << 4 | group;
            if (++groups_ == 8) flush();
        } while (value != 0);
    }

    std::size_t finish() {
        if (groups_ > 0) {
            word_ <<= 4 * (8 - groups_);
            flush();
        }
        return static_cast<std::size_t>(out_ - begin_);
    }

  private:
    void flush() {
        std::memcpy(out_, &word_, 4);
        out_ += 4;
        word_ = 0;
        groups_ = 0;
    }

    std::uint8_t* begin_;
    std::uint8_t* out_;
    std::uint32_t word_ = 0;
    int groups_ = 0;
};

class GroupReader {
  public:
    explicit GroupReader(std::span<const std::uint8_t> data) : data_(data) {}

    /// Nothing at the end of the data or for a number beyond 32 bits.
    std::optional<std::uint32_t> get() {
        std::uint64_t value = 0;
        for (int shift = 0; shift < 33; shift += 3) {
            if (groups_ == 0 && !refill()) return std::nullopt;
            const std::uint32_t group = word_ >> 28;
            word_ <<= 4;
            --groups_;
            value |= std::uint64_t{group & 7} << shift;
            if ((group & 8) == 0) {
                if (value > UINT32_MAX) return std::nullopt;
                return static_cast<std::uint32_t>(value);
            }
        }
        return std::nullopt;
    }

    /// Everything was read, and what fills the last word is zero.
    [[nodiscard]] bool at_end() const { return at_ == data_.size() && word_ == 0; }

  private:
    bool refill() {
        if (data_.size() - at_ < 4) return false;
        std::memcpy(&word_, data_.data() + at_, 4);
        at_ += 4;
        groups_ = 8;
        return true;
    }

    std::span<const std::uint8_t> data_;
    std::size_t at_ = 0;
    std::uint32_t word_ = 0;
    int groups_ = 0;
};

}  // namespace

std::size_t rvl_encode(std::span<const std::uint8_t> pixels, std::span<std::uint8_t> out) {
    const std::size_t count = pixels.size() / 2;
    KINO_CHECK_LE(rvl_bound_bytes(count), out.size());
    const std::uint8_t* p = pixels.data();
    GroupWriter writer(out.data());
    std::int32_t previous = 0;
    for (std::size_t i = 0; i < count;) {
        const std::size_t zeros_from = i;
        while (i < count && pixel(p, i) == 0) ++i;
        writer.put(static_cast<std::uint32_t>(i - zeros_from));
        std::size_t end = i;
        while (end < count && pixel(p, end) != 0) ++end;
        writer.put(static_cast<std::uint32_t>(end - i));
        for (; i < end; ++i) {
            const std::int32_t value = pixel(p, i);
            const std::int32_t delta = value - previous;
            previous = value;
            writer.put(static_cast<std::uint32_t>(delta << 1 ^ delta >> 31));
        }
    }
    return writer.finish();
}

bool rvl_decode(std::span<const std::uint8_t> data, std::span<std::uint8_t> pixels) {
    const std::size_t count = pixels.size() / 2;
    GroupReader reader(data);
    std::int64_t previous = 0;
    for (std::size_t i = 0; i < count;) {
        const auto zeros = reader.get();
        if (!zeros || *zeros > count - i || (*zeros == 0 && i > 0)) return false;
        std::memset(pixels.data() + 2 * i, 0, 2 * std::size_t{*zeros});
        i += *zeros;
        const auto others = reader.get();
        if (!others || *others > count - i || (*others == 0 && i < count)) return false;
        for (const std::size_t end = i + *others; i < end; ++i) {
            const auto code = reader.get();
            if (!code) return false;
            const std::int64_t delta = std::int64_t{*code >> 1} ^ -std::int64_t{*code & 1};
            previous += delta;
            if (previous < 1 || previous > UINT16_MAX) return false;
            const auto value = static_cast<std::uint16_t>(previous);
            std::memcpy(pixels.data() + 2 * i, &value, 2);
        }
    }
    return reader.at_end();
}

}  // namespace kino
