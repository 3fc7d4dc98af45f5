#include <array>

#include "sensor/session/crc32.h"
#include "tests/skeleton/forest/fuzz/forest_targets.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    kino::fuzz::forest({data, size});
    // The checksum would keep the fuzzer out, so it is put right for it.
    if (size < 4) return 0;
    std::vector<std::uint8_t> bytes(data, data + size);
    const std::uint32_t crc = kino::crc32(std::span(bytes).first(size - 4));
    for (std::size_t i = 0; i < 4; ++i)
        bytes[size - 4 + i] = static_cast<std::uint8_t>(crc >> (8 * i));
    kino::fuzz::forest(bytes);
    return 0;
}
