#include "apps/viewer/picture_levels.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <utility>

namespace kino {
namespace {

/// The mean FLIP of the worst scene of the committed table, by way and r.
std::map<std::pair<std::string, double>, double> committed_errors() {
    std::ifstream file("docs/accuracy/framebuffer-lod.csv");
    std::map<std::pair<std::string, double>, double> worst;
    for (std::string line; std::getline(file, line);) {
        if (line.find(",mean FLIP,") == std::string::npos) continue;
        const auto quote = line.find('"');
        const auto end = line.find('"', quote + 1);
        const std::string name = line.substr(quote + 1, end - quote - 1);
        std::istringstream rest(line.substr(end + 2));
        std::string knob, level, median, p95, error;
        for (std::string* field : {&knob, &level, &median, &p95, &error}) {
            std::getline(rest, *field, ',');
        }
        double& most = worst[{name.substr(name.find(", ") + 2), std::stod(level)}];
        most = std::max(most, std::stod(error));
    }
    return worst;
}

TEST(PictureLevels, ErrorsAreThoseOfTheCommittedTable) {
    const auto worst = committed_errors();
    ASSERT_GE(worst.size(), 21u);
    for (const auto& [key, most] : worst) {
        if (key.first == "geometry-aware") continue;
        const auto way =
            key.first == "bilinear" ? Reconstruction::bilinear : Reconstruction::geometry_aware;
        EXPECT_NEAR(lod_error(key.second, way), most, 0.01 * most) << key.first << key.second;
    }
}

TEST(PictureLevels, CoarserIsNeverBetter) {
    for (const auto way : {Reconstruction::geometry_aware, Reconstruction::bilinear}) {
        double before = 0;
        for (double r = 1; r < 12; r += 0.05) {
            const double error = lod_error(r, way);
            EXPECT_GE(error, before) << r;
            before = error;
        }
        EXPECT_EQ(lod_error(1, way), 0);
    }
    EXPECT_EQ(zoom_error(1), 0);
    EXPECT_GT(zoom_error(3), zoom_error(2));
    EXPECT_GT(zoom_error(2), 0);
}

TEST(PictureLevels, AreBestFirstAndNamedApart) {
    const auto levels = picture_levels(true, 2);
    ASSERT_EQ(levels.size(), 34u);
    EXPECT_EQ(levels.front().name(), "full");
    for (std::size_t i = 0; i < levels.size(); ++i) {
        EXPECT_LE(levels[std::max<std::size_t>(1, i) - 1].error, levels[i].error);
        for (std::size_t j = 0; j < i; ++j) EXPECT_NE(levels[i].name(), levels[j].name());
        const PictureShare share = share_of(levels[i], {1280, 720});
        EXPECT_LE(share.shaded, share.drawn);
        EXPECT_GT(share.shaded, 0);
    }
    EXPECT_EQ(picture_levels(false, 2).size(), 2u);
    EXPECT_EQ(picture_levels(false, 0).size(), 1u);
    EXPECT_EQ(picture_levels(true, 1).size(), 17u);
    const PictureShare share = share_of({.lod = 2, .zoom = 2}, {1280, 720});
    EXPECT_DOUBLE_EQ(share.drawn, 0.25);
    EXPECT_DOUBLE_EQ(share.shaded, 0.0625);
}

}  // namespace
}  // namespace kino
