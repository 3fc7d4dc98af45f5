#pragma once

#include <initializer_list>
#include <string>
#include <string_view>

namespace kino::bench {

/// Version of the code behind a reference that the processor makes, for its ReferenceKey: changes
/// whenever one of these files does, or one of base/ or tests/reference/, which always count.
/// `files` from the tree's root, as of the build; KINO_CHECKs that the build knows them
/// (REFERENCE_SOURCES in CMakeLists.txt).
[[nodiscard]] std::string source_version(std::initializer_list<std::string_view> files);

}  // namespace kino::bench
