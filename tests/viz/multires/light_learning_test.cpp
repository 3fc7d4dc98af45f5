#include "viz/frame/learning/light_learning.h"

#include <gmock/gmock.h>

#include <cmath>

#include "tests/support/random.h"
#include "tests/viz/multires/fuzz/light_table_target.h"
#include "tests/viz/multires/stage_rig.h"
#include "tests/viz/viz_fixture.h"

namespace kino::test {
namespace {

LightTable random_light(Random& random) {
    LightTable table{.reconstruction_ns = random.real(5, 30),
                     .other_ns = random.real(5, 100),
                     .width = 640,
                     .height = 360,
                     .poses = 4};
    for (const std::uint32_t part : {kShadowedLights, kPlainLights, kBouncedLights}) {
        table.parts.push_back({.name = light_part_name(part),
                               .cost_ns = std::pow(10, random.real(0.5, 2.7)),
                               .error = std::pow(10, random.real(-1, 1)),
                               .exponent = random.real(0.5, 3)});
    }
    return table;
}

/// The best of all nested factors, one by one.
LodPlan best_of_all(const LightTable& table, double budget) {
    LodPlan best;
    for (double first = 1.25; first <= 4; first += 0.25) {
        std::vector<double> levels = {1};
        for (double r = first; r <= 8; r *= 2) levels.push_back(r);
        for (const double a : levels) {
            for (const double b : levels) {
                for (const double c : levels) {
                    const LodPlan plan = price_lod_plan(table.parts, {a, b, c}, budget,
                                                        table.reconstruction_ns, LodChain::nested);
                    if (!plan.within_budget) continue;
                    if (!best.within_budget || plan.error < best.error) best = plan;
                }
            }
        }
    }
    return best;
}

TEST(LightTable, TheChoiceIsThatOfExhaustiveSearch) {
    Random random(31);
    int same = 0;
    int solvable = 0;
    for (int round = 0; round < 60; ++round) {
        const LightTable table = random_light(random);
        double all = 0;
        for (const LodComponent& part : table.parts) all += part.cost_ns;
        const double budget = random.real(0.15, 0.9) * all;
        const LightChoice choice = choose_rates(table, budget);
        const LodPlan best = best_of_all(table, budget);
        ASSERT_EQ(choice.plan.within_budget, best.within_budget) << round;
        EXPECT_EQ(choice.rates.shadowed, choice.plan.r[0]);
        EXPECT_EQ(choice.rates.plain, choice.plan.r[1]);
        EXPECT_EQ(choice.rates.bounced, choice.plan.r[2]);
        if (!best.within_budget) continue;
        ++solvable;
        EXPECT_LE(choice.plan.cost_ns, budget);
        EXPECT_LE(choice.plan.error, 1.1 * best.error) << round;
        same += choice.plan.error <= best.error * (1 + 1e-12);
        // What was chosen is what the stage makes of it.
        const auto levels = light_levels(choice.rates, kAllLights, 1);
        for (const LightLevel& level : levels) {
            for (int k = 0; k < 3; ++k) {
                if ((level.parts >> k & 1) != 0) {
                    EXPECT_NEAR(level.r, choice.plan.r[static_cast<std::size_t>(k)], 1e-9);
                }
            }
        }
    }
    EXPECT_GT(solvable, 40);
    EXPECT_GE(same, 0.9 * solvable);
}

TEST(LightTable, SurvivesItsFile) {
    Random random(7);
    for (int round = 0; round < 20; ++round) {
        LightTable table = random_light(random);
        table.parts.resize(static_cast<std::size_t>(random.integer(0, 3)));
        const auto again = light_table_from_json(light_table_to_json(table), "test");
        ASSERT_TRUE(again) << again.error().to_string();
        EXPECT_EQ(*again, table);
    }
}

TEST(LightTable, RefusesWhatIsNone) {
    const std::string good =
        light_table_to_json({.parts = {{.name = "plain", .cost_ns = 1, .error = 1}},
                             .width = 4,
                             .height = 4,
                             .poses = 1});
    const auto with = [&](const std::string& what, const std::string& by) {
        std::string text = good;
        const auto at = text.find(what);
        EXPECT_NE(at, std::string::npos) << what;
        return text.replace(at, what.size(), by);
    };
    for (const std::string& bad :
         {std::string("[]"), std::string("{"), with("\"plain\"", "\"sun\""), with("\"plain\"", "3"),
          with("\"cost_ns\": 1", "\"cost_ns\": -1"), with("\"poses\": 1", "\"poses\": 0"),
          with("\"exponent\": 2", "\"exponent\": 1e999"), with("table\": 1", "table\": 2")}) {
        const auto read = light_table_from_json(bad, "a.json");
        ASSERT_FALSE(read) << bad;
        EXPECT_THAT(read.error().to_string(), testing::HasSubstr("a.json"));
    }
    // Seeded mutations, as the fuzzer makes them.
    Random random(99);
    for (int round = 0; round < 2000; ++round) {
        std::string text = good;
        for (int k = random.integer(1, 4); k > 0; --k) {
            const auto at =
                static_cast<std::size_t>(random.integer(0, static_cast<int>(text.size()) - 1));
            text[at] = static_cast<char>(random.integer(1, 255));
        }
        fuzz::light_table({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
    }
}

// The table of a scene whose parts differ: what is learned is what there is, and its choice loses
// less than one factor for all within the same priced budget.
TEST_F(VizTest, AScenesLightIsLearned) {
    Renderer renderer(device());
    const Scene scene = parts_scene();
    LightLearning learning({.r = {2, 4}, .repeats = 1});
    EXPECT_TRUE(learning.table().parts.empty());
    FrameOptions frame;
    frame.ray_shadows.half_resolution = false;
    ASSERT_TRUE(learning.add(renderer, scene, parts_view(), frame));
    const LightTable table = learning.table();
    ASSERT_EQ(table.parts.size(), 3u);
    EXPECT_EQ(table.poses, 1);
    EXPECT_GT(table.reconstruction_ns, 0);
    for (const LodComponent& part : table.parts) EXPECT_GT(part.error, 0) << part.name;
    // Shadows' edges are sharper than bounced light.
    EXPECT_GT(table.parts[0].error * std::pow(4, table.parts[0].exponent),
              2 * table.parts[2].error * std::pow(4, table.parts[2].exponent));
    // A scene without a part learns nothing of it.
    Scene plain = scene;
    for (Light& light : plain.lights) light.indirect = false;
    std::erase_if(plain.lights,
                  [](const Light& light) { return light.shadow == LightShadow::raycast; });
    LightLearning other({.r = {2}, .repeats = 1});
    ASSERT_TRUE(other.add(renderer, plain, parts_view(), frame));
    ASSERT_EQ(other.table().parts.size(), 1u);
    EXPECT_EQ(other.table().parts[0].name, "plain");
    // Without a stage there is nothing to learn.
    EXPECT_FALSE(other.add(renderer, Scene{}, parts_view(), frame));
}

}  // namespace
}  // namespace kino::test
