#include "viz_fixture.h"

#include <cstdlib>

namespace kino::test {

gpu::Device& VizTest::device() {
    // Leaked on purpose: destructors of statics run after the loader's.
    static gpu::Device* made = [] {
        auto result = gpu::Device::create({.validation = true});
        if (!result) {
            ADD_FAILURE() << result.error().to_string();
            std::abort();
        }
        return result->release();
    }();
    return *made;
}

}  // namespace kino::test
