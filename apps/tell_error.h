#pragma once

#include <fmt/format.h>

#include <cstdio>

#include "base/error.h"

namespace kino {

/// How every command says what went wrong: one line on standard error.
inline void tell_error(const Error& error) {
    fmt::print(stderr, "kinoscope: {}\n", error.to_string());
}

}  // namespace kino
