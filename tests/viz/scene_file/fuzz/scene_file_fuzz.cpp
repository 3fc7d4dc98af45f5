#include "tests/viz/scene_file/fuzz/target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    kino::fuzz::scene_file({data, size});
    return 0;
}
