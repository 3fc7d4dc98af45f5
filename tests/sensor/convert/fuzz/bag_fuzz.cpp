#include "fuzz/convert_targets.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    (void)kino::fuzz::bag({data, size});
    return 0;
}
