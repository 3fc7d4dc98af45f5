#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>

namespace kino::bench {

/// 128 bits of everything that was added, by FNV-1a (Fowler, Noll and Vo; constants as in
/// draft-eastlake-fnv). It tells what was changed by mistake apart, not what was made to collide.
class ContentHash {
  public:
    /// As they are: the caller sees to it that they hold no padding.
    ContentHash& bytes(std::span<const std::byte> bytes);
    /// Length and characters, so that "ab", "c" is not "a", "bc".
    ContentHash& text(std::string_view text);
    /// Bits of a number: 0 and -0 are different.
    template <class T>
    requires(std::is_arithmetic_v<T> || std::is_enum_v<T>) ContentHash& value(T value) {
        return bytes(std::as_bytes(std::span(&value, 1)));
    }
    /// Count and bits of elements without padding: numbers, glm vectors and matrices, pixels.
    template <class Range>
    ContentHash& values(const Range& range) {
        const std::span all(range);
        using T = std::remove_cvref_t<decltype(all[0])>;
        static_assert(std::is_trivially_copyable_v<T> && !std::is_pointer_v<T>);
        value(static_cast<std::uint64_t>(all.size()));
        return bytes(std::as_bytes(all));
    }

    using Digest = std::array<std::uint64_t, 2>;  ///< low half first
    [[nodiscard]] Digest digest() const { return state_; }
    /// 32 digits, most significant first.
    [[nodiscard]] std::string hex() const;
    friend bool operator==(const ContentHash&, const ContentHash&) = default;

  private:
    Digest state_ = {0x62b821756295c58dULL, 0x6c62272e07bb0142ULL};
};

/// Hash of this program's own file, worked out once: for references that its drawing code makes,
/// which are other references in another build. Empty text hashed where the file cannot be read.
[[nodiscard]] const ContentHash& program_hash();

}  // namespace kino::bench
