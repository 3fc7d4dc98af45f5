#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "gltf_sample.h"
#include "tests/support/temp_dir.h"
#include "viz/surface/assets/gltf_loader.h"
#include "viz/surface/mesh_shapes.h"

namespace kino::test {
namespace {

using Bytes = std::vector<std::uint8_t>;

Result<GltfModel> parse(const Bytes& bytes, const GltfLimits& limits = {}) {
    return parse_gltf(
        bytes, "sample",
        [](const std::string& name, std::size_t) { return Result<Bytes>(fail("no file " + name)); },
        limits);
}

/// What reading the sample says after a change to it; empty: it was read.
template <class Change>
std::string refused(const Change& change) {
    GltfSample sample = make_gltf_sample();
    change(sample);
    const auto model = parse(sample.as_glb());
    return model ? std::string() : model.error().to_string();
}

TEST(Gltf, GlbAndJsonHoldTheSameModel) {
    const GltfSample sample = make_gltf_sample();
    const auto glb = parse(sample.as_glb());
    const auto gltf = parse(sample.as_gltf());
    ASSERT_TRUE(glb) << glb.error().to_string();
    ASSERT_TRUE(gltf) << gltf.error().to_string();
    ASSERT_EQ(glb->meshes.size(), 1u);
    ASSERT_EQ(gltf->meshes.size(), 1u);
    EXPECT_EQ(glb->meshes[0].asset->positions, gltf->meshes[0].asset->positions);
    EXPECT_EQ(glb->meshes[0].asset->indices, gltf->meshes[0].asset->indices);
    EXPECT_EQ(glb->notes, gltf->notes);
}

TEST(Gltf, ReadsMeshMaterialSkinAndTexture) {
    const auto model = parse(make_gltf_sample().as_glb());
    ASSERT_TRUE(model) << model.error().to_string();
    const MeshAsset& mesh = *model->meshes.at(0).asset;
    EXPECT_EQ(broken_invariant(mesh), "");
    EXPECT_EQ(mesh.name, "strip");
    EXPECT_EQ(mesh.positions.size(), 6u);
    EXPECT_EQ(mesh.indices.size(), 12u);
    EXPECT_EQ(mesh.uvs.at(3), glm::vec2(1, 0.5f));
    // Root first.
    const GltfSkin& skin = model->skins.at(0);
    ASSERT_EQ(skin.joints.size(), 2u);
    EXPECT_EQ(skin.joints[0].name, "root");
    EXPECT_EQ(skin.joints[0].parent, -1);
    EXPECT_EQ(skin.joints[1].name, "tip");
    EXPECT_EQ(skin.joints[1].parent, 0);
    EXPECT_EQ(mesh.joints[0][0], 0);
    EXPECT_EQ(mesh.joints[5][0], 1);
    EXPECT_FLOAT_EQ(skin.joints[1].joint_from_bind[3][1], -1);
    EXPECT_NEAR(skin.joints[0].parent_from_joint[0][0], 2, 1e-6);  // the stage's scale
    EXPECT_NEAR(skin.joints[1].parent_from_joint[3][1], 1, 1e-6);
    const Material& material = model->materials.at(0);
    EXPECT_EQ(material.name, "cloth");
    EXPECT_FLOAT_EQ(material.opacity, 0.5f);
    EXPECT_EQ(material.base_color, glm::vec3(0.5f, 0.25f, 1));
    EXPECT_EQ(material.emission, glm::vec3(0, 0.5f, 0));
    ASSERT_EQ(material.layers.size(), 2u);
    EXPECT_EQ(material.layers[0].lobes.at(0).kind, LobeKind::ggx);
    EXPECT_FLOAT_EQ(material.layers[0].lobes[0].roughness, 0.3f);
    ASSERT_NE(material.texture, nullptr);
    EXPECT_EQ(material.texture->at(0, 0).r, 255);
}

// The strip is bent by 90 degrees about z at its middle, on a stage of scale 2.
TEST(Gltf, AnimationBendsTheStripAsComputedByHand) {
    const auto model = parse(make_gltf_sample().as_glb());
    ASSERT_TRUE(model) << model.error().to_string();
    ASSERT_EQ(model->find_animation("bend"), 0);
    EXPECT_DOUBLE_EQ(model->animations[0].duration_s, 2);
    const auto nodes =
        mesh_nodes(*model, {.first_id = 7, .first_material = 3, .animation = 0, .time_s = 5});
    ASSERT_EQ(nodes.size(), 1u);
    EXPECT_EQ(nodes[0].id, 7u);
    EXPECT_EQ(nodes[0].material, 4u);
    // The mesh's own node (at 9, 9, 9) does not place a skinned mesh.
    EXPECT_EQ(nodes[0].world_from_object, glm::dmat4(1.0));
    ASSERT_NE(nodes[0].pose, nullptr);
    const auto at = [&](double angle, const glm::dvec3& p, double root) {
        const glm::dmat4 stage = glm::scale(glm::dmat4(1.0), glm::dvec3(2));
        const glm::dmat4 turn =
            glm::rotate(glm::translate(glm::dmat4(1.0), {0, 1, 0}), angle, {0, 0, 1}) *
            glm::translate(glm::dmat4(1.0), {0, -1, 0});
        return glm::dvec3(stage * (root * glm::dmat4(1.0) + (1 - root) * turn) *
                          glm::dvec4(p, 1.0));
    };
    const auto posed = [&](double time_s, std::size_t v) {
        const auto frame = mesh_nodes(*model, {.animation = 0, .time_s = time_s});
        const MeshAsset& mesh = *frame[0].mesh;
        glm::dvec4 sum(0);
        for (int k = 0; k < 4; ++k) {
            sum += static_cast<double>(mesh.weights[v][k]) *
                   (glm::dmat4((*frame[0].pose)[mesh.joints[v][k]]) *
                    glm::dvec4(glm::dvec3(mesh.positions[v]), 1.0));
        }
        return glm::dvec3(sum);
    };
    const double right = std::acos(0.0);
    for (const auto& [time, angle] :
         {std::pair(0.0, 0.0), std::pair(1.0, right), std::pair(0.5, right / 2),
          std::pair(3.0, right), std::pair(-1.0, right)}) {
        EXPECT_LT(glm::length(posed(time, 5) - at(angle, {1, 2, 0}, 0)), 1e-5) << time;
        EXPECT_LT(glm::length(posed(time, 3) - at(angle, {1, 1, 0}, 0.5)), 1e-5) << time;
        EXPECT_LT(glm::length(posed(time, 0) - at(angle, {-1, 0, 0}, 1)), 1e-5) << time;
    }
}

TEST(Gltf, KeysAreSampledAsTheSpecificationSays) {
    GltfModel model;
    model.nodes.resize(1);
    GltfAnimation animation;
    animation.channels.push_back({.node = 0,
                                  .path = GltfPath::translation,
                                  .interpolation = GltfInterpolation::step,
                                  .times_s = {1, 2},
                                  .values = {{1, 0, 0, 0}, {3, 0, 0, 0}}});
    const auto x = [&](double t) { return model_from_nodes(model, &animation, t)[0][3][0]; };
    EXPECT_EQ(x(0), 1);
    EXPECT_EQ(x(1.99), 1);
    EXPECT_EQ(x(2), 3);
    EXPECT_EQ(x(std::nan("")), 1);
    animation.channels[0].interpolation = GltfInterpolation::linear;
    EXPECT_DOUBLE_EQ(x(1.25), 1.5);
    // A cubic whose tangents are those of t^3 is t^3.
    animation.channels[0].interpolation = GltfInterpolation::cubic;
    animation.channels[0].values = {{0, 0, 0, 0},  {1, 0, 0, 0}, {3, 0, 0, 0},
                                    {12, 0, 0, 0}, {8, 0, 0, 0}, {0, 0, 0, 0}};
    for (const double t : {1.0, 1.1, 1.5, 1.9, 2.0}) EXPECT_NEAR(x(t), t * t * t, 1e-12);
    // Rotations take the short way, also between a quaternion and its negative.
    animation.channels[0] = {.node = 0,
                             .path = GltfPath::rotation,
                             .times_s = {0, 1},
                             .values = {{0, 0, 0, 1}, {0, 0, 0, -1}}};
    EXPECT_NEAR(model_from_nodes(model, &animation, 0.5)[0][0][0], 1, 1e-12);
}

TEST(Gltf, MissingNormalsAreFlat) {
    GltfSample sample = make_gltf_sample();
    sample.json["meshes"][0]["primitives"][0]["attributes"].erase("NORMAL");
    const auto model = parse(sample.as_glb());
    ASSERT_TRUE(model) << model.error().to_string();
    const MeshAsset& mesh = *model->meshes[0].asset;
    EXPECT_EQ(mesh.positions.size(), 12u);
    for (const glm::vec3& n : mesh.normals) EXPECT_LT(glm::length(n - glm::vec3(0, 0, 1)), 1e-6f);
    EXPECT_EQ(mesh.joints.size(), 12u);
}

TEST(Gltf, StripsAndFansBecomeTriangles) {
    for (const int mode : {5, 6}) {
        GltfSample sample = make_gltf_sample();
        auto& primitive = sample.json["meshes"][0]["primitives"][0];
        primitive["mode"] = mode;
        primitive["indices"] = sample.add(mode == 5 ? std::vector<std::uint16_t>{0, 1, 2, 3, 4, 5}
                                                    : std::vector<std::uint16_t>{0, 1, 3, 5, 4, 2},
                                          "SCALAR");
        const auto model = parse(sample.as_glb());
        ASSERT_TRUE(model) << model.error().to_string();
        const MeshAsset& mesh = *model->meshes[0].asset;
        ASSERT_EQ(mesh.indices.size(), 12u);
        double area = 0;
        for (std::size_t t = 0; t < 12; t += 3) {
            const glm::dvec3 a = mesh.positions[mesh.indices[t]];
            area += 0.5 * glm::cross(glm::dvec3(mesh.positions[mesh.indices[t + 1]]) - a,
                                     glm::dvec3(mesh.positions[mesh.indices[t + 2]]) - a)
                              .z;
        }
        EXPECT_NEAR(area, 4, 1e-6) << mode;  // all of them to the front
    }
}

TEST(Gltf, StrongestFourOfFiveJointsAreKeptAndTold) {
    GltfSample sample = make_gltf_sample();
    auto& attributes = sample.json["meshes"][0]["primitives"][0]["attributes"];
    std::vector<std::uint16_t> none(24, 0);
    std::vector<float> four;
    for (int v = 0; v < 6; ++v) four.insert(four.end(), {0.1f, 0.2f, 0.05f, 0.3f});
    std::vector<float> one;
    for (int v = 0; v < 6; ++v) one.insert(one.end(), {0.35f, 0, 0, 0});
    attributes["WEIGHTS_0"] = sample.add(four, "VEC4");
    attributes["JOINTS_1"] = sample.add(none, "VEC4");
    attributes["WEIGHTS_1"] = sample.add(one, "VEC4");
    const auto model = parse(sample.as_glb());
    ASSERT_TRUE(model) << model.error().to_string();
    const glm::vec4 w = model->meshes[0].asset->weights[0];
    EXPECT_NEAR(w[0], 0.35 / 0.95, 1e-6);
    EXPECT_NEAR(w[1], 0.3 / 0.95, 1e-6);
    EXPECT_NEAR(w[2], 0.2 / 0.95, 1e-6);
    EXPECT_NEAR(w[3], 0.1 / 0.95, 1e-6);
    ASSERT_EQ(model->notes.size(), 1u);
    EXPECT_NE(model->notes[0].find("strongest four"), std::string::npos);
}

TEST(Gltf, WeightsThatSumToNothingFallBackToTheRoot) {
    GltfSample sample = make_gltf_sample();
    std::vector<float> weights(24, 0);
    weights[4] = NAN;
    weights[8] = -1;
    weights[12] = 3;  // joint 1 of the file: the root; normalised
    sample.json["meshes"][0]["primitives"][0]["attributes"]["WEIGHTS_0"] =
        sample.add(weights, "VEC4");
    const auto model = parse(sample.as_glb());
    ASSERT_TRUE(model) << model.error().to_string();
    const MeshAsset& mesh = *model->meshes[0].asset;
    for (std::size_t v = 0; v < 6; ++v) {
        EXPECT_EQ(mesh.joints[v][0], 0) << v;
        EXPECT_EQ(mesh.weights[v], glm::vec4(1, 0, 0, 0)) << v;
    }
    EXPECT_EQ(model->notes.size(), 1u);
}

TEST(Gltf, HostileFilesAreRefusedByName) {
    const auto set = [](const char* pointer, const nlohmann::json& value) {
        return refused(
            [&](GltfSample& s) { s.json[nlohmann::json::json_pointer(pointer)] = value; });
    };
    EXPECT_EQ(refused([](GltfSample&) {}), "");
    EXPECT_NE(set("/asset/version", "1.0"), "");
    EXPECT_NE(set("/extensionsRequired", {"KHR_draco_mesh_compression"}), "");
    EXPECT_NE(set("/accessors/0/count", 7), "");
    EXPECT_NE(set("/accessors/0/count", 4294967295u), "");
    EXPECT_NE(set("/accessors/0/count", -1), "");
    EXPECT_NE(set("/accessors/0/byteOffset", 1u << 31), "");
    EXPECT_NE(set("/accessors/0/componentType", 5130), "");
    EXPECT_NE(set("/accessors/0/type", "MAT5"), "");
    EXPECT_NE(set("/accessors/3/componentType", 5126), "");  // runs past, and no indices
    EXPECT_NE(set("/bufferViews/0/buffer", 1), "");
    EXPECT_NE(set("/bufferViews/0/byteLength", 1u << 20), "");
    EXPECT_NE(set("/bufferViews/0/byteStride", 4), "");
    EXPECT_NE(set("/buffers/0/byteLength", 1u << 20), "");
    EXPECT_NE(set("/nodes/1/children", {3}), "");     // a circle
    EXPECT_NE(set("/nodes/3/children", {2, 2}), "");  // twice
    EXPECT_NE(set("/nodes/0/children", {1}), "");     // two parents
    EXPECT_NE(set("/nodes/0/mesh", 1), "");
    EXPECT_NE(set("/nodes/0/skin", "x"), "");
    EXPECT_NE(set("/nodes/0/matrix", {1, 2, 3}), "");
    EXPECT_NE(set("/skins/0/joints", {9}), "");
    EXPECT_NE(set("/skins/0/inverseBindMatrices", 0), "");
    EXPECT_NE(set("/meshes/0/primitives/0/attributes/NORMAL", 3), "");
    EXPECT_NE(set("/meshes/0/primitives/0/material", 4), "");
    EXPECT_NE(set("/animations/0/channels/0/sampler", 3), "");
    EXPECT_NE(set("/animations/0/samplers/0/output", 2), "");
    EXPECT_NE(set("/images/0/uri", "../../etc/passwd"), "");
    EXPECT_NE(set("/images/0/uri", "%2e%2e/secret.png"), "");
    EXPECT_NE(set("/images/0/uri", "/etc/passwd"), "");
    EXPECT_NE(set("/images/0/uri", "file:///etc/passwd"), "");
    EXPECT_NE(set("/images/0/uri", "data:image/png;base64,AAAA"), "");
    EXPECT_NE(set("/textures/0/source", 1), "");
    EXPECT_NE(set("/materials/0/pbrMetallicRoughness/baseColorFactor", {1e39, 0, 0, 0}), "");
    const auto index = refused([](GltfSample& s) {
        s.json["meshes"][0]["primitives"][0]["indices"] =
            s.add(std::vector<std::uint16_t>{0, 1, 6}, "SCALAR");
    });
    EXPECT_NE(index.find("beyond the vertices"), std::string::npos) << index;
    const auto nan = refused([](GltfSample& s) {
        std::vector<float> positions(18, 0);
        positions[4] = NAN;
        s.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = s.add(positions, "VEC3");
    });
    EXPECT_NE(nan.find("not a number"), std::string::npos) << nan;
}

TEST(Gltf, ContainersThatLieAboutTheirLengthsAreRefused) {
    const Bytes good = make_gltf_sample().as_glb();
    for (const std::size_t at : {4u, 8u, 12u, 16u}) {
        for (const int byte : {0x00, 0x7F, 0xFF}) {
            const auto value = static_cast<std::uint8_t>(byte);
            Bytes bad = good;
            bad[at] = bad[at + 1] = bad[at + 2] = bad[at + 3] = value;
            EXPECT_FALSE(parse(bad)) << at << " " << byte;
        }
    }
    for (std::size_t size = 0; size < good.size(); size += 97) {
        EXPECT_FALSE(parse(Bytes(good.begin(), good.begin() + static_cast<std::ptrdiff_t>(size))));
    }
    const std::string deep(100000, '[');
    EXPECT_FALSE(parse(Bytes(deep.begin(), deep.end())));
    GltfLimits few;
    few.vertices = 5;
    EXPECT_FALSE(parse(good, few));
    few = {};
    few.texture_px = 1;
    EXPECT_FALSE(parse(good, few));
}

// One mesh under many skins is as many meshes: the limits hold for their sum.
TEST(Gltf, OneMeshUnderManySkinsIsCountedForEach) {
    GltfSample sample = make_gltf_sample();
    for (int i = 1; i < 20; ++i) {
        sample.json["skins"].push_back(sample.json["skins"][0]);
        nlohmann::json node = sample.json["nodes"][0];
        node["skin"] = i;
        sample.json["scenes"][0]["nodes"].push_back(sample.json["nodes"].size());
        sample.json["nodes"].push_back(node);
    }
    GltfLimits limits;
    const auto model = parse(sample.as_glb(), limits);
    ASSERT_TRUE(model) << model.error().to_string();
    EXPECT_EQ(model->meshes.size(), 20u);
    limits.vertices = 20 * 6 - 1;
    EXPECT_FALSE(parse(sample.as_glb(), limits));
    limits = {};
    limits.indices = 20 * 12 - 1;
    EXPECT_FALSE(parse(sample.as_glb(), limits));
}

TEST(Gltf, RobotOfThreeJsIsReadWithItsDances) {
    const auto model = load_gltf("tests/data/meshes/RobotExpressive.glb");
    ASSERT_TRUE(model) << model.error().to_string();
    EXPECT_EQ(model->animations.size(), 14u);
    EXPECT_EQ(model->skins.size(), 2u);
    ASSERT_GE(model->find_animation("Dance"), 0);
    // What is drawn lies above the floor and is about as large as a robot.
    const auto nodes =
        mesh_nodes(*model, {.animation = model->find_animation("Dance"), .time_s = 0.4});
    EXPECT_GT(nodes.size(), 10u);
    for (const MeshNode& node : nodes) EXPECT_EQ(broken_invariant(*node.mesh), "");
}

TEST(Gltf, CornellBoxIsRead) {
    const auto model = load_gltf("tests/data/meshes/CornellBox.glb");
    ASSERT_TRUE(model) << model.error().to_string();
    EXPECT_EQ(model->materials.size(), 5u);
    EXPECT_GE(mesh_nodes(*model, {}).size(), 4u);
}

}  // namespace
}  // namespace kino::test
