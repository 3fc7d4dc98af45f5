#include "tests/skeleton/forest/fuzz/forest_targets.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    kino::fuzz::pcl_tree({data, size});
    return 0;
}
