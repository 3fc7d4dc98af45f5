#include <gmock/gmock.h>

#include <random>

#include "apps/avatar/rig_file.h"
#include "humanoid_gltf.h"
#include "posed.h"
#include "viz/surface/assets/gltf_loader.h"
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
        // Every joint hangs on the one before, also in files where feet hang on the root.
        for (const Joint joint : {Joint::elbow_left, Joint::wrist_right, Joint::knee_left,
                                  Joint::ankle_left, Joint::ankle_right}) {
            const int above = (*rig)->of_joint[index_of(kJointParent[index_of(joint)])];
            int r = (*rig)->of_joint[index_of(joint)];
            while (r >= 0 && r != above) r = (*rig)->joints[static_cast<std::size_t>(r)].parent;
            EXPECT_EQ(r, above) << name << " " << joint_name(joint);
        }
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

/// The rig moves as a person does: what all of the recognition is for.
void expect_follows(AvatarRig rig, const std::string& what) {
    const auto shared = std::make_shared<const AvatarRig>(std::move(rig));
    AvatarTroupe troupe(shared, {.idle = false});
    const PosedBody person = person_at(Motion::dance, 3);
    BodyFrame frame;
    frame.bodies = {body_of(person)};
    for (int i = 0; i < 12; ++i) troupe.step(moment_of(frame));
    const Scene scene = filled(troupe);
    ASSERT_FALSE(scene.meshes.empty()) << what;
    for (const Joint joint :
         {Joint::spine, Joint::shoulder_center, Joint::elbow_left, Joint::wrist_left,
          Joint::elbow_right, Joint::wrist_right, Joint::knee_left, Joint::ankle_left,
          Joint::knee_right, Joint::ankle_right}) {
        EXPECT_LT(bone_error_deg(*shared, scene.meshes[0], person, joint), 1)
            << what << " " << joint_name(joint);
    }
    for (const AvatarPart& part : shared->parts)
        EXPECT_EQ(broken_invariant(*part.mesh), "") << what;
    expect_sane(scene);
}

TEST(AvatarFiles, CommonNamesAreRecognized) {
    for (const BoneNames names : {BoneNames::mixamo, BoneNames::vrm, BoneNames::blender,
                                  BoneNames::makehuman, BoneNames::unreal}) {
        const std::string what = "names " + std::to_string(static_cast<int>(names));
        const auto model = HumanoidFile{.names = names}.model();
        ASSERT_TRUE(model) << model.error().to_string();
        const auto rig = rig_of_model(*model, "made.gltf");
        ASSERT_TRUE(rig) << what << rig.error().to_string();
        for (std::size_t j = 0; j < kJointCount; ++j) {
            EXPECT_GE(rig->of_joint[j], 0) << what << " " << joint_name(static_cast<Joint>(j));
        }
        EXPECT_THAT(rig->notes, testing::IsEmpty()) << what;
        expect_follows(*rig, what);
    }
}

TEST(AvatarFiles, BonesWithoutNamesAreToldByTheirPlaces) {
    for (const bool z_up : {false, true}) {
        const auto model = HumanoidFile{.names = BoneNames::none, .z_up = z_up}.model();
        ASSERT_TRUE(model) << model.error().to_string();
        const auto rig = rig_of_model(*model, "made.gltf");
        ASSERT_TRUE(rig) << rig.error().to_string();
        EXPECT_THAT(rig->notes, testing::Contains(testing::HasSubstr("by their places")));
        expect_follows(*rig, "no names");
    }
}

TEST(AvatarFiles, UnitsAndDirectionsAreBroughtToOne) {
    const auto plain = rig_of_model(*HumanoidFile{}.model(), "plain");
    ASSERT_TRUE(plain);
    const RestBody wanted = make_rest_body(*plain);
    for (const HumanoidFile& file :
         {HumanoidFile{.unit = 100}, HumanoidFile{.unit = 0.01}, HumanoidFile{.faces_back = true},
          HumanoidFile{.z_up = true}, HumanoidFile{.unit = 100, .faces_back = true, .z_up = true},
          HumanoidFile{.rigid = true, .mesh_scale = {3, 0.5, 1}}}) {
        const auto model = file.model();
        ASSERT_TRUE(model) << model.error().to_string();
        const auto rig = rig_of_model(*model, "made.gltf");
        ASSERT_TRUE(rig) << rig.error().to_string();
        const RestBody rest = make_rest_body(*rig);
        const double scale =
            rest.length_m[index_of(Joint::knee_left)] / wanted.length_m[index_of(Joint::knee_left)];
        EXPECT_NEAR(scale, 1, 0.08);
        for (std::size_t j = 1; j < kJointCount; ++j) {
            EXPECT_LT(degrees_between(rest.axis[j], wanted.axis[j]), 0.01)
                << joint_name(static_cast<Joint>(j));
        }
        expect_follows(*rig, "units");
    }
}

TEST(AvatarFiles, FiveWeightsAVertexOrNoneWork) {
    for (const int weights : {1, 2, 5, 8}) {
        const auto model = HumanoidFile{.weights = weights}.model();
        ASSERT_TRUE(model) << model.error().to_string();
        const auto rig = rig_of_model(*model, "made.gltf");
        ASSERT_TRUE(rig) << rig.error().to_string();
        expect_follows(*rig, std::to_string(weights) + " weights");
    }
    // Meshes without weights are bound to the bone they hang on.
    const auto rigid = rig_of_model(*HumanoidFile{.rigid = true}.model(), "made.gltf");
    ASSERT_TRUE(rigid) << rigid.error().to_string();
    const auto at = rest_positions(*rigid);
    std::size_t near = 0;
    std::size_t all = 0;
    for (const AvatarPart& part : rigid->parts) {
        for (std::size_t v = 0; v < part.mesh->positions.size(); ++v) {
            ++all;
            near += glm::length(glm::dvec3(part.mesh->positions[v]) - at[part.mesh->joints[v][0]]) <
                    0.06;
        }
    }
    EXPECT_EQ(near, all);
}

TEST(AvatarFiles, MissingBonesAreDoneForByTheirParents) {
    const auto rig =
        rig_of_model(*HumanoidFile{.missing = {"neck", "head", "left hand", "left finger",
                                               "right toes", "right finger"}}
                          .model(),
                     "made.gltf");
    ASSERT_TRUE(rig) << rig.error().to_string();
    EXPECT_EQ(rig->of_joint[index_of(Joint::head)], -1);
    EXPECT_EQ(rig->of_joint[index_of(Joint::wrist_left)], -1);
    EXPECT_THAT(rig->notes, testing::Contains(testing::HasSubstr("head")));
    expect_follows(*rig, "parts missing");
}

TEST(AvatarFiles, WithoutHipsSpineOrALimbTheErrorNamesIt) {
    const auto error = [](const HumanoidFile& file) {
        const auto model = file.model();
        if (!model) return model.error().to_string();
        const auto rig = rig_of_model(*model, "made.gltf");
        return rig ? std::string("no error") : rig.error().to_string();
    };
    EXPECT_THAT(
        error({.missing = {"left lower arm", "left upper arm", "left hand", "left finger"}}),
        testing::AllOf(testing::HasSubstr("left arm"), testing::HasSubstr("made.gltf")));
    EXPECT_THAT(error({.missing = {"right lower leg", "right foot", "right toes"}}),
                testing::HasSubstr("right leg"));
    EXPECT_THAT(error({.missing = {"spine", "chest"}}), testing::HasSubstr("spine"));
    EXPECT_THAT(error({.missing = {"hips"}}), testing::HasSubstr("hips"));
    EXPECT_FALSE(open_avatar("nobody"));
    EXPECT_FALSE(open_avatar("tests/data/meshes/CornellBox.glb"));
    EXPECT_FALSE(open_avatar("not/there.glb"));
}

// Names, parents, weights and matrices of a good file changed at random: an error or a sane rig.
TEST(AvatarFiles, MutatedFilesAreRefusedOrStaySane) {
    const std::string good = HumanoidFile{.names = BoneNames::blender}.json();
    std::mt19937_64 random(21);
    int opened = 0;
    for (int i = 0; i < 400; ++i) {
        std::string text = good;
        const int changes = 1 + i % 4;
        for (int k = 0; k < changes; ++k) {
            // The JSON behind the buffer's bytes and the bytes alike.
            const std::size_t at = random() % text.size();
            text[at] = i % 2 == 0 ? good[random() % good.size()]
                                  : static_cast<char>("0123456789.-eEAz"[random() % 16]);
        }
        const auto none = [](const std::string& name, std::size_t) {
            return Result<std::vector<std::uint8_t>>(fail("no file " + name));
        };
        const auto model = parse_gltf(
            {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}, "mutated", none);
        if (!model) continue;
        const auto rig = rig_of_model(*model, "mutated");
        if (!rig) continue;
        ++opened;
        AvatarTroupe troupe(std::make_shared<const AvatarRig>(*rig), {.idle = false});
        BodyFrame frame;
        frame.bodies = {body_of(person_at(Motion::wave, 3))};
        for (int s = 0; s < 2; ++s) troupe.step(moment_of(frame));
        for (const MeshNode& node : filled(troupe).meshes) {
            for (const glm::mat4& m : *node.pose) {
                for (int c = 0; c < 4; ++c) {
                    for (int r = 0; r < 4; ++r) ASSERT_TRUE(std::isfinite(m[c][r])) << i;
                }
            }
        }
    }
    EXPECT_GT(opened, 50);
}

}  // namespace
}  // namespace kino::test
