#include "tests/skeleton/gestures/fuzz/target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    kino::fuzz::gestures({data, size});
    return 0;
}
