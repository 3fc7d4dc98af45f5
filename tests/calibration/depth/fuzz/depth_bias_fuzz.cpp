#include "fuzz/targets.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    kino::fuzz::depth_bias({data, size});
    return 0;
}
