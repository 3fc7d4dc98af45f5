#include "viz/quality/zoom/deflect_rows.h"

#include "viz/quality/zoom/deflect_loops.h"

namespace kino::deflect_rows {
namespace {

int places_row(const Row& row, int count, float* u, float* v) {
    return row.inverse_z != nullptr ? places_of<true>(row, 0, count, u, v)
                                    : places_of<false>(row, 0, count, u, v);
}

void nearest_row(const Source& from, const float* u, const float* v, int count,
                 std::uint32_t* out) {
    nearest_from(from, 0, u, v, count, out);
}

void bilinear_row(const Source& from, const float* u, const float* v, int count,
                  std::uint32_t* out) {
    bilinear_from(from, 0, u, v, count, out);
}

}  // namespace

const Kernels& portable() {
    static constexpr Kernels kKernels{places_row, nearest_row, bilinear_row};
    return kKernels;
}

}  // namespace kino::deflect_rows
