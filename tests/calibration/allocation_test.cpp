#include <gtest/gtest.h>

#include "calibration/color_in_depth.h"
#include "calibration/depth_points.h"
#include "calibration/rig.h"
#include "tests/calibration/rig_samples.h"
#include "tests/support/counted_allocations.h"

namespace kino {
namespace {

TEST(Rig, NothingIsAllocatedAfterTheFirstFrame) {
    RigSamples samples(1);
    for (const int color_scale : {0, 1, 2, 3}) {
        RigParameters parameters = samples.rig(160, 120);
        if (color_scale == 0) parameters.color.reset();
        if (color_scale >= 2) parameters.color = samples.camera(320, 240);
        const Image<Rgba8> color(160 * color_scale, 120 * color_scale);
        RigOptions options;
        if (color_scale == 3) {
            options = {.coverage = Coverage::splat, .fill_holes_px = 100, .ray_table_step = 8};
        }
        Rig rig = Rig::create(parameters, options).value();
        RegisteredDepth out;
        Image<glm::vec3> points;
        Image<Rgba8> in_depth;
        DepthFrame frames[] = {samples.room(160, 120), samples.room(160, 120),
                               samples.room(160, 120)};
        frames[2].unit = DepthUnit::kinect_disparity11;
        const long before_first = test::allocations;
        long after_first = 0;
        for (int i = 0; i < 6; ++i) {
            const bool registered = rig.register_depth(frames[i % 3], out).has_value();
            unproject_depth(out.depth_m, rig.depth_rays(), points);
            register_color(out.uv, color, ColorSampling::bilinear, in_depth);
            if (i == 0) after_first = test::allocations;
            if (!registered) FAIL();
        }
        EXPECT_GT(after_first, before_first);  // the counter counts
        EXPECT_EQ(test::allocations, after_first);
    }
}

}  // namespace
}  // namespace kino
