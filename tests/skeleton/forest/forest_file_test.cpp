#include "skeleton/forest/forest_file.h"

#include <gtest/gtest.h>

#include <numeric>

#include "forest_samples.h"
#include "fuzz/forest_targets.h"
#include "sensor/session/crc32.h"
#include "tests/support/temp_dir.h"

namespace kino {
namespace {

using Buffer = std::vector<std::uint8_t>;

void put_checksum_right(Buffer& bytes) {
    if (bytes.size() < 4) return;
    const std::size_t end = bytes.size() - 4;
    const std::uint32_t crc = crc32(std::span(bytes).first(end));
    for (std::size_t i = 0; i < 4; ++i) bytes[end + i] = static_cast<std::uint8_t>(crc >> (8 * i));
}

TEST(ForestFile, RoundTripKeepsEverything) {
    for (const std::uint64_t seed : {1, 2, 3}) {
        const Forest forest = test::random_forest(seed, 1 + 9 * static_cast<int>(seed), 3, 7, 0.2);
        const Buffer bytes = forest_to_bytes(forest);
        const auto again = forest_from_bytes(bytes, "x");
        ASSERT_TRUE(again.has_value()) << again.error().to_string();
        EXPECT_EQ(*again, forest);
        EXPECT_EQ(forest_to_bytes(*again), bytes);
    }
}

TEST(ForestFile, RoundTripThroughADisk) {
    const test::TempDir dir;
    const Forest forest = test::random_forest(4, 14, 2, 9);
    ASSERT_TRUE(write_forest(dir / "a.forest", forest).has_value());
    const auto again = read_forest(dir / "a.forest");
    ASSERT_TRUE(again.has_value());
    EXPECT_EQ(*again, forest);
    EXPECT_FALSE(read_forest(dir / "none").has_value());
}

// Laid out by hand from docs/forest.md.
TEST(ForestFile, LayoutIsTheDocumentedOne) {
    Buffer bytes = {'K', 'I', 'N',  'O',  'F',  'R', 'S', 'T', 1,    0,    2,    1,    2,    0,
                    0,   0,   2,    0,    'h',  'i', 1,   'a', 1,    'b',  1,    0,    255,  2,
                    0,   5,   1,    250,  3,    0,   0,   0,   0x01, 0x01, 0x00, 0xFF, 0xFF, 0x02,
                    0,   0,   0x80, 0x9C, 0xFF, 1,   0,   0,   0,    0,    0};
    bytes.insert(bytes.end(), 4, 0);
    put_checksum_right(bytes);
    const auto forest = forest_from_bytes(bytes, "x");
    ASSERT_TRUE(forest.has_value()) << forest.error().to_string();
    EXPECT_EQ(forest->note, "hi");
    EXPECT_EQ(forest->labels, (std::vector<std::string>{"a", "b"}));
    EXPECT_EQ(forest->distributions[0][0], 255);
    EXPECT_EQ(forest->distributions[1][1], 250);
    const auto& nodes = forest->trees.at(0).nodes;
    ASSERT_EQ(nodes.size(), 3u);
    EXPECT_EQ(nodes[0].feature, (ForestFeature{{1, -1}, {2, -32768}}));
    EXPECT_EQ(nodes[0].threshold_mm, -100);
    EXPECT_EQ(nodes[0].child, 1);
    EXPECT_EQ(nodes[1].leaf, 1);
    EXPECT_EQ(nodes[2].leaf, 0);
    EXPECT_EQ(forest_to_bytes(*forest), bytes);
}

TEST(ForestFile, RefusesDamageOtherVersionsAndOtherFiles) {
    const Buffer good = forest_to_bytes(test::random_forest(5, 4, 1, 3));
    const auto error_of = [](const Buffer& bytes) {
        const auto forest = forest_from_bytes(bytes, "x");
        return forest ? std::string("accepted") : forest.error().what;
    };
    for (std::size_t i = 0; i < good.size(); ++i) {
        Buffer bad = good;
        bad[i] ^= 0x10;
        EXPECT_NE(error_of(bad), "accepted") << i;
        EXPECT_NE(error_of({good.begin(), good.begin() + static_cast<std::ptrdiff_t>(i)}),
                  "accepted")
            << i;
    }
    Buffer later = good;
    later[8] = 2;
    put_checksum_right(later);
    EXPECT_EQ(error_of(later), "forest file of version 2");
    EXPECT_EQ(error_of({'P', 'N', 'G'}), "not a forest file");
    Buffer longer = good;
    longer.insert(longer.end() - 4, 0);
    put_checksum_right(longer);
    EXPECT_EQ(error_of(longer), "there is more after the forest's end");
}

TEST(ForestFile, MutationsNeverBreakTheParser) {
    const Buffer good = forest_to_bytes(test::random_forest(6, 5, 2, 7));
    test::Random random(6);
    int accepted = 0;
    for (int round = 0; round < 20000; ++round) {
        Buffer bytes = good;
        for (int change = random.integer(1, 3); change > 0; --change) {
            const auto at =
                static_cast<std::size_t>(random.integer(0, static_cast<int>(bytes.size()) - 1));
            const auto value = static_cast<std::uint8_t>(random.integer(0, 255));
            switch (random.integer(0, 4)) {
                case 0:
                    bytes.resize(at + 1);
                    break;
                case 1:
                    bytes.insert(bytes.begin() + static_cast<std::ptrdiff_t>(at), value);
                    break;
                case 2:
                    bytes[at] = 0xFF;
                    break;
                default:
                    bytes[at] = value;
            }
        }
        if (random.chance(0.9)) put_checksum_right(bytes);
        fuzz::forest(bytes);
        accepted += forest_from_bytes(bytes, "x").has_value() ? 1 : 0;
    }
    // Offsets and thresholds may hold anything: some changes must have come through.
    EXPECT_GT(accepted, 1000);
    EXPECT_LT(accepted, 15000);
}

// Written by another program from docs/forest.md.
TEST(ForestFile, SeedsOfTheFuzzersAreAccepted) {
    const std::string bytes = test::read_bytes("tests/data/fuzz/forest/splits");
    const auto forest =
        forest_from_bytes({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()}, "x");
    ASSERT_TRUE(forest.has_value()) << forest.error().to_string();
    EXPECT_EQ(forest->trees.at(0).nodes.at(1).feature.v[1], 2000);
    EXPECT_EQ(forest->trees.at(1).nodes.at(0).leaf, 0);
    EXPECT_TRUE(parse_pcl_tree(test::read_bytes("tests/data/fuzz/pcl_tree/two"), "x").has_value());
}

TEST(Forest, DefectsAreNamed) {
    const Forest good = test::random_forest(7, 4, 2, 3, 0);
    EXPECT_EQ(forest_defect(good), "");
    Forest bad = good;
    bad.trees[1].nodes[0].child = 2;
    EXPECT_EQ(forest_defect(bad), "tree 1 node 0 is out of order");
    bad = good;
    bad.trees[0].nodes.back().leaf = 200;
    EXPECT_NE(forest_defect(bad), "");
    bad = good;
    bad.trees[0].nodes.emplace_back().leaf = 0;
    EXPECT_EQ(forest_defect(bad), "tree 0 has nodes that no split leads to");
    bad = good;
    --*std::find_if(bad.distributions[3].begin(), bad.distributions[3].end(),
                    [](std::uint8_t v) { return v > 0; });
    EXPECT_EQ(forest_defect(bad), "distribution 3 does not add up");
    bad = good;
    bad.labels[0] = "two words";
    EXPECT_NE(forest_defect(bad), "");
    bad = good;
    bad.trees.clear();
    EXPECT_EQ(forest_defect(bad), "0 trees");
    bad = good;
    bad.trees[0].nodes = {ForestNode{{}, 0, -1, 0}, ForestNode{{}, 0, -1, 0}, ForestNode{{}, 0, 1}};
    EXPECT_EQ(forest_defect(bad), "tree 0 node 2 is out of order");
    EXPECT_EQ(tree_depth(good.trees[0]), 3);
}

TEST(Forest, QuantizedDistributionsSumTo255AndAreNearest) {
    test::Random random(8);
    for (int round = 0; round < 2000; ++round) {
        std::vector<std::uint64_t> counts(static_cast<std::size_t>(random.integer(1, 32)));
        for (auto& c : counts) c = random.bits() >> random.integer(20, 63);
        counts[0] += 1;
        const double total = std::accumulate(counts.begin(), counts.end(), 0.0);
        const auto row = quantized_distribution(counts.data(), static_cast<int>(counts.size()));
        EXPECT_EQ(std::accumulate(row.begin(), row.end(), 0), 255);
        for (std::size_t l = 0; l < counts.size(); ++l)
            EXPECT_LT(std::abs(row[l] - 255 * (static_cast<double>(counts[l]) / total)), 1.0);
    }
    const std::vector<std::uint64_t> even{1, 1};
    EXPECT_EQ(quantized_distribution(even.data(), 2)[0], 128);
}

}  // namespace
}  // namespace kino
