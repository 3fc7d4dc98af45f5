#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "base/image.h"
#include "viz/quality/image_metrics.h"

namespace kino::test {

/// Where stored pictures are and where the pictures of a failure go.
struct GoldenPlace {
    std::filesystem::path stored;    ///< default: tests/data/golden of the source tree
    std::filesystem::path failures;  ///< default: out/golden of the build folder
    /// Write instead of compare; default: KINO_UPDATE_GOLDENS=1 in the environment.
    bool update = false;
};
[[nodiscard]] GoldenPlace default_golden_place();

/// EXPECT_TRUE(matches_golden("cloud-sensor-view", picture)): compares with NAME.png. On failure
/// NAME-actual.png and NAME-difference.png say what is different and where. A golden that is not
/// there is a failure, too.
[[nodiscard]] testing::AssertionResult matches_golden(
    const std::string& name, const Image<Rgba8>& actual, const GoldenGate& gate = {},
    const GoldenPlace& place = default_golden_place());

}  // namespace kino::test
