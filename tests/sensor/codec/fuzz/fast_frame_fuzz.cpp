#include "targets.h"

extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
    kino::fuzz::fast_frame({data, size});
    return 0;
}
