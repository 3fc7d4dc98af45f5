#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace kino::fast {

/// Numbers from the lowest bit of the first byte on.
class BitWriter {
  public:
    explicit BitWriter(std::vector<std::uint8_t>& out) : out_(out) {}

    /// The `bits` (0 .. 32) lowest of `value`, which has no others.
    void put(std::uint32_t value, int bits) {
        pending_ |= std::uint64_t{value} << pending_bits_;
        pending_bits_ += bits;
        while (pending_bits_ >= 8) {
            out_.push_back(static_cast<std::uint8_t>(pending_));
            pending_ >>= 8;
            pending_bits_ -= 8;
        }
    }

    /// Exp-Golomb of order 0: as many zeros as value + 1 has bits below its highest one, a one,
    /// then those bits.
    void put_number(std::uint32_t value) {
        const int bits = std::bit_width(value + 1) - 1;
        put(std::uint32_t{1} << bits, bits + 1);
        put((value + 1) & ((std::uint32_t{1} << bits) - 1), bits);
    }

    /// Fills the last byte with zeros.
    void finish() {
        if (pending_bits_ > 0) put(0, 8 - pending_bits_);
    }

  private:
    std::vector<std::uint8_t>& out_;
    std::uint64_t pending_ = 0;
    int pending_bits_ = 0;
};

/// Beyond the end it reads zeros and remembers that it did.
class BitReader {
  public:
    explicit BitReader(std::span<const std::uint8_t> data) : data_(data) {}

    std::uint32_t get(int bits) {
        std::uint32_t value = 0;
        for (int i = 0; i < bits; ++i, ++at_) {
            if (at_ / 8 >= data_.size()) {
                overrun_ = true;
                return 0;
            }
            value |= std::uint32_t{data_[at_ / 8]} >> at_ % 8 << 31 >> (31 - i);
        }
        return value;
    }

    /// At most 2^17; larger ones count as an overrun.
    std::uint32_t get_number() {
        int bits = 0;
        while (get(1) == 0) {
            if (overrun_ || ++bits > 16) {
                overrun_ = true;
                return 0;
            }
        }
        return (std::uint32_t{1} << bits | get(bits)) - 1;
    }

    /// All was read, but for less than a byte of zeros.
    [[nodiscard]] bool at_end() const {
        if (overrun_ || (at_ + 7) / 8 != data_.size()) return false;
        return at_ % 8 == 0 || data_[at_ / 8] >> at_ % 8 == 0;
    }
    [[nodiscard]] bool overrun() const { return overrun_; }

  private:
    std::span<const std::uint8_t> data_;
    std::size_t at_ = 0;
    bool overrun_ = false;
};

}  // namespace kino::fast
