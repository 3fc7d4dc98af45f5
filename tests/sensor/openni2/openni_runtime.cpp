#include "openni_runtime.h"

#include <dlfcn.h>

#include <cstdlib>
#include <filesystem>

#include "base/check.h"
#include "sensor/openni2/openni2.h"
#include "sensor/openni2/openni_library.h"
#include "tests/support/temp_dir.h"

namespace kino::test {
namespace {

namespace fs = std::filesystem;

OpenniRuntime make_runtime(const TempDir& folder) {
    OpenniRuntime runtime;
    setenv(kOpenniLibraryVariable, (folder / "no-such-library.so").c_str(), 1);
    runtime.list_without_library = openni2_driver().list();
    const auto device = openni2_driver().open("");
    KINO_CHECK(!device);
    runtime.error_without_library = device.error().to_string();

    const fs::path library = folder / "libOpenNI2.so.0";
    const fs::path drivers = folder / "OpenNI2/Drivers";
    fs::create_directories(drivers);
    fs::copy_file(KINO_OPENNI2_LIBRARY, library);
    fs::copy_file(fs::path(KINO_OPENNI2_LIBRARY).parent_path() / "OpenNI2/Drivers/libOniFile.so.0",
                  drivers / "libOniFile.so.0");
    const fs::path driver = drivers / "libKinoTest.so.0";
    fs::copy_file(KINO_OPENNI2_TEST_DRIVER, driver);
    setenv(kOpenniLibraryVariable, library.c_str(), 1);
    const auto loaded = OpenniLibrary::get();
    KINO_CHECK(loaded.has_value());
    // The handle of what the library has loaded already.
    void* const handle = dlopen(driver.c_str(), RTLD_NOW | RTLD_NOLOAD);
    KINO_CHECK(handle != nullptr);
    const auto get = reinterpret_cast<KinoTestDriverGet>(dlsym(handle, "kino_test_driver"));
    KINO_CHECK(get != nullptr);
    runtime.driver = get();
    return runtime;
}

}  // namespace

OpenniRuntime& OpenniRuntime::get() {
    static const TempDir folder;
    static OpenniRuntime runtime = make_runtime(folder);
    return runtime;
}

}  // namespace kino::test
