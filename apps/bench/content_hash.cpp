#include "apps/bench/content_hash.h"

#include <fmt/format.h>

#include <fstream>
#include <vector>

namespace kino::bench {

ContentHash& ContentHash::bytes(std::span<const std::byte> bytes) {
    // x 2^88 + 0x13b, on 128 bits.
    __extension__ using Wide = unsigned __int128;
    constexpr Wide kPrime = (Wide{1} << 88) + 0x13b;
    Wide state = (Wide{state_[1]} << 64) | state_[0];
    for (const std::byte byte : bytes) {
        state ^= static_cast<unsigned char>(byte);
        state *= kPrime;
    }
    state_ = {static_cast<std::uint64_t>(state), static_cast<std::uint64_t>(state >> 64)};
    return *this;
}

ContentHash& ContentHash::text(std::string_view text) {
    value(static_cast<std::uint64_t>(text.size()));
    return bytes(std::as_bytes(std::span(text.data(), text.size())));
}

std::string ContentHash::hex() const {
    return fmt::format("{:016x}{:016x}", state_[1], state_[0]);
}

const ContentHash& program_hash() {
    static const ContentHash kHash = [] {
        ContentHash hash;
        std::ifstream file("/proc/self/exe", std::ios::binary);
        std::vector<char> block(1 << 16);
        while (file) {
            file.read(block.data(), static_cast<std::streamsize>(block.size()));
            hash.bytes(std::as_bytes(std::span(block.data(), std::size_t(file.gcount()))));
        }
        return hash;
    }();
    return kHash;
}

}  // namespace kino::bench
