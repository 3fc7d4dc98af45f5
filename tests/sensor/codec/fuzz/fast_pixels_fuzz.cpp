#include "targets.h"

extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
    kino::fuzz::fast_pixels({data, size});
    return 0;
}
