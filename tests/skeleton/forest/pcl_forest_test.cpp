#include "skeleton/forest/pcl_forest.h"

#include <gtest/gtest.h>

#include <sstream>

#include "forest_samples.h"
#include "fuzz/forest_targets.h"
#include "tests/support/temp_dir.h"

namespace kino {
namespace {

struct TextTree {
    int depth = 0;
    std::vector<std::array<int, 5>> nodes;
    std::vector<int> labels;
    std::string text;
};

TextTree random_text_tree(std::uint64_t seed, int depth, int labels) {
    test::Random random(seed);
    TextTree out;
    out.depth = depth;
    std::ostringstream text;
    text << depth << '\n';
    for (int i = 0; i < (1 << depth) - 1; ++i) {
        auto& node = out.nodes.emplace_back();
        for (std::size_t k = 0; k < 5; ++k) {
            node[k] = random.integer(-395, 395);
            text << "  " << node[k];
        }
        text << '\n';
    }
    for (int i = 0; i < 1 << depth; ++i) {
        out.labels.push_back(random.integer(0, labels - 1));
        text << out.labels.back() << '\n';
    }
    out.text = text.str();
    return out;
}

TEST(PclForest, EveryPathLeadsToTheSameLabelAsTheCompleteTree) {
    for (const int labels : {1, 2, 25}) {
        const TextTree text = random_text_tree(static_cast<std::uint64_t>(labels), 7, labels);
        const auto tree = parse_pcl_tree(text.text, "x");
        ASSERT_TRUE(tree.has_value()) << tree.error().to_string();
        EXPECT_EQ(forest_defect(pcl_forest({*tree})), "");
        EXPECT_EQ(tree->nodes.size() == 1, labels == 1);
        for (int path = 0; path < 1 << 7; ++path) {
            std::size_t complete = 0, ours = 0;
            for (int level = 0; level < 7; ++level) {
                const int right = path >> level & 1;
                const ForestNode& n = tree->nodes[ours];
                if (!n.is_leaf()) {
                    const auto& want = text.nodes[complete];
                    ASSERT_EQ(n.feature.u[0], 4 * want[0]);
                    ASSERT_EQ(n.feature.u[1], 4 * want[1]);
                    ASSERT_EQ(n.feature.v[0], 4 * want[2]);
                    ASSERT_EQ(n.feature.v[1], 4 * want[3]);
                    ASSERT_EQ(n.threshold_mm, want[4]);
                    ours = static_cast<std::size_t>(n.child + right);
                }
                complete = 2 * complete + 1 + static_cast<std::size_t>(right);
            }
            ASSERT_TRUE(tree->nodes[ours].is_leaf());
            EXPECT_EQ(tree->nodes[ours].leaf, text.labels[complete - 127]);
        }
    }
}

// A person of two halves: what is right of the pixel decides, and the sign of the threshold.
TEST(PclForest, GoesRightWhereTheDifferenceIsGreater) {
    const auto tree = parse_pcl_tree("1\n 100 0 0 0 50\n 3 7\n", "x");
    ASSERT_TRUE(tree.has_value());
    const PartLabeller labeller(pcl_forest({*tree}));
    Image<std::uint16_t> depth(40, 3, 1000);
    const Image<std::uint8_t> body(40, 3, 1);
    BodyDepth cut;
    cut.set(std::as_const(depth).view(), body.view(), 1, 100);  // 100 mm are 10 px
    PartLabels labels;
    labeller.label(cut, labels);
    for (std::size_t i = 0; i < cut.count(); ++i)
        EXPECT_EQ(labels.label[i], cut.x(i) + 10 > 39 ? 7 : 3) << cut.x(i);
    cut.set(std::as_const(depth).view(), body.view(), 1, 180);
    labeller.label(cut, labels);
    for (std::size_t i = 0; i < cut.count(); ++i)
        EXPECT_EQ(labels.label[i], cut.x(i) + 18 > 39 ? 7 : 3) << cut.x(i);
}

TEST(PclForest, RefusesWhatIsNotATree) {
    const auto error_of = [](std::string_view text) {
        const auto tree = parse_pcl_tree(text, "x");
        return tree ? std::string("accepted") : tree.error().what;
    };
    EXPECT_EQ(error_of("1 1 2 3 4 5 0 24"), "accepted");
    EXPECT_EQ(error_of(""), "not a tree of PCL: no depth of 1..20 at its start");
    EXPECT_EQ(error_of("21 1"), "not a tree of PCL: no depth of 1..20 at its start");
    EXPECT_EQ(error_of("20 1 2 3"), "too short for a tree of depth 20");
    EXPECT_EQ(error_of("1 1 2 3 x 5 0 24"), "node 0 is not five numbers in range");
    EXPECT_EQ(error_of("1 1 2 3 9000 5 0 24"), "node 0 is not five numbers in range");
    EXPECT_EQ(error_of("1 1 2 3 4 5 0 25"), "leaf 1 has no label of 0..24");
    EXPECT_EQ(error_of("1 1 2 3 4 5 0 24 0"), "there is more after the last label");
}

// Three pixels in a row. The trees disagree about the middle one; what is near it in depth decides,
// and what is not has no say.
TEST(PclForest, TiesAreSettledByThePixelsAround) {
    Image<std::uint16_t> depth(3, 1);
    Image<std::uint8_t> mask(3, 1, 1);
    const auto settled = [&](std::uint16_t left, std::uint16_t right) {
        depth.at(0, 0) = left;
        depth.at(1, 0) = 1000;
        depth.at(2, 0) = right;
        BodyDepth body;
        body.set(std::as_const(depth).view(), std::as_const(mask).view(), 1, 500);
        PartLabels labels;
        labels.label = {7, 5, 6};
        labels.votes = {765, 255, 765};
        labels.leaf = {{7, 5, 6}, {7, 6, 6}, {7, 7, 6}};
        settle_pcl_ties(body, labels);
        EXPECT_EQ(labels.label[0], 7);
        EXPECT_EQ(labels.label[2], 6);
        return static_cast<int>(labels.label[1]);
    };
    EXPECT_EQ(settled(1049, 1050), 7);
    EXPECT_EQ(settled(950, 951), 6);
    EXPECT_EQ(settled(1049, 1049), 6);  // again equal: the lowest
    EXPECT_EQ(settled(1050, 950), 5);
}

TEST(PclForest, ReadsFiles) {
    const test::TempDir dir;
    const std::vector<std::filesystem::path> paths{dir.write("a", "1 1 2 3 4 5 0 24"),
                                                   dir.write("b", random_text_tree(3, 4, 25).text)};
    const auto forest = read_pcl_forest(paths);
    ASSERT_TRUE(forest.has_value());
    EXPECT_EQ(forest->trees.size(), 2u);
    EXPECT_EQ(forest->labels.at(18), "left_hand");
    EXPECT_FALSE(read_pcl_forest({}).has_value());
    const std::vector<std::filesystem::path> missing{dir / "none"};
    EXPECT_FALSE(read_pcl_forest(missing).has_value());
}

TEST(PclForest, MutationsNeverBreakTheParser) {
    const std::string good = random_text_tree(4, 3, 25).text;
    test::Random random(5);
    int accepted = 0;
    for (int round = 0; round < 20000; ++round) {
        std::string text = good;
        const auto place = [&] {
            return static_cast<std::size_t>(random.integer(0, static_cast<int>(text.size()) - 1));
        };
        constexpr std::string_view kBytes = "0123456789- \n\tx.\0\xff";
        for (int change = random.integer(1, 3); change > 0; --change) {
            const char byte = kBytes[static_cast<std::size_t>(
                random.integer(0, static_cast<int>(kBytes.size()) - 1))];
            if (random.chance(0.1))
                text.resize(place() + 1);
            else if (random.chance(0.3))
                text.insert(place(), 1, byte);
            else
                text[place()] = byte;
        }
        fuzz::pcl_tree({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
        accepted += parse_pcl_tree(text, "x").has_value() ? 1 : 0;
    }
    EXPECT_GT(accepted, 1000);
    EXPECT_LT(accepted, 19000);
}

}  // namespace
}  // namespace kino
