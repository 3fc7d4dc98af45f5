#include "tests/skeleton/actors/fuzz/joint_recording_targets.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    // Longer ones repeat themselves, slowly.
    if (size < 20000) kino::fuzz::joint_recording({data, size});
    return 0;
}
