#include "sensor/filters/linear_depth.h"

#include <gtest/gtest.h>

#include "tests/sensor/filters/depth_samples.h"

namespace kino {
namespace {

TEST(LinearDepth, IsTheDepthToHalfAUnitOrNothing) {
    DepthFrame frame{.unit = DepthUnit::kinect_disparity11};
    for (const auto& in : {test::noisy_room(131, 77, 1), test::hostile_room(90, 50, 2)}) {
        linear_depth(in, frame);
        EXPECT_EQ(frame.unit, DepthUnit::linear);
        ASSERT_EQ(frame.raw.size(), in.size());
        for (std::size_t i = 0; i < in.size(); ++i) {
            const float z = in.pixels()[i];
            const double back = frame.raw.pixels()[i] * frame.metres_per_unit;
            if (is_reading(z) && z < 13.1f) {
                ASSERT_NEAR(back, z, kLinearDepthUnitM / 2 + 1e-6) << z;
            } else {
                ASSERT_EQ(back, 0) << z;
            }
        }
    }
}

TEST(LinearDepth, EndsBeforeTheValueThatMeansNothing) {
    DepthFrame frame;
    linear_depth(Image<float>(3, 1, 65534 * 0.0002f), frame);
    EXPECT_EQ(frame.raw.at(0, 0), 65534);
    linear_depth(Image<float>(3, 1, 65535 * 0.0002f), frame);
    EXPECT_EQ(frame.raw.at(0, 0), 0);
}

}  // namespace
}  // namespace kino
