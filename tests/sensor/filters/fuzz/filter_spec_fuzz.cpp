#include "tests/sensor/filters/fuzz/target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    kino::fuzz::filter_spec({data, size});
    return 0;
}
