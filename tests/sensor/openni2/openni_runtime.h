#pragma once

#include "base/error.h"
#include "driver/test_driver.h"
#include "sensor/live/device.h"

namespace kino::test {

/// Debian's own OpenNI2 in a folder of the tests, beside its file player and the test driver: the
/// library finds its drivers by where it lies. Made once a process; before that the library was
/// looked for where there is none.
struct OpenniRuntime {
    KinoTestDriver driver{};
    /// What the sources said while there was no library.
    std::vector<DeviceEntry> list_without_library;
    std::string error_without_library;

    static OpenniRuntime& get();
};

}  // namespace kino::test
