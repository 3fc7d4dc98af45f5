#pragma once

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "apps/bench/content_hash.h"
#include "base/error.h"
#include "base/image.h"

namespace kino::bench {

/// Everything that a reference depends on: what is added, in its order. Two references that may
/// differ in anything must have different keys; nobody checks that but the one who makes the key.
class ReferenceKey {
  public:
    /// `name` of the reference, e.g. "one-bounce": letters, digits and '-', part of the file's
    /// name. `code`: what tells one version of the code that makes it from another, by
    /// source_version() where the processor makes it, by program_version() where drawing does.
    ReferenceKey(std::string name, std::string_view code);

    ReferenceKey& text(std::string_view text);
    /// Numbers, enumerations, and ranges or glm types of them without padding.
    template <class T>
    ReferenceKey& add(const T& value) {
        if constexpr (std::is_arithmetic_v<T> || std::is_enum_v<T>) {
            hash_.value(value);
        } else if constexpr (requires { std::span(value); }) {
            hash_.values(value);
        } else {
            hash_.values(std::span(&value, 1));
        }
        return *this;
    }
    template <class T>
    ReferenceKey& add(const Image<T>& image) {
        return add(image.width()).add(image.height()).add(image.pixels());
    }

    [[nodiscard]] const std::string& name() const { return name_; }
    [[nodiscard]] const ContentHash& hash() const { return hash_; }
    [[nodiscard]] std::string file_name() const;  ///< "one-bounce-<hash>.ref"

  private:
    std::string name_;
    ContentHash hash_;
};

/// Of references that this program's own drawing code makes: its file's hash and, if given, the
/// driver that runs it.
[[nodiscard]] std::string program_version(std::string_view driver = {});

/// References that take long are made once and kept in files, a file a key. Whatever is wrong with
/// a file or the folder, the reference is made anew: the answer is that of `make` in any case, bit
/// for bit. Programs may share a folder; a cache is one thread's.
class ReferenceCache {
  public:
    struct Options {
        std::filesystem::path folder{};          ///< empty: nothing is kept
        std::uint64_t most_bytes = 1ULL << 30;   ///< of all files; the longest unused go first
        std::function<void(std::string)> say{};  ///< what is wrong, a sentence
    };
    ReferenceCache() = default;
    explicit ReferenceCache(Options options) : options_(std::move(options)) {}

    /// `make()` gives an Image<T> or a Result of one; T without padding. An error is passed on, and
    /// nothing is kept.
    template <class T, class Make>
    Result<Image<T>> image(const ReferenceKey& key, Make&& make) {
        static_assert(std::is_trivially_copyable_v<T> && !std::is_pointer_v<T>);
        if (const auto stored = read(key, sizeof(T))) {
            Image<T> image(static_cast<int>(stored->width), static_cast<int>(stored->height));
            copy(*stored, image.pixels().data());
            return image;
        }
        Result<Image<T>> made = make();
        if (made) {
            write(key,
                  {static_cast<std::uint64_t>(made->width()),
                   static_cast<std::uint64_t>(made->height()), bytes_of(made->pixels())},
                  sizeof(T));
        }
        return made;
    }
    /// The same of a std::vector<T>.
    template <class T, class Make>
    Result<std::vector<T>> values(const ReferenceKey& key, Make&& make) {
        static_assert(std::is_trivially_copyable_v<T> && !std::is_pointer_v<T>);
        if (const auto stored = read(key, sizeof(T))) {
            std::vector<T> values(static_cast<std::size_t>(stored->width));
            copy(*stored, values.data());
            return values;
        }
        Result<std::vector<T>> made = make();
        if (made) write(key, {made->size(), 1, bytes_of(*made)}, sizeof(T));
        return made;
    }

    struct Counts {
        int found = 0, made = 0, broken = 0;  ///< broken ones are among those made
        friend bool operator==(const Counts&, const Counts&) = default;
    };
    [[nodiscard]] const Counts& counts() const { return counts_; }
    [[nodiscard]] const std::filesystem::path& folder() const { return options_.folder; }

  private:
    struct Stored {
        std::uint64_t width = 0, height = 0;  ///< in elements
        std::vector<std::byte> bytes{};
    };
    template <class Range>
    static std::vector<std::byte> bytes_of(const Range& range) {
        const auto bytes = std::as_bytes(std::span(range));
        return {bytes.begin(), bytes.end()};
    }
    template <class T>
    static void copy(const Stored& from, T* to) {
        if (!from.bytes.empty()) std::memcpy(to, from.bytes.data(), from.bytes.size());
    }
    /// Counts what it finds; empty: it is to be made.
    [[nodiscard]] std::optional<Stored> read(const ReferenceKey& key, std::uint64_t element_bytes);
    void write(const ReferenceKey& key, const Stored& stored, std::uint64_t element_bytes);
    void make_room(std::uint64_t for_bytes);
    void say(std::string sentence) const;

    Options options_;
    Counts counts_;
};

/// $XDG_CACHE_HOME/kinoscope/bench, below ~/.cache where that is not set; empty where neither is.
[[nodiscard]] std::filesystem::path default_cache_folder();

}  // namespace kino::bench
