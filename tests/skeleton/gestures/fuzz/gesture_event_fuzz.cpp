#include "tests/skeleton/gestures/fuzz/gesture_event_target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    kino::fuzz::gesture_event({data, size});
    return 0;
}
