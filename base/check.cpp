#include "base/check.h"

#include <cstdio>
#include <cstdlib>

namespace kino::detail {

void check_failed(const char* file, int line, const char* expression, const std::string& values) {
    std::fprintf(stderr, "%s:%d: check failed: %s", file, line, expression);
    if (!values.empty()) std::fprintf(stderr, " with %s", values.c_str());
    std::fputc('\n', stderr);
    std::abort();
}

}  // namespace kino::detail
