#pragma once

#include <gtest/gtest.h>

#include "viz/frame/renderer.h"

namespace kino::test {

/// One Vulkan device with the validation layer for the whole test program: making one takes
/// longer than most tests. Every test ends with a look at the validation counter.
class VizTest : public ::testing::Test {
  protected:
    static gpu::Device& device();
    void TearDown() override { EXPECT_EQ(device().validation_messages(), 0); }
};

}  // namespace kino::test
