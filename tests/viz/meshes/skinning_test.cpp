#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "mesh_world.h"
#include "tests/reference/mesh_reference.h"
#include "viz/surface/assets/gltf_loader.h"
#include "viz/surface/mesh_shapes.h"

namespace kino::test {
namespace {

class SkinningTest : public VizTest {
  protected:
    SkinningTest() : world(device()) {}

    /// Share of the union of covered pixels that have the same object in the picture and in the
    /// double-precision one; depths and normals of those must agree.
    double agreement(const Scene& scene, const View& from) {
        const MeshPicture picture = world.draw(scene, from);
        const Image<MeshHit> reference = cast_meshes(scene, from);
        int all = 0;
        int agree = 0;
        for (std::size_t i = 0; i < reference.size(); ++i) {
            const MeshHit& hit = reference.pixels()[i];
            const std::uint32_t object = picture.object.pixels()[i];
            if (hit.node < 0 && object == 0) continue;
            ++all;
            if (hit.node < 0 || object == 0) continue;
            const MeshNode& node = scene.meshes[static_cast<std::size_t>(hit.node)];
            if (object != (node.material << 16 | node.id)) continue;
            if (std::abs(picture.view_z_m.pixels()[i] - hit.view_z_m) > 2e-3 * hit.view_z_m) {
                continue;
            }
            agree += glm::dot(unpack_normal(picture.normal.pixels()[i]), hit.view_normal) > 0.998;
        }
        EXPECT_GT(all, 150);
        return static_cast<double>(agree) / all;
    }

    /// A tube along y that joint 0 holds below and joint 1 above.
    static std::shared_ptr<const MeshAsset> tube() {
        MeshAsset mesh = *make_cylinder(0.3f, 2, 16);
        for (const glm::vec3& p : mesh.positions) {
            const float upper = p.y > 0 ? 1.0f : 0.0f;
            mesh.joints.push_back({0, 1, 0, 0});
            mesh.weights.emplace_back(1 - upper, upper, 0, 0);
        }
        return std::make_shared<const MeshAsset>(mesh);
    }

    static std::shared_ptr<const std::vector<glm::mat4>> pose(const glm::mat4& a,
                                                              const glm::mat4& b) {
        return std::make_shared<const std::vector<glm::mat4>>(std::vector{a, b});
    }

    MeshWorld world;
    View view = view_from({0, 0.5, 4}, {0, 0, 0}, 96, 72);
};

TEST_F(SkinningTest, PosedTubesAgreeWithTheDoubleReference) {
    const glm::mat4 turn = glm::rotate(glm::translate(glm::mat4(1), {0.3f, 0, 0}), 0.7f, {0, 0, 1});
    // Uneven scale and mirroring: normals take the inverse transpose of the blend.
    const glm::mat4 squash = glm::scale(glm::mat4(1), {1.5f, 0.5f, 0.4f});
    const glm::mat4 mirror = glm::scale(glm::mat4(1), {-1, 1, 1});
    for (const auto& p :
         {pose(glm::mat4(1), turn), pose(squash, squash * turn), pose(mirror, mirror)}) {
        Scene scene;
        scene.meshes = {node_of(tube(), 5)};
        scene.meshes[0].pose = p;
        // Mirrored by joints, not by the node: outside stays out, as the weights' owner meant.
        if (p->front() == mirror) {
            const MeshPicture picture = world.draw(scene, view);
            int covered = 0;
            for (const std::uint32_t object : picture.object.pixels()) covered += object == 5;
            EXPECT_GT(covered, 200);
            continue;
        }
        EXPECT_GT(agreement(scene, view), 0.98);
    }
}

TEST_F(SkinningTest, IdentityPoseIsTheBindPoseToTheByte) {
    Scene scene;
    scene.meshes = {node_of(tube(), 5)};
    const MeshPicture bind = world.draw(scene, view);
    scene.meshes[0].pose = pose(glm::mat4(1), glm::mat4(1));
    const MeshPicture posed = world.draw(scene, view);
    EXPECT_EQ(bind.object.pixels().size(), posed.object.pixels().size());
    for (std::size_t i = 0; i < bind.object.size(); ++i) {
        ASSERT_EQ(bind.object.pixels()[i], posed.object.pixels()[i]);
        ASSERT_EQ(bind.view_z_m.pixels()[i], posed.view_z_m.pixels()[i]);
    }
    // And nothing is skinned for the bind pose.
    const auto skins = [](const MeshPicture& p) {
        return std::count(p.report.passes.begin(), p.report.passes.end(), "meshes/skin");
    };
    EXPECT_EQ(skins(bind), 0);
    EXPECT_EQ(skins(posed), 1);
}

TEST_F(SkinningTest, VerticesWithoutWeightsStayWithTheRoot) {
    MeshAsset mesh = *tube();
    for (glm::vec4& w : mesh.weights) w = glm::vec4(0);
    Scene scene;
    scene.meshes = {node_of(std::make_shared<const MeshAsset>(mesh), 5)};
    scene.meshes[0].pose = pose(glm::translate(glm::mat4(1), {0.5f, 0, 0}), glm::mat4(0));
    EXPECT_GT(agreement(scene, view), 0.98);
    // Weights of a sum other than one are brought to one.
    for (glm::vec4& w : mesh.weights) w = glm::vec4(3, 0, 0, 0);
    scene.meshes[0].mesh = std::make_shared<const MeshAsset>(mesh);
    EXPECT_GT(agreement(scene, view), 0.98);
}

TEST_F(SkinningTest, JointsFarFromTheBindPoseAreNotCulledByItsSphere) {
    Scene scene;
    scene.meshes = {node_of(tube(), 5, glm::translate(glm::dmat4(1.0), {50, 0, 0}))};
    const auto passes = world.draw(scene, view).report.passes;
    EXPECT_EQ(std::count(passes.begin(), passes.end(), "meshes/draw"), 0);
    const glm::mat4 back = glm::translate(glm::mat4(1), {-50, 0, 0});
    scene.meshes[0].pose = pose(back, back);
    EXPECT_GT(agreement(scene, view), 0.98);
}

TEST_F(SkinningTest, EveryWayToSubmitDrawsSkinnedAndRigidMeshesAlike) {
    Scene scene = mixed_scene(60, 5);
    for (int i = 0; i < 3; ++i) {
        scene.meshes.push_back(node_of(tube(), static_cast<std::uint32_t>(100 + i),
                                       glm::translate(glm::dmat4(1.0), {i - 1.0, 0, -2.5})));
        scene.meshes.back().pose =
            pose(glm::mat4(1), glm::rotate(glm::mat4(1), 0.3f * static_cast<float>(i), {1, 0, 0}));
    }
    const View ahead = view_from({0, 0, 1}, {0, 0, -1});
    const MeshPicture fixed = world.draw(scene, ahead, {.submit = MeshSubmit::fixed_function});
    EXPECT_TRUE(same(fixed, world.draw(scene, ahead, {.submit = MeshSubmit::one_call_each})));
    EXPECT_TRUE(same(fixed, world.draw(scene, ahead, {.cull_on_device_from = 0})));
    EXPECT_TRUE(same(
        fixed,
        world.draw(scene, ahead, {.culling = MeshCulling::compact, .cull_on_device_from = 0})));
}

TEST_F(SkinningTest, DancingRobotAgreesWithTheDoubleReference) {
    const auto model = load_gltf("tests/data/meshes/RobotExpressive.glb");
    ASSERT_TRUE(model) << model.error().to_string();
    Scene scene;
    scene.materials = model->materials;
    scene.meshes = mesh_nodes(*model, {.animation = model->find_animation("Dance"), .time_s = 0.7});
    const View front = view_from({1, 3, 9}, {0, 2.2, 0}, 96, 72);
    EXPECT_GT(agreement(scene, front), 0.97);
}

}  // namespace
}  // namespace kino::test
