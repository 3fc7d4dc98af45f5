#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "skeleton/people/body_reach.h"
#include "skeleton/people/head_finder.h"
#include "tests/skeleton/people/people_play.h"

namespace kino {
namespace {

using namespace test;

struct HeadScene {
    PeopleScene scene;
    DepthGrid grid;
    HeadFinder finder;

    explicit HeadScene(const RoomOptions& room)
        : scene(room), grid(scene.rays(), std::max(1, room.width / 160)) {}

    /// Distance of the nearest sure head from the true one, metres; large without one.
    double miss(const Actor& actor, std::uint64_t index, bool rolled = false) {
        scene.draw(std::vector{actor}, index);
        grid.sample(scene.depth_m());
        Image<std::uint8_t> mask(grid.width(), grid.height());
        for (std::size_t i = 0; i < mask.size(); ++i) {
            const float z = grid.z_m().data()[i];
            // Before the walls, above the floor.
            const glm::vec3 p = grid.point(i);
            const double height = 1.05 + static_cast<double>(glm::dot(p, scene.up()));
            mask.data()[i] = z > 0 && height > 0.1;
        }
        finder.find(grid, mask, scene.up());
        const glm::dvec3 joint = actor.world_from_body * pose_body(actor.pose)[Joint::head];
        double least = 1e9;
        for (const Head& head : finder.heads()) {
            if (head.score < kSureHead) continue;
            const double height = 1.05 + static_cast<double>(glm::dot(head.place_m, scene.up()));
            // A rolled camera's x is not the world's.
            const double across = rolled ? 0 : static_cast<double>(head.place_m.x) - joint.x;
            least = std::min(least, std::hypot(height - joint.y, across));
        }
        return least;
    }
};

TEST(HeadFinder, FindsHeadsFromTheFrontTheBackAndAslantNearAndFar) {
    RoomOptions room;
    room.furniture = false;
    room.back_wall_m = 6;
    HeadScene heads(room);
    std::uint64_t index = 0;
    for (const double z : {1.8, 2.4, 3.2, 4.2}) {
        for (const double yaw : {0.0, 0.7, 3.14}) {
            for (const Motion motion : {Motion::idle, Motion::wave, Motion::raise}) {
                EXPECT_LT(heads.miss(actor_at(0.2, -z, motion, 1.3, yaw), ++index), 0.13)
                    << motion_name(motion) << " " << z << " " << yaw;
            }
        }
    }
}

TEST(HeadFinder, FollowsTheUprightOfATiltedAndRolledSensor) {
    RoomOptions room;
    room.furniture = false;
    room.camera_height_m = 1.05;
    for (const double roll : {-20.0, 25.0}) {
        room.roll_deg = roll;
        HeadScene heads(room);
        EXPECT_LT(heads.miss(actor_at(0, -2.6), 3, true), 0.13) << roll;
    }
}

TEST(BodyReach, KeepsWhatIsWithinReachAndWhatIsCertain) {
    const int width = 40, height = 40;
    Image<std::int32_t> labels(width, height, 1);
    Image<std::uint8_t> certain(width, height, 0);
    std::vector<glm::vec3> upright(labels.size());
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            upright[static_cast<std::size_t>(y * width + x)] = {
                0.1f * static_cast<float>(x - 20), 3.0f - 0.1f * static_cast<float>(y), -2.5f};
        }
    }
    labels.at(39, 0) = 2;  // somebody else's
    certain.at(38, 20) = 1;
    const glm::vec3 head(0, 1.6f, -2.5f);
    BodyReach reach;
    reach.cut({{14 * width + 20, head}}, upright, certain, labels);
    int kept = 0;
    for (std::size_t i = 0; i < labels.size(); ++i) {
        const int x = static_cast<int>(i) % width, y = static_cast<int>(i) / width;
        const bool mine = within_reach(head, upright[i]) || certain.data()[i];
        if (x == 39 && y == 0) {
            EXPECT_EQ(labels.data()[i], 2);
        } else {
            ASSERT_EQ(labels.data()[i], mine ? 1 : 0) << x << " " << y;
        }
        kept += mine;
    }
    EXPECT_GT(kept, 200);
    EXPECT_LT(kept, 900);
}

TEST(BodyReach, DoesNotJumpToWhatIsWithinReachButNotJoined) {
    Image<std::int32_t> labels(30, 3, 1);
    std::vector<glm::vec3> upright(labels.size(), glm::vec3(0, 1.2f, -2));
    // A wall of cells out of reach between two halves, three wide.
    for (int y = 0; y < 3; ++y) {
        for (int x = 14; x < 17; ++x) {
            upright[static_cast<std::size_t>(y * 30 + x)] = {3, 1.2f, -2};
        }
    }
    BodyReach reach;
    reach.cut({{30 + 5, {0, 1.6f, -2}}}, upright, Image<std::uint8_t>(30, 3, 0), labels);
    EXPECT_EQ(labels.at(10, 1), 1);
    EXPECT_EQ(labels.at(15, 1), 0);
    EXPECT_EQ(labels.at(20, 1), 0);
}

}  // namespace
}  // namespace kino
