#include "tests/skeleton/motion/bvh_reader.h"

#include <gtest/gtest.h>

#include <stdexcept>

namespace kino::test {
namespace {

// Worked out by hand: the witness of the other tests must not be wrong itself.
const char* const kElbow = R"(HIERARCHY
ROOT a
{
  OFFSET 9 9 9
  CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
  JOINT b
  {
    OFFSET 2 0 0
    CHANNELS 3 Xrotation Yrotation Zrotation
    End Site
    {
      OFFSET 0 0 1
    }
  }
}
MOTION
Frames: 2
Frame Time: 0.5
1 2 3  90 0 0  0 0 0
1 2 3  90 0 90  90 0 0
)";

TEST(BvhReader, DoesForwardKinematics) {
    const BvhFile file = read_bvh(kElbow);
    const auto one = file.positions(0), two = file.positions(1);
    const auto expect = [](const glm::dvec3& p, double x, double y, double z) {
        EXPECT_NEAR(p.x, x, 1e-12);
        EXPECT_NEAR(p.y, y, 1e-12);
        EXPECT_NEAR(p.z, z, 1e-12);
    };
    expect(one.at("a"), 1, 2, 3);
    expect(one.at("b"), 1, 4, 3);
    expect(one.at("b end"), 1, 4, 4);
    // Ry(90) takes x to -z and y stays; Rz(90) then leaves z.
    expect(two.at("b"), 1, 2, 1);
    // Rx(90) takes z to -y; Ry leaves it; Rz(90) takes -y to x.
    expect(two.at("b end"), 2, 2, 1);
}

TEST(BvhReader, RefusesBrokenFiles) {
    EXPECT_THROW((void)read_bvh("HIERARCHY ROOT a {"), std::runtime_error);
    EXPECT_THROW((void)read_bvh(std::string(kElbow) + " 7"), std::runtime_error);
}

}  // namespace
}  // namespace kino::test
