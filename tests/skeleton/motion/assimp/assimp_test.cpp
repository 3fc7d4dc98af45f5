#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <map>
#include <string>

#include <gtest/gtest.h>

#include "tests/skeleton/motion/test_clips.h"

/// BVH and GLB as the Open Asset Import Library understands them.
namespace kino::test {
namespace {

template <class Key>
const Key& key_at(const Key* keys, unsigned count, std::size_t frame) {
    return keys[std::min<std::size_t>(frame, count - 1)];
}

aiMatrix4x4 local_of(const aiNode& node, const aiAnimation& animation, std::size_t frame) {
    for (unsigned c = 0; c < animation.mNumChannels; ++c) {
        const aiNodeAnim& channel = *animation.mChannels[c];
        if (channel.mNodeName != node.mName) continue;
        aiVector3D place, size(1, 1, 1);
        aiQuaternion turn;
        aiMatrix4x4 rest = node.mTransformation;
        rest.Decompose(size, turn, place);
        if (channel.mNumPositionKeys > 0)
            place = key_at(channel.mPositionKeys, channel.mNumPositionKeys, frame).mValue;
        if (channel.mNumRotationKeys > 0)
            turn = key_at(channel.mRotationKeys, channel.mNumRotationKeys, frame).mValue;
        return {aiVector3D(1, 1, 1), turn, place};
    }
    return node.mTransformation;
}

void places_of(const aiNode& node, const aiMatrix4x4& parent, const aiAnimation& animation,
               std::size_t frame, std::map<std::string, glm::dvec3>& out) {
    const aiMatrix4x4 world = parent * local_of(node, animation, frame);
    out[node.mName.C_Str()] = {world.a4, world.b4, world.c4};
    for (unsigned i = 0; i < node.mNumChildren; ++i)
        places_of(*node.mChildren[i], world, animation, frame, out);
}

/// Checks the places of all joints in every `step`-th frame of the file.
void expect_places(const MotionClip& clip, const char* extension, double unit_m, std::size_t step) {
    const std::string bytes = written(clip, std::string("a.") + extension);
    Assimp::Importer importer;
    const aiScene* scene = importer.ReadFileFromMemory(bytes.data(), bytes.size(), 0, extension);
    ASSERT_NE(scene, nullptr) << importer.GetErrorString();
    ASSERT_EQ(scene->mNumAnimations, 1u);
    const aiAnimation& animation = *scene->mAnimations[0];
    const Places wanted = normalized(world_places(clip));
    unsigned keys = 0;
    for (unsigned c = 0; c < animation.mNumChannels; ++c)
        keys = std::max(keys, animation.mChannels[c]->mNumRotationKeys);
    ASSERT_EQ(keys, wanted.size());
    for (std::size_t i = 0; i < wanted.size(); i += step) {
        std::map<std::string, glm::dvec3> found;
        places_of(*scene->mRootNode, aiMatrix4x4(), animation, i, found);
        // Its matrices are of single precision.
        EXPECT_LT(largest_error_m(found, unit_m, wanted[i]), 1e-4) << extension << ", frame " << i;
    }
    EXPECT_NEAR(animation.mDuration / animation.mTicksPerSecond,
                static_cast<double>(wanted.size() - 1) / 30, 1.1 / 30)
        << extension;
}

TEST(Assimp, ReadsEveryMotionOfBvh) {
    for (const Motion motion : all_motions())
        expect_places(synthetic_clip(motion, 90), "bvh", 0.01, 13);
    expect_places(random_clip(5, 40), "bvh", 0.01, 7);
}

TEST(Assimp, ReadsEveryMotionOfGlb) {
    for (const Motion motion : all_motions())
        expect_places(synthetic_clip(motion, 90), "glb", 1, 13);
    expect_places(random_clip(5, 40), "glb", 1, 7);
}

}  // namespace
}  // namespace kino::test
