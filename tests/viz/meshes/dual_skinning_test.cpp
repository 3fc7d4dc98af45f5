#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <numbers>
#include <random>

#include "mesh_world.h"
#include "tests/reference/skinned_readback.h"
#include "viz/scene/joint_turn.h"
#include "viz/surface/mesh_shapes.h"

namespace kino::test {
namespace {

using Random = std::mt19937_64;

glm::dvec3 vector_in(Random& random, double size) {
    std::uniform_real_distribution<double> in(-size, size);
    const double x = in(random);
    const double y = in(random);
    return {x, y, in(random)};
}

glm::dquat any_turn(Random& random) {
    std::normal_distribution<double> normal;
    const double w = normal(random);
    const double x = normal(random);
    const double y = normal(random);
    return glm::normalize(glm::dquat(w, x, y, normal(random)));
}

class DualSkinningTest : public VizTest {
  protected:
    DualSkinningTest() : world(device()) {}

    /// A ball whose vertices four of `joints` joints hold, with weights of all kinds.
    static std::shared_ptr<const MeshAsset> ball(Random& random, int joints, int rings = 24) {
        MeshAsset mesh = *make_sphere(0.6f, 32, rings);
        std::uniform_int_distribution<int> any(0, joints - 1);
        std::uniform_real_distribution<float> weight(0, 1);
        for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
            std::array<std::uint16_t, 4> held{};
            glm::vec4 w(0);
            for (int k = 0; k < 4; ++k) {
                held[static_cast<std::size_t>(k)] = static_cast<std::uint16_t>(any(random));
                w[k] = v % 5 < static_cast<std::size_t>(k) ? 0.0f : weight(random) + 1e-3f;
            }
            w /= w.x + w.y + w.z + w.w;
            mesh.joints.push_back(held);
            mesh.weights.push_back(w);
        }
        return std::make_shared<const MeshAsset>(std::move(mesh));
    }

    static MeshNode posed(std::shared_ptr<const MeshAsset> mesh, std::vector<glm::mat4> pose,
                          SkinBlend skin) {
        MeshNode node = node_of(std::move(mesh), 7);
        node.pose = std::make_shared<const std::vector<glm::mat4>>(std::move(pose));
        node.skin = skin;
        return node;
    }

    /// Largest distance from the double reference, m; normals must agree to 0.3 degrees.
    double error_of(const MeshNode& node, std::size_t* either = nullptr) {
        Scene scene;
        scene.meshes = {node};
        const auto device_made = read_skinned(device(), world.drawer, world.executor, scene, view);
        EXPECT_TRUE(device_made) << (device_made ? "" : device_made.error().to_string());
        if (!device_made) return 1e9;
        const auto reference = skin_mesh(node);
        const auto other = skin_mesh(node, true);
        EXPECT_EQ(device_made->size(), reference.size());
        double worst = 0;
        for (std::size_t v = 0; v < reference.size(); ++v) {
            const SkinnedVertex& made = (*device_made)[v];
            const double here = glm::length(made.position - reference[v].position);
            const double there = glm::length(made.position - other[v].position);
            const SkinnedVertex& nearest = here <= there ? reference[v] : other[v];
            if (either != nullptr && here > there) ++*either;
            worst = std::max(worst, std::min(here, there));
            EXPECT_GT(glm::dot(made.normal, nearest.normal), std::cos(0.005)) << v;
        }
        return worst;
    }

    MeshWorld world;
    View view = view_from({0, 0.5, 6}, {0, 0, 0}, 64, 48);
};

TEST_F(DualSkinningTest, RandomRigidPosesAgreeWithTheDoubleReference) {
    Random random(3);
    for (int round = 0; round < 6; ++round) {
        const auto mesh = ball(random, 9);
        std::vector<glm::mat4> pose;
        for (int j = 0; j < 9; ++j) {
            glm::dmat4 m = glm::mat4_cast(any_turn(random));
            m[3] = glm::dvec4(vector_in(random, 1.0), 1);
            pose.emplace_back(m);
        }
        EXPECT_LT(error_of(posed(mesh, pose, SkinBlend::dual_quaternion)), 1e-4);
    }
}

TEST_F(DualSkinningTest, SmallTurnsWithScaleAgreeInBothBlends) {
    Random random(4);
    std::uniform_real_distribution<double> stretch(0.6, 1.6);
    for (int round = 0; round < 4; ++round) {
        const auto mesh = ball(random, 6);
        std::vector<glm::mat4> pose;
        for (int j = 0; j < 6; ++j) {
            const glm::dvec3 axis = glm::normalize(vector_in(random, 1) + glm::dvec3(0, 1e-3, 0));
            glm::dmat4 m = glm::mat4_cast(glm::angleAxis(0.5 * stretch(random), axis));
            // Uneven, and along no axis of the joint.
            const glm::dmat4 skew = glm::mat4_cast(any_turn(random));
            m = m * skew *
                glm::scale(glm::dmat4(1), {stretch(random), stretch(random), stretch(random)}) *
                glm::transpose(skew);
            m[3] = glm::dvec4(vector_in(random, 0.2), 1);
            pose.emplace_back(m);
        }
        EXPECT_LT(error_of(posed(mesh, pose, SkinBlend::linear)), 1e-4);
        EXPECT_LT(error_of(posed(mesh, pose, SkinBlend::dual_quaternion)), 1e-4);
    }
}

// q and -q are one rotation; half turns have two short ways, and nearly opposite joints no third.
TEST_F(DualSkinningTest, HalfTurnsAndOppositeQuaternionsAgree) {
    Random random(5);
    const auto mesh = ball(random, 4);
    for (const double off : {0.0, 1e-3, -1e-3, 0.02}) {
        std::vector<glm::mat4> pose = {glm::mat4(1)};
        for (int axis = 0; axis < 3; ++axis) {
            glm::dvec3 n(0);
            n[axis] = 1;
            pose.emplace_back(glm::mat4_cast(glm::angleAxis(std::numbers::pi + off, n)));
        }
        EXPECT_LT(error_of(posed(mesh, pose, SkinBlend::dual_quaternion)), 1e-4) << off;
    }
    // More than half a turn is the other way round, for every joint alike.
    std::vector<glm::mat4> pose;
    for (int j = 0; j < 4; ++j) {
        pose.emplace_back(glm::mat4_cast(glm::angleAxis(3.0 + 0.1 * j, glm::dvec3(0, 1, 0))));
    }
    std::size_t either = 0;
    EXPECT_LT(error_of(posed(mesh, pose, SkinBlend::dual_quaternion), &either), 1e-4);
    EXPECT_EQ(either, 0u);
}

// A matrix of no rotation, or none at all, moves vertices where it says and breaks nothing.
TEST_F(DualSkinningTest, FlatAndMirroredJointsStayFinite) {
    Random random(6);
    const auto mesh = ball(random, 3);
    const glm::mat4 flat = glm::scale(glm::mat4(1), {1, 0, 1});
    const glm::mat4 mirror = glm::scale(glm::mat4(1), {-1, 1, 1});
    Scene scene;
    scene.meshes = {posed(mesh, {flat, glm::mat4(0), mirror}, SkinBlend::dual_quaternion)};
    const auto made = read_skinned(device(), world.drawer, world.executor, scene, view);
    ASSERT_TRUE(made) << made.error().to_string();
    for (const SkinnedVertex& v : *made) {
        EXPECT_TRUE(std::isfinite(v.position.x + v.position.y + v.position.z));
        EXPECT_LT(glm::length(v.position), 3);
        EXPECT_NEAR(glm::length(v.normal), 1, 1e-3);
    }
}

TEST_F(DualSkinningTest, WhereJointsAgreeOnAPointItStaysThere) {
    Random random(7);
    MeshAsset mesh = *ball(random, 4);
    const glm::vec3 fixed = mesh.positions[40];
    std::vector<glm::mat4> pose;
    for (int j = 0; j < 4; ++j) {
        glm::dmat4 m = glm::mat4_cast(any_turn(random)) *
                       glm::scale(glm::dmat4(1), glm::dvec3(0.8 + 0.15 * j, 1, 1.2));
        m[3] = glm::dvec4(glm::dvec3(0.3, 0.2, 0.1) - glm::dvec3(m * glm::dvec4(fixed, 0)), 1);
        pose.emplace_back(m);
    }
    Scene scene;
    scene.meshes = {
        posed(std::make_shared<const MeshAsset>(mesh), pose, SkinBlend::dual_quaternion)};
    const auto made = read_skinned(device(), world.drawer, world.executor, scene, view);
    ASSERT_TRUE(made) << made.error().to_string();
    EXPECT_LT(glm::length((*made)[40].position - glm::dvec3(0.3, 0.2, 0.1)), 1e-5);
}

TEST_F(DualSkinningTest, ATwistedTubeKeepsItsRadiusOnlyByDualQuaternions) {
    MeshAsset mesh = *make_cylinder(0.3f, 2, 16);
    for (glm::vec3& p : mesh.positions) {
        // The lids' rims come to the middle, where both joints hold alike.
        p.y = 0;
        mesh.joints.push_back({0, 1, 0, 0});
        mesh.weights.emplace_back(0.5f, 0.5f, 0, 0);
    }
    const auto tube = std::make_shared<const MeshAsset>(std::move(mesh));
    const std::vector<glm::mat4> pose = {glm::mat4(1), glm::rotate(glm::mat4(1), 2.6f, {0, 1, 0})};
    for (const SkinBlend skin : {SkinBlend::linear, SkinBlend::dual_quaternion}) {
        Scene scene;
        scene.meshes = {posed(tube, pose, skin)};
        const auto made = read_skinned(device(), world.drawer, world.executor, scene, view);
        ASSERT_TRUE(made) << made.error().to_string();
        double radius = 0;
        for (const SkinnedVertex& v : *made) {
            radius = std::max(radius, std::hypot(v.position.x, v.position.z));
        }
        EXPECT_NEAR(radius, skin == SkinBlend::linear ? 0.3 * std::cos(1.3) : 0.3, 1e-4);
    }
}

TEST_F(DualSkinningTest, EachBlendBringsItsOwnPipelineAndNoOther) {
    Random random(8);
    const auto mesh = ball(random, 2, 8);
    const std::vector<glm::mat4> pose(2, glm::mat4(1));
    const auto has = [&](const char* name) {
        const auto names = world.pipelines.names();
        return std::count(names.begin(), names.end(), name) > 0;
    };
    Scene scene;
    scene.meshes = {node_of(mesh, 7)};
    const auto still = world.draw(scene, view);
    EXPECT_EQ(std::count(still.report.passes.begin(), still.report.passes.end(), "meshes/skin"), 0);
    EXPECT_FALSE(has("meshes/skin"));
    EXPECT_FALSE(has("meshes/skin dual"));
    scene.meshes = {posed(mesh, pose, SkinBlend::dual_quaternion)};
    const auto dual = world.draw(scene, view);
    for (std::size_t i = 0; i < still.object.size(); ++i) {
        ASSERT_EQ(still.object.pixels()[i], dual.object.pixels()[i]);
        ASSERT_NEAR(still.view_z_m.pixels()[i], dual.view_z_m.pixels()[i], 1e-5);
    }
    EXPECT_FALSE(has("meshes/skin"));
    EXPECT_TRUE(has("meshes/skin dual"));
    // Both in one frame: one pass.
    scene.meshes.push_back(posed(mesh, pose, SkinBlend::linear));
    const auto both = world.draw(scene, view);
    EXPECT_EQ(std::count(both.report.passes.begin(), both.report.passes.end(), "meshes/skin"), 1);
    EXPECT_TRUE(has("meshes/skin"));
}

TEST(JointTurn, IsTheRotationOfThePolarDecomposition) {
    Random random(9);
    std::uniform_real_distribution<double> stretch(0.2, 3);
    for (int i = 0; i < 300; ++i) {
        const glm::dmat3 skew = glm::mat3_cast(any_turn(random));
        const glm::dvec3 s(stretch(random), stretch(random), stretch(random));
        glm::dmat3 m = glm::mat3_cast(any_turn(random)) * skew *
                       glm::dmat3(s.x, 0, 0, 0, s.y, 0, 0, 0, s.z) * glm::transpose(skew);
        const glm::dmat3 r = polar_parts(m).rotation;
        const glm::dmat3 found = glm::mat3_cast(nearest_rotation(m));
        for (int c = 0; c < 3; ++c) EXPECT_LT(glm::length(r[c] - found[c]), 1e-9);
    }
    // Half turns exactly, nothing at all, and what is not finite.
    for (int axis = 0; axis < 3; ++axis) {
        glm::dmat3 half(-1.0);
        half[axis][axis] = 1;
        const glm::dmat3 found = glm::mat3_cast(nearest_rotation(half));
        for (int c = 0; c < 3; ++c) EXPECT_LT(glm::length(half[c] - found[c]), 1e-12);
    }
    EXPECT_EQ(nearest_rotation(glm::dmat3(0.0)), glm::dquat(1, 0, 0, 0));
    EXPECT_EQ(nearest_rotation(glm::dmat3(NAN)), glm::dquat(1, 0, 0, 0));
}

}  // namespace
}  // namespace kino::test
