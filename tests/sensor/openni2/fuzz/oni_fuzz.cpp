#include "fuzz/oni_targets.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    (void)kino::fuzz::oni({data, size});
    kino::fuzz::depth_codec({data, size});
    return 0;
}
