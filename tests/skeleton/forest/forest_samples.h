#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "base/image.h"
#include "skeleton/forest/forest.h"
#include "tests/support/random.h"

/// Forests and bodies made of random numbers.
namespace kino::test {

inline ForestFeature random_feature(Random& random, int reach) {
    ForestFeature f;
    for (auto* o : {&f.u, &f.v})
        for (std::int16_t& c : *o) c = static_cast<std::int16_t>(random.integer(-reach, reach));
    return f;
}

/// A tree whose leaves lie at different depths, up to `depth`.
inline ForestTree random_tree(Random& random, int depth, int distributions, double stop,
                              int reach = 2000) {
    std::vector<ForestNode> nodes(1);
    std::vector<int> level{0};
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        if (level[i] == depth || (level[i] > 0 && random.chance(stop))) {
            nodes[i].leaf = random.integer(0, distributions - 1);
            continue;
        }
        nodes[i].feature = random_feature(random, reach);
        nodes[i].threshold_mm = static_cast<std::int16_t>(random.integer(-150, 150));
        nodes[i].child = static_cast<std::int32_t>(nodes.size());
        nodes.resize(nodes.size() + 2);
        level.resize(nodes.size(), level[i] + 1);
    }
    return {nodes};
}

inline Forest random_forest(std::uint64_t seed, int labels, int trees, int depth,
                            double stop = 0.05) {
    Random random(seed);
    Forest forest;
    for (int l = 0; l < labels; ++l) forest.labels.push_back("label_" + std::to_string(l));
    for (int d = 0; d < 200; ++d) {
        std::vector<std::uint64_t> counts;
        for (int l = 0; l < labels; ++l)
            counts.push_back(random.chance(0.3) ? static_cast<std::uint64_t>(random.integer(0, 99))
                                                : 0);
        ++counts[static_cast<std::size_t>(random.integer(0, labels - 1))];
        forest.distributions.push_back(quantized_distribution(counts.data(), labels));
    }
    for (int t = 0; t < trees; ++t) forest.trees.push_back(random_tree(random, depth, 200, stop));
    forest.note = "random";
    return forest;
}

struct BodyPicture {
    Image<std::uint16_t> depth_mm;
    Image<std::uint8_t> body;  ///< 0 nobody, 1 and 2 two people
};

/// Balls of two people before a wall, with noise and holes; they may be cut by the border.
inline BodyPicture random_bodies(std::uint64_t seed, int width, int height) {
    Random random(seed);
    BodyPicture out{Image<std::uint16_t>(width, height, 3800),
                    Image<std::uint8_t>(width, height, 0)};
    for (int ball = 0; ball < 14; ++ball) {
        const double cx = random.real(0, width), cy = random.real(0, height);
        const double r = random.real(0.05, 0.2) * height;
        const double z = random.real(700, 3500);
        const auto who = static_cast<std::uint8_t>(ball % 2 + 1);
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x) {
                const double d2 = (x - cx) * (x - cx) + (y - cy) * (y - cy);
                if (d2 > r * r) continue;
                const double bulge = 2 * std::sqrt(r * r - d2);
                out.depth_mm.at(x, y) =
                    static_cast<std::uint16_t>(z - bulge + random.real(-15, 15));
                out.body.at(x, y) = who;
            }
    }
    for (std::uint16_t& z : out.depth_mm.pixels())
        if (random.chance(0.02)) z = random.chance(0.5) ? 0 : 65535;
    return out;
}

}  // namespace kino::test
