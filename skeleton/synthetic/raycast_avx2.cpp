#if defined(__AVX2__)
#include <immintrin.h>
#endif

#include <cstddef>
#include <cstdint>

#include "skeleton/synthetic/raycast_kernel.h"

namespace kino::raycast {
#if defined(__AVX2__)
namespace {
#include "skeleton/synthetic/raycast_kernel.inl"
}  // namespace
const Kernels* avx2_kernels() {
    return &kKernels;
}
#else
const Kernels* avx2_kernels() {
    return nullptr;
}
#endif
}  // namespace kino::raycast
