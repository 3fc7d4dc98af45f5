#include <cmath>
#include <cstring>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>

#include "mesh_world.h"
#include "tests/reference/mesh_reference.h"
#include "viz/surface/mesh_shapes.h"

namespace kino::test {
namespace {

class DrawsTest : public VizTest {
  protected:
    DrawsTest() : world(device()) {}
    MeshWorld world;
};

View forward() {
    return view_from({0, 0, 0}, {0, 0, -1});
}

// Items 1 and 4 of the card's proof.
TEST_F(DrawsTest, EveryWayToSubmitCullAndNumberDrawsMakesTheSamePicture) {
    const Scene scene = mixed_scene(150, 7);
    const MeshPicture reference = world.draw(
        scene, forward(), {.submit = MeshSubmit::fixed_function, .culling = MeshCulling::none});
    int covered = 0;
    for (const std::uint32_t object : reference.object.pixels()) covered += object != 0;
    EXPECT_GT(covered, 1500);
    EXPECT_TRUE(same(reference, world.draw(scene, forward(),
                                           {.submit = MeshSubmit::one_call_each,
                                            .culling = MeshCulling::none})));
    EXPECT_TRUE(same(reference, world.draw(scene, forward(),
                                           {.submit = MeshSubmit::one_call_each,
                                            .carrier = DrawIdCarrier::pushed})));
    for (const MeshCulling culling :
         {MeshCulling::none, MeshCulling::zero_instance, MeshCulling::compact}) {
        for (const DrawIdCarrier carrier :
             {DrawIdCarrier::first_instance, DrawIdCarrier::draw_id, DrawIdCarrier::attribute}) {
            for (const std::uint32_t from : {0u, 1000u}) {  // on the device, on the host
                const MeshPicture picture = world.draw(
                    scene, forward(),
                    {.culling = culling, .carrier = carrier, .cull_on_device_from = from});
                EXPECT_TRUE(same(reference, picture))
                    << static_cast<int>(culling) << static_cast<int>(carrier) << " " << from;
            }
        }
    }
}

TEST_F(DrawsTest, PictureAgreesWithTheDoubleRayCaster) {
    Scene scene = mixed_scene(40, 3);
    const View view = view_from({0.2, 0.3, 1}, {0, 0, -4});
    const MeshPicture picture = world.draw(scene, view);
    const auto reference = cast_meshes(scene, view);
    int union_px = 0;
    int agree = 0;
    for (int y = 0; y < view.height; ++y) {
        for (int x = 0; x < view.width; ++x) {
            const MeshHit& hit = reference.at(x, y);
            const std::uint32_t object = picture.object.at(x, y);
            if (hit.node < 0 && object == 0) continue;
            ++union_px;
            if (hit.node < 0 || object == 0) continue;
            const MeshNode& node = scene.meshes[static_cast<std::size_t>(hit.node)];
            if (object != (node.material << 16 | node.id)) continue;
            ++agree;
            EXPECT_NEAR(picture.view_z_m.at(x, y), hit.view_z_m, 1e-3 * hit.view_z_m)
                << x << " " << y;
            EXPECT_EQ(picture.id.at(x, y), hit.triangle) << x << " " << y;
            EXPECT_GT(glm::dot(unpack_normal(picture.normal.at(x, y)), hit.view_normal), 0.9995)
                << x << " " << y;
            EXPECT_NEAR(picture.depth.at(x, y) * picture.view_z_m.at(x, y), view.projection.near_m,
                        1e-5);
        }
    }
    EXPECT_GT(union_px, 1000);
    // Rasterisers snap corners to 1/256 px, so outlines may differ in single pixels.
    EXPECT_GE(agree, 0.99 * union_px);
}

}  // namespace
}  // namespace kino::test
