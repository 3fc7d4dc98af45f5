#pragma once

#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

namespace kino::test {

/// Damages a file in one place: a byte, a bit or a few bytes are set, its end goes, a piece goes,
/// or a piece stands somewhere a second time. Half of the changes are within the first `head`
/// bytes: heads and tables are the interesting part. Nothing happens to no bytes.
void damage(std::vector<std::uint8_t>& bytes, std::mt19937& random, std::size_t head);

}  // namespace kino::test
