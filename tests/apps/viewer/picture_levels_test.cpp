#include "apps/viewer/picture_levels.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace kino {
namespace {

struct Row {
    std::string name, knob, level, metric;
    double error = 0;
};

std::vector<Row> committed(const char* table) {
    std::ifstream file(std::string("docs/accuracy/") + table);
    std::vector<Row> rows;
    for (std::string line; std::getline(file, line);) {
        std::vector<std::string> fields(1);
        bool quoted = false;
        for (const char c : line) {
            if (c == '"') {
                quoted = !quoted;
            } else if (c == ',' && !quoted) {
                fields.emplace_back();
            } else {
                fields.back() += c;
            }
        }
        if (fields.size() < 8 || fields[7].find("mean FLIP") != 0) continue;
        rows.push_back({fields[1], fields[2], fields[3], fields[7], std::stod(fields[6])});
    }
    return rows;
}

constexpr const char* kWorst = "mean FLIP, worst of the script";

/// The mean FLIP of the worst scene, by way and r.
std::map<std::pair<Reconstruction, double>, double> worst_of_light() {
    std::map<std::pair<Reconstruction, double>, double> worst;
    const auto add = [&](Reconstruction way, const Row& row) {
        double& most = worst[{way, std::stod(row.level)}];
        most = std::max(most, row.error);
    };
    for (const Row& row : committed("framebuffer-lod.csv")) {
        if (row.knob != "r") continue;
        if (row.name.find(", bilinear") != std::string::npos) add(Reconstruction::bilinear, row);
        if (row.name.find(", fine-grained") != std::string::npos) {
            add(Reconstruction::geometry_aware, row);
        }
    }
    for (const Row& row : committed("governor.csv")) {
        if (row.metric != kWorst) continue;
        if (row.knob == "r") add(Reconstruction::geometry_aware, row);
        if (row.knob == "r, bilinear") add(Reconstruction::bilinear, row);
    }
    return worst;
}

std::map<int, double> worst_of_zoom() {
    std::map<int, double> worst;
    const auto add = [&](const Row& row) {
        double& most = worst[std::stoi(row.level)];
        most = std::max(most, row.error);
    };
    for (const Row& row : committed("zoom.csv")) {
        if (row.knob == "z" && row.name.find("blurred") == std::string::npos) add(row);
    }
    for (const Row& row : committed("governor.csv")) {
        if (row.knob == "z" && row.metric == kWorst) add(row);
    }
    return worst;
}

/// An estimate holds if nothing committed loses more; and it is no mere bound.
void expect_holds(double estimate, double worst, const std::string& what) {
    EXPECT_GE(estimate, 0.995 * worst) << what;
    EXPECT_LE(estimate, 1.25 * worst + 0.001) << what;
}

TEST(PictureLevels, ErrorsAreThoseOfTheWorstCommittedScene) {
    const auto light = worst_of_light();
    ASSERT_GE(light.size(), 14u);
    for (const auto& [key, most] : light) {
        const bool bilinear = key.first == Reconstruction::bilinear;
        expect_holds(lod_error(key.second, key.first), most,
                     (bilinear ? "bilinear " : "guided ") + std::to_string(key.second));
    }
    const auto zoom = worst_of_zoom();
    ASSERT_GE(zoom.size(), 3u);
    // Coarser is taken to be no better, even where it was measured to be.
    double most_so_far = 0;
    for (const auto& [z, most] : zoom) {
        most_so_far = std::max(most_so_far, most);
        expect_holds(zoom_error(z), most_so_far, "z = " + std::to_string(z));
    }
}

TEST(PictureLevels, ErrorsOfLightAndZoomTogetherHold) {
    int compared = 0;
    for (const Row& row : committed("governor.csv")) {
        if (row.knob != "r, z" || row.metric != kWorst) continue;
        const double r = std::stod(row.level);
        const int z = std::stoi(row.level.substr(row.level.find(' ')));
        const double estimate = picture_error({.lod = r, .zoom = z});
        EXPECT_GE(estimate, row.error) << row.level;
        EXPECT_LE(estimate, 1.3 * row.error) << row.level;
        ++compared;
    }
    EXPECT_GE(compared, 3);
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
    for (int z = 2; z <= 12; ++z) EXPECT_GE(zoom_error(z), zoom_error(z - 1));
    EXPECT_GT(zoom_error(2), 0);
    EXPECT_GT(picture_error({.lod = 2, .zoom = 2}), picture_error({.lod = 1, .zoom = 2}));
    EXPECT_EQ(picture_error({}), 0);
}

TEST(PictureLevels, AreBestFirstAndNamedApart) {
    const auto levels = picture_levels(true, 2);
    ASSERT_EQ(levels.size(), 50u);
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
    EXPECT_EQ(picture_levels(true, 1).size(), 25u);
    const PictureShare share = share_of({.lod = 2, .zoom = 2}, {1280, 720});
    EXPECT_DOUBLE_EQ(share.drawn, 0.25);
    EXPECT_DOUBLE_EQ(share.shaded, 0.0625);
}

}  // namespace
}  // namespace kino
