#include <gmock/gmock.h>

#include "apps/avatar/rest_body.h"
#include "people.h"
#include "viz/surface/mesh_shapes.h"

namespace kino::test {
namespace {

TEST(AvatarRigs, BundledOnesStandOnTheFloorAndFaceForward) {
    for (const char* name : {"mannequin", "robot"}) {
        const auto rig = open_avatar(name);
        ASSERT_TRUE(rig) << rig.error().to_string();
        EXPECT_EQ((*rig)->name, name);
        EXPECT_NE(list_of_avatars().find(name), std::string::npos);
        const RestBody rest = make_rest_body(**rig);
        const auto at = [&](Joint j) { return rest.joint_m[index_of(j)]; };
        EXPECT_GT(at(Joint::shoulder_left).x, at(Joint::shoulder_right).x + 0.1) << name;
        EXPECT_GT(at(Joint::head).y, at(Joint::hip_center).y + 0.3) << name;
        EXPECT_GT(at(Joint::foot_left).z, at(Joint::ankle_left).z) << name;
        EXPECT_NEAR(at(Joint::hip_center).x, 0, 1e-3) << name;
        double low = 1;
        double high = 0;
        for (const AvatarPart& part : (*rig)->parts) {
            EXPECT_EQ(broken_invariant(*part.mesh), "") << name;
            EXPECT_LE(part.material, (*rig)->materials.size());
            for (const auto& p : part.mesh->positions) {
                low = std::min<double>(low, p.y);
                high = std::max<double>(high, p.y);
            }
            for (const auto& joints : part.mesh->joints) {
                for (const auto j : joints) ASSERT_LT(j, (*rig)->joints.size());
            }
        }
        EXPECT_NEAR(low, 0, 0.01) << name;
        EXPECT_NEAR(high, 1.75, 0.1) << name;
    }
}

}  // namespace
}  // namespace kino::test
