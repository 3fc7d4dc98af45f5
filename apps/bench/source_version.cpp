#include "apps/bench/source_version.h"

#include <algorithm>
#include <array>
#include <iterator>

#include "apps/bench/content_hash.h"
#include "base/check.h"

namespace kino::bench {
namespace {

struct SourceHash {
    std::string_view file, hash;
};
constexpr SourceHash kSourceHashes[] = {
#include "source_versions.inc"
};

}  // namespace

std::string source_version(std::initializer_list<std::string_view> files) {
    ContentHash hash;
    for (const SourceHash& source : kSourceHashes) {
        if (source.file.starts_with("base/") || source.file.starts_with("tests/reference/")) {
            hash.text(source.file).text(source.hash);
        }
    }
    for (const std::string_view file : files) {
        const auto* const found =
            std::find_if(std::begin(kSourceHashes), std::end(kSourceHashes),
                         [&](const SourceHash& source) { return source.file == file; });
        KINO_CHECK(found != std::end(kSourceHashes));
        hash.text(found->file).text(found->hash);
    }
    return hash.hex();
}

}  // namespace kino::bench
