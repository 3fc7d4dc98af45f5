#include "tests/viz/multires/fuzz/light_table_target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    kino::fuzz::light_table({data, size});
    return 0;
}
