#include "apps/bench/reference_cache.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <system_error>
#include <utility>

#include "base/check.h"

namespace kino::bench {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

constexpr std::string_view kSuffix = ".ref";
constexpr std::string_view kPartSuffix = ".part";
/// What a writer that died left behind.
constexpr auto kDeadPart = 1h;

/// Native byte order: a cache does not travel. A file of another layout has another magic number.
struct Header {
    std::array<char, 8> magic = {'k', 'i', 'n', 'o', 'r', 'e', 'f', '1'};
    ContentHash::Digest key{};
    std::uint64_t element_bytes = 0, width = 0, height = 0;
    ContentHash::Digest checksum{};  ///< of all the above and the elements
};
static_assert(sizeof(Header) == 64 && std::is_trivially_copyable_v<Header>);

ContentHash::Digest checksum_of(const Header& header, std::span<const std::byte> bytes) {
    const auto front = std::as_bytes(std::span(&header, 1)).first(offsetof(Header, checksum));
    return ContentHash().bytes(front).bytes(bytes).digest();
}

/// Of another process, thread or moment: another name.
fs::path part_of(const fs::path& path) {
    static std::atomic<unsigned> count = 0;
    return fs::path(path).concat(fmt::format(".{}-{}{}", getpid(), ++count, kPartSuffix));
}

struct CacheFile {
    fs::path path;
    std::uint64_t bytes = 0;
    fs::file_time_type used{};
};

std::vector<CacheFile> files_in(const fs::path& folder, std::string_view suffix) {
    std::vector<CacheFile> files;
    std::error_code error;
    for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
        if (!it->path().native().ends_with(suffix)) continue;
        // Another program may take it away in between.
        std::error_code gone;
        CacheFile file{it->path(), it->file_size(gone), {}};
        if (!gone) file.used = it->last_write_time(gone);
        if (!gone) files.push_back(std::move(file));
    }
    return files;
}

}  // namespace

ReferenceKey::ReferenceKey(std::string name, std::string_view code) : name_(std::move(name)) {
    KINO_CHECK(!name_.empty() && name_.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789-") ==
                                     std::string::npos);
    hash_.text(name_).text(code);
}

ReferenceKey& ReferenceKey::text(std::string_view text) {
    hash_.text(text);
    return *this;
}

std::string ReferenceKey::file_name() const {
    return fmt::format("{}-{}{}", name_, hash_.hex(), kSuffix);
}

std::string program_version(std::string_view driver) {
    return fmt::format("program {} {}", program_hash().hex(), driver);
}

std::optional<ReferenceCache::Stored> ReferenceCache::read(const ReferenceKey& key,
                                                           std::uint64_t element_bytes) {
    ++counts_.made;
    if (options_.folder.empty()) return std::nullopt;
    const fs::path path = options_.folder / key.file_name();
    std::ifstream file(path, std::ios::binary);
    if (!file) return std::nullopt;
    const auto broken = [&](std::string_view how) {
        ++counts_.broken;
        say(fmt::format("{} {}, so the reference is made anew", path.string(), how));
        return std::nullopt;
    };
    Header header;
    const Header wanted{.key = key.hash().digest(), .element_bytes = element_bytes};
    if (!file.read(reinterpret_cast<char*>(&header), sizeof header)) return broken("is cut short");
    if (header.magic != wanted.magic || header.key != wanted.key ||
        header.element_bytes != element_bytes) {
        return broken("holds something else");
    }
    // Sizes are believed only once the file is as long as they say: the opened one, as another may
    // have its name by now.
    file.seekg(0, std::ios::end);
    const auto size = static_cast<std::uint64_t>(file.tellg());
    file.seekg(sizeof header);
    constexpr std::uint64_t kMost = std::numeric_limits<int>::max();
    if (!file || header.width > kMost || header.height > kMost || size < sizeof header ||
        (header.width > 0 && header.height > (size / element_bytes) / header.width) ||
        size - sizeof header != header.width * header.height * element_bytes) {
        return broken("is cut short or damaged");
    }
    Stored stored{header.width, header.height, std::vector<std::byte>(size - sizeof header)};
    if (!stored.bytes.empty() && !file.read(reinterpret_cast<char*>(stored.bytes.data()),
                                            static_cast<std::streamsize>(stored.bytes.size()))) {
        return broken("is cut short");
    }
    if (header.checksum != checksum_of(header, stored.bytes)) return broken("is damaged");
    --counts_.made;
    ++counts_.found;
    std::error_code error;
    fs::last_write_time(path, fs::file_time_type::clock::now(), error);
    return stored;
}

void ReferenceCache::write(const ReferenceKey& key, const Stored& stored,
                           std::uint64_t element_bytes) {
    if (options_.folder.empty()) return;
    const std::uint64_t bytes = sizeof(Header) + stored.bytes.size();
    if (bytes > options_.most_bytes) return;
    std::error_code error;
    fs::create_directories(options_.folder, error);
    make_room(bytes);
    Header header{.key = key.hash().digest(),
                  .element_bytes = element_bytes,
                  .width = stored.width,
                  .height = stored.height};
    header.checksum = checksum_of(header, stored.bytes);
    const fs::path path = options_.folder / key.file_name();
    const fs::path part = part_of(path);
    bool good = false;
    {
        std::ofstream file(part, std::ios::binary);
        file.write(reinterpret_cast<const char*>(&header), sizeof header);
        file.write(reinterpret_cast<const char*>(stored.bytes.data()),
                   static_cast<std::streamsize>(stored.bytes.size()));
        file.close();
        good = !file.fail();
    }
    // A reader never sees half a file, and of two writers of one key either will do.
    if (good) fs::rename(part, path, error);
    if (!good || error) {
        say(fmt::format("{} cannot be written{}, so the reference is not kept", path.string(),
                        error ? ": " + error.message() : ""));
        fs::remove(part, error);
    }
}

void ReferenceCache::make_room(std::uint64_t for_bytes) {
    std::error_code error;
    for (const CacheFile& part : files_in(options_.folder, kPartSuffix)) {
        if (fs::file_time_type::clock::now() - part.used > kDeadPart) fs::remove(part.path, error);
    }
    std::vector<CacheFile> files = files_in(options_.folder, kSuffix);
    std::uint64_t total = for_bytes;
    for (const CacheFile& file : files) total += file.bytes;
    std::sort(files.begin(), files.end(),
              [](const CacheFile& a, const CacheFile& b) { return a.used < b.used; });
    for (const CacheFile& file : files) {
        if (total <= options_.most_bytes) break;
        fs::remove(file.path, error);
        total -= file.bytes;
    }
}

void ReferenceCache::say(std::string sentence) const {
    if (options_.say) options_.say(std::move(sentence));
}

fs::path default_cache_folder() {
    const auto from = [](const char* variable) {
        const char* value = std::getenv(variable);
        return fs::path(value != nullptr ? value : "");
    };
    fs::path base = from("XDG_CACHE_HOME");
    // The standard says that a relative path there is to be ignored.
    if (!base.is_absolute()) {
        const fs::path home = from("HOME");
        if (home.empty()) return {};
        base = home / ".cache";
    }
    return base / "kinoscope" / "bench";
}

}  // namespace kino::bench
