#include <cmath>
#include <cstddef>
#include <cstdint>

#include "skeleton/synthetic/raycast_kernel.h"

// Eight-lane values never cross a real call: everything that takes one is forced inline.
#pragma GCC diagnostic ignored "-Wpsabi"

namespace kino::raycast {
namespace {
#include "skeleton/synthetic/raycast_kernel.inl"
}  // namespace

const Kernels& portable_kernels() {
    return kKernels;
}

const Kernels& kernels() {
#if defined(__x86_64__)
    static const bool wide = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
    if (const Kernels* twin = wide ? avx2_kernels() : nullptr) return *twin;
#endif
    return kKernels;
}

}  // namespace kino::raycast
