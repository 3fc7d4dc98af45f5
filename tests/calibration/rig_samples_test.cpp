#include "tests/calibration/rig_samples.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <numbers>

namespace kino {

double RigSamples::normal(double sigma) {
    // Box & Muller 1958.
    const double radius = std::sqrt(-2 * std::log(1 - uniform(0, 1)));
    return sigma * radius * std::cos(uniform(0, 2 * std::numbers::pi));
}

glm::dvec3 RigSamples::direction() {
    return glm::normalize(glm::dvec3(normal(1), normal(1), normal(1)));
}

CameraModel RigSamples::plain_camera(int width, int height) {
    CameraModel c{.width = width, .height = height};
    c.fx = width * uniform(0.7, 1.1);
    c.fy = c.fx * uniform(0.98, 1.02);
    c.cx = (width - 1) / 2.0 + width * normal(0.01);
    c.cy = (height - 1) / 2.0 + height * normal(0.01);
    return c;
}

CameraModel RigSamples::camera(int width, int height) {
    CameraModel c = plain_camera(width, height);
    if (uniform(0, 1) < 0.6) {
        c.k1 = uniform(-0.3, 0.3);
        c.k2 = uniform(-0.3, 0.5);
        c.k3 = uniform(-0.1, 0.1);
    } else {
        // Numerator and denominator nearly cancel, as calibrations of eight terms come out.
        c.k4 = uniform(0.1, 0.6);
        c.k5 = uniform(0, 0.3);
        c.k6 = uniform(0, 0.05);
        c.k1 = c.k4 + uniform(-0.2, 0.2);
        c.k2 = c.k5 + uniform(-0.1, 0.1);
        c.k3 = c.k6 + uniform(-0.02, 0.02);
    }
    c.p1 = normal(0.002);
    c.p2 = normal(0.002);
    return c;
}

CameraModel RigSamples::folding_camera(int width, int height) {
    CameraModel c{.width = width,
                  .height = height,
                  .fx = width * 0.7,
                  .fy = width * 0.7,
                  .cx = (width - 1) / 2.0,
                  .cy = (height - 1) / 2.0};
    c.k1 = -0.65;
    return c;
}

RigParameters RigSamples::rig(int width, int height) {
    RigParameters rig;
    rig.depth = camera(width, height);
    rig.color = camera(width, height);
    rig.color_from_depth.rotation = glm::angleAxis(normal(0.03), direction());
    rig.color_from_depth.translation = {normal(0.04), normal(0.01), normal(0.01)};
    return rig;
}

DepthFrame RigSamples::room(int width, int height) {
    DepthFrame frame;
    frame.raw = Image<std::uint16_t>(width, height);
    const double slope_x = uniform(-2, 2) * 1000 / width;
    const double slope_y = uniform(-1, 1) * 1000 / height;
    const auto put = [&](int x, int y, double mm) {
        frame.raw.at(x, y) = static_cast<std::uint16_t>(mm);
    };
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            put(x, y, 3500 + slope_x * (x - width / 2) + slope_y * (y - height / 2) + normal(5));
        }
    }
    for (int box = 0; box < 12; ++box) {
        const int left = static_cast<int>(uniform(-0.1, 0.9) * width);
        const int top = static_cast<int>(uniform(-0.1, 0.9) * height);
        const int size = static_cast<int>(uniform(0.05, 0.3) * width);
        const double mm = box % 6 == 5 ? 0 : uniform(600, 3000);
        for (int y = std::max(top, 0); y < std::min(top + size, height); ++y) {
            for (int x = std::max(left, 0); x < std::min(left + size, width); ++x) {
                put(x, y, mm > 0 ? mm + normal(3) : 0);
            }
        }
    }
    return frame;
}

namespace {

TEST(RigSamples, ASeedGivesTheSameRigTwice) {
    EXPECT_EQ(RigSamples(5).rig(64, 48), RigSamples(5).rig(64, 48));
    EXPECT_FALSE(RigSamples(5).rig(64, 48) == RigSamples(6).rig(64, 48));
}

}  // namespace
}  // namespace kino
