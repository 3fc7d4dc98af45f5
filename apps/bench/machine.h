#pragma once

#include <string>

namespace kino::bench {

/// Processor model, cores, memory, kernel, compiler and build type, in one line.
[[nodiscard]] std::string describe_machine();

}  // namespace kino::bench
