#pragma once

#include <atomic>
#include <cstdlib>
#include <new>

/// Included in one file of a test program, this replaces its operator new: every allocation is
/// counted.
namespace kino::test {
inline std::atomic<long> allocations{0};
}

// Not inlined, or the compiler sees malloc and delete meet and warns.
[[gnu::noinline]] void* operator new(std::size_t size) {
    ++kino::test::allocations;
    if (void* p = std::malloc(size > 0 ? size : 1)) return p;
    throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* p) noexcept {
    std::free(p);
}
[[gnu::noinline]] void operator delete(void* p, std::size_t) noexcept {
    std::free(p);
}
