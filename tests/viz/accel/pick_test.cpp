#include "viz/accel/pick.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>

#include "tests/viz/accel/support/ray_meshes.h"
#include "viz/accel/ambient_occlusion.h"

namespace kino {
namespace {

/// Two balls a long way from the origin of the world.
TriangleSoup two_balls() {
    TriangleSoup soup;
    soup.center = {5000, -300, 70};
    std::uint32_t face = 0;
    for (const Triangle& t : test::sphere_mesh({0, 0, 0}, 1, 32, 64)) soup.add(t, {4, face++});
    face = 0;
    for (const Triangle& t : test::sphere_mesh({0, 0, -5}, 1, 32, 64)) soup.add(t, {9, face++});
    return soup;
}

TEST(Pick, the_pixel_that_shows_a_ball_picks_it_and_its_place) {
    const TriangleSoup soup = two_balls();
    const Bvh tree = build_bvh(soup.triangles);
    View view{.width = 640, .height = 480, .projection = perspective(1, 640, 480)};
    view.world_from_view = look_at(soup.center + glm::dvec3(0, 0, 6), soup.center);
    for (const glm::dvec3& target : {glm::dvec3(0, 0, 1), glm::dvec3(0.3, -0.4, 0.8660254)}) {
        const auto pixel = project_to_pixel(view, soup.center + target);
        ASSERT_TRUE(pixel.has_value());
        const auto found = pick(soup, tree, ray_through_pixel(view, *pixel));
        ASSERT_TRUE(found.has_value());
        EXPECT_EQ(found->source.node, 4u);
        EXPECT_LT(glm::distance(found->place, soup.center + target), 0.01);
        EXPECT_GT(glm::dot(found->normal, target), 0.99);
        EXPECT_NEAR(found->distance_m,
                    glm::distance(found->place, view.world_from_view.translation), 1e-9);
    }
    const WorldRay behind{soup.center + glm::dvec3(0, 0, -2), {0, 0, -7}};
    const auto other = pick(soup, tree, behind);
    ASSERT_TRUE(other.has_value());
    EXPECT_EQ(other->source.node, 9u);
    EXPECT_NEAR(other->distance_m, 2, 0.01);
    EXPECT_FALSE(pick(soup, tree, behind, 1.5).has_value());
    EXPECT_FALSE(pick(soup, tree, {soup.center, {0, 0, 0}}).has_value());
    EXPECT_FALSE(pick({}, Bvh{}, behind).has_value());
}

TEST(AmbientOcclusion, converges_to_the_loop_in_double_and_to_the_closed_form) {
    // At the foot of an endless wall half of the weighted hemisphere is open; under a large roof
    // at height h within reach r none of the cone of half angle acos(h / r) is.
    const std::vector<Triangle> wall = {{{0, -9e3f, -9e3f}, {0, 9e3f, -9e3f}, {0, 0, 9e3f}}};
    const SurfacePlace foot{.place = {0.001f, 0, 0}, .normal = {0, 1, 0}};
    EXPECT_NEAR(ambient_openness(build_bvh(wall), foot, 1e3f, 4096), 0.5, 0.01);
    const std::vector<Triangle> roof = {{{-9e3f, 1, -9e3f}, {9e3f, 1, -9e3f}, {0, 1, 9e3f}}};
    EXPECT_NEAR(ambient_openness(build_bvh(roof), {}, 2, 4096), 0.25, 0.01);
    EXPECT_EQ(ambient_openness(build_bvh(roof), {}, 0.9f, 64), 1.0);
    EXPECT_EQ(ambient_openness(Bvh{}, {}, 1, 16), 1.0);

    const auto room = test::room_mesh(3, 6, 41);
    const Bvh bvh = build_bvh(room);
    const auto wide = test::in_double(room);
    for (const glm::vec3& place : {glm::vec3(-2.8f, 0.001f, 1), glm::vec3(0.5f, 0.001f, 0.5f)}) {
        const double expected = reference::open_hemisphere(wide, place, {0, 1, 0}, 1.5, 40, 60);
        EXPECT_NEAR(ambient_openness(bvh, {.place = place}, 1.5f, 2400), expected, 0.02);
    }
}

}  // namespace
}  // namespace kino
