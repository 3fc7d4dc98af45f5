#include "fuzz/kinect1_targets.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    kino::fuzz::kinect1_replies({data, size});
    return 0;
}
