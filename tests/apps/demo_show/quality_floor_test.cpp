#include <gtest/gtest.h>

#include "apps/viewer/frame_budget.h"

namespace kino {
namespace {

TEST(QualityFloor, HoweverLateFramesAreNothingWorseIsTaken) {
    for (const double worst : {1.0, 0.08, 0.01, 0.0}) {
        FrameBudget budget(
            {.mode = GovernorMode::automatic, .target_ms = 10, .worst_error = worst});
        Scene scene;
        scene.meshes.emplace_back();
        const View view{.width = 1280, .height = 720};
        double most = 0;
        for (int i = 0; i < 200; ++i) {
            FrameOptions options;
            most = std::max(most, budget.begin_frame(scene, view, options).estimated_error);
            FrameResult result;
            result.ms = 500;
            budget.frame_took(result, result.ms);
        }
        EXPECT_LE(most, worst);
        // Where it may, it goes beyond the strict ones of these.
        if (worst > 0.05) {
            EXPECT_GT(most, 0.02);
        }
    }
}

}  // namespace
}  // namespace kino
