#include "fuzz/targets.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    kino::fuzz::v4l2_buffers({data, size});
    return 0;
}
