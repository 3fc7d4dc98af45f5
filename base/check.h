#pragma once

#include <sstream>
#include <string>

namespace kino::detail {

[[noreturn]] void check_failed(const char* file, int line, const char* expression,
                               const std::string& values);

template <class A, class B>
std::string describe_pair(const A& a, const B& b) {
    std::ostringstream text;
    text << a << " and " << b;
    return text.str();
}

}  // namespace kino::detail

/// For programmer errors only: prints the place and ends the process. What the world can break
/// goes through Result instead.
#define KINO_CHECK(condition)                                                 \
    do {                                                                      \
        if (!(condition)) [[unlikely]]                                        \
            ::kino::detail::check_failed(__FILE__, __LINE__, #condition, {}); \
    } while (false)

#define KINO_CHECK_OP(a, op, b)                                                          \
    do {                                                                                 \
        const auto& kino_a = (a);                                                        \
        const auto& kino_b = (b);                                                        \
        if (!(kino_a op kino_b)) [[unlikely]]                                            \
            ::kino::detail::check_failed(__FILE__, __LINE__, #a " " #op " " #b,          \
                                         ::kino::detail::describe_pair(kino_a, kino_b)); \
    } while (false)
#define KINO_CHECK_EQ(a, b) KINO_CHECK_OP(a, ==, b)
#define KINO_CHECK_LE(a, b) KINO_CHECK_OP(a, <=, b)
#define KINO_CHECK_LT(a, b) KINO_CHECK_OP(a, <, b)
