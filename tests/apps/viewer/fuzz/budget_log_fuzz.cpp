#include "tests/apps/viewer/fuzz/target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    kino::fuzz::budget_log({data, size});
    return 0;
}
