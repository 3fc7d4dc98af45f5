#if defined(__SSE2__)
#include <emmintrin.h>
#endif

#include <cmath>
#include <cstddef>
#include <cstdint>

#include "skeleton/synthetic/raycast_kernel.h"

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
