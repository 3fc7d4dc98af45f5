#include <algorithm>
#include <glm/gtc/matrix_transform.hpp>
#include <random>
#include <vector>

#include "mesh_world.h"
#include "viz/surface/mesh_ranges.h"
#include "viz/surface/mesh_shapes.h"
#include "viz/surface/mesh_texels.h"

namespace kino::test {
namespace {

// Item 11, the allocator's part: against a map of single units.
TEST(MeshRanges, TenThousandRandomTakesAndReturnsNeverOverlap) {
    std::mt19937 random(29);
    constexpr std::uint32_t kUnits = 4096;
    MeshRanges ranges(kUnits);
    std::vector<char> taken(kUnits, 0);
    std::vector<std::pair<std::uint32_t, std::uint32_t>> held;
    int refused = 0;
    for (int round = 0; round < 10000; ++round) {
        if (random() % 2 == 0 || held.empty()) {
            const auto count = static_cast<std::uint32_t>(1 + random() % 200);
            const auto first = ranges.take(count);
            // Refused only where no gap of the map is long enough.
            std::uint32_t longest = 0;
            std::uint32_t run = 0;
            for (std::uint32_t i = 0; i < kUnits; ++i) {
                run = taken[i] != 0 ? 0 : run + 1;
                longest = std::max(longest, run);
            }
            ASSERT_EQ(first.has_value(), longest >= count);
            if (!first) {
                ++refused;
                continue;
            }
            for (std::uint32_t i = *first; i < *first + count; ++i) {
                ASSERT_EQ(taken[i], 0);
                taken[i] = 1;
            }
            held.emplace_back(*first, count);
        } else {
            const std::size_t which = random() % held.size();
            const auto [first, count] = held[which];
            ranges.give_back(first, count);
            std::fill_n(taken.begin() + first, count, 0);
            held.erase(held.begin() + static_cast<std::ptrdiff_t>(which));
        }
        ASSERT_EQ(ranges.used(), std::count(taken.begin(), taken.end(), 1));
    }
    EXPECT_GT(refused, 50);
    while (!held.empty()) {
        ranges.give_back(held.back().first, held.back().second);
        held.pop_back();
    }
    EXPECT_EQ(ranges.used(), 0u);
    EXPECT_EQ(ranges.gaps().size(), 1u);
    EXPECT_EQ(ranges.fragmentation(), 0);
}

class PoolTest : public VizTest {};

// Item 11, the pool's part.
TEST_F(PoolTest, ScenesThatComeAndGoLookAsIfTheyHadNeverDone) {
    std::mt19937 random(31);
    std::vector<std::shared_ptr<const MeshAsset>> assets;
    for (int i = 0; i < 40; ++i) {
        assets.push_back(i % 2 == 0 ? make_sphere(0.4f, 3 + i, 3 + i / 2) : make_box({1, 0.5f, 1}));
    }
    MeshPool pool(device());
    for (int round = 0; round < 300; ++round) {
        std::vector<std::shared_ptr<const MeshAsset>> wanted;
        for (const auto& asset : assets) {
            if (random() % 3 == 0) wanted.push_back(asset);
        }
        ASSERT_TRUE(pool.keep(wanted));
        // What is wanted lies where the pool says, and nowhere else.
        const auto* words = static_cast<const float*>(pool.vertices().mapped());
        const auto* indices = static_cast<const std::uint32_t*>(pool.indices().mapped());
        for (const auto& asset : wanted) {
            const PooledMesh* mesh = pool.find(asset.get());
            ASSERT_NE(mesh, nullptr);
            for (std::size_t v = 0; v < asset->positions.size(); ++v) {
                ASSERT_EQ(words[8 * (mesh->first_vertex + v) + 1], asset->positions[v].y);
            }
            ASSERT_TRUE(std::equal(asset->indices.begin(), asset->indices.end(),
                                   indices + mesh->first_index));
        }
        for (const auto& asset : assets) {
            if (std::find(wanted.begin(), wanted.end(), asset) == wanted.end()) {
                ASSERT_EQ(pool.find(asset.get()), nullptr);
            }
        }
        std::uint32_t used = 0;
        for (const auto& asset : wanted)
            used += static_cast<std::uint32_t>(asset->positions.size());
        ASSERT_EQ(pool.vertex_ranges().used(), used);
    }
    ASSERT_TRUE(pool.keep({}));
    EXPECT_EQ(pool.bytes(), 0u);
}

TEST_F(PoolTest, MeshesThatBreakTheirInvariantsAreRefused) {
    const auto refused = [&](const auto& change) {
        MeshAsset mesh = *make_box({1, 1, 1});
        change(mesh);
        MeshPool pool(device());
        const auto kept = pool.keep({std::make_shared<const MeshAsset>(mesh)});
        return !kept && kept.error().where.find("box") != std::string::npos;
    };
    EXPECT_TRUE(refused([](MeshAsset& m) { m.indices[0] = 24; }));
    EXPECT_TRUE(refused([](MeshAsset& m) { m.indices[0] = UINT32_MAX; }));  // the restart index
    EXPECT_TRUE(refused([](MeshAsset& m) { m.indices.pop_back(); }));
    EXPECT_TRUE(refused([](MeshAsset& m) { m.normals.pop_back(); }));
    EXPECT_TRUE(refused([](MeshAsset& m) { m.uvs.pop_back(); }));
    EXPECT_TRUE(refused([](MeshAsset& m) { m.joints.resize(3); }));
    EXPECT_TRUE(refused([](MeshAsset& m) { m.positions.clear(); }));
}

TEST(MeshTexels, LevelsHalveAndKeepTheMeanLight) {
    auto image = std::make_shared<Image<Rgba8>>(8, 4);
    for (Rgba8& p : image->pixels()) p = {0, 255, 188, 255};
    for (int x = 0; x < 8; x += 2) image->at(x, 0) = image->at(x, 2) = {255, 255, 188, 255};
    const auto other = std::make_shared<Image<Rgba8>>(1, 1);
    const std::vector<std::shared_ptr<const Image<Rgba8>>> images = {image, other};
    const auto words = pack_textures(images);
    EXPECT_EQ(words[0], 8u);
    EXPECT_EQ(words[1], 4u);
    EXPECT_EQ(words[2], 4u);  // 8x4, 4x2, 2x1, 1x1
    EXPECT_EQ(words[4], 32u);
    EXPECT_EQ(words[5], 32u + 32);
    EXPECT_EQ(words[6], 64u + 8);
    EXPECT_EQ(words[7], 72u + 2);
    // A quarter of full light is 137 in sRGB.
    EXPECT_EQ(words[words[7]] & 0xFFu, 137u);
    EXPECT_EQ(words[words[7]] >> 8 & 0xFFu, 255u);
    EXPECT_EQ(words[words[7]] >> 16 & 0xFFu, 188u);
    EXPECT_EQ(words[kTextureHeadWords], 1u);
    EXPECT_EQ(words.size(), 32u + 32 + 8 + 2 + 1 + 1);
}

}  // namespace
}  // namespace kino::test
