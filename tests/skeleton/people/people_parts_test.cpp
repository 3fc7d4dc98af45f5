#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <numeric>

#include "skeleton/people/assignment.h"
#include "skeleton/people/background.h"
#include "skeleton/people/components.h"
#include "tests/skeleton/people/people_play.h"
#include "tests/support/random.h"

namespace kino {
namespace {

using namespace test;

// Breadth first from each cell that has no number yet, all neighbours asked anew.
Image<std::int32_t> slow_components(const Image<float>& z, const Image<std::uint8_t>& mask,
                                    const SurfaceStep& step) {
    Image<std::int32_t> labels(z.width(), z.height(), 0);
    std::int32_t count = 0;
    for (int y = 0; y < z.height(); ++y) {
        for (int x = 0; x < z.width(); ++x) {
            if (!mask.at(x, y) || labels.at(x, y)) continue;
            std::deque<std::pair<int, int>> open{{x, y}};
            labels.at(x, y) = ++count;
            while (!open.empty()) {
                const auto [cx, cy] = open.front();
                open.pop_front();
                for (const auto& [dx, dy] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
                    int nx = cx + dx, ny = cy + dy;
                    if (!z.contains(nx, ny)) continue;
                    if (z.at(nx, ny) == 0) {
                        nx += dx;
                        ny += dy;
                    }
                    if (!z.contains(nx, ny) || !mask.at(nx, ny) || labels.at(nx, ny)) continue;
                    if (std::abs(z.at(nx, ny) - z.at(cx, cy)) >
                        step.base_m + step.slope * std::min(z.at(nx, ny), z.at(cx, cy)) +
                            step.noise_per_m * std::pow(std::min(z.at(nx, ny), z.at(cx, cy)), 2)) {
                        continue;
                    }
                    labels.at(nx, ny) = count;
                    open.push_back({nx, ny});
                }
            }
        }
    }
    return labels;
}

TEST(Components, AreThoseOfASlowSearch) {
    Random random(3);
    Components fast;
    for (int round = 0; round < 200; ++round) {
        const int width = random.integer(1, 40), height = random.integer(1, 30);
        Image<float> z(width, height, 0.0f);
        Image<std::uint8_t> mask(width, height, 0);
        const double holes = random.real(0, 0.5), out = random.real(0, 0.4);
        // Multiples of an eighth: sums and thresholds are exact in both ways of writing them.
        const int levels = random.integer(1, 12);
        for (std::size_t i = 0; i < z.size(); ++i) {
            if (random.chance(holes)) continue;
            z.data()[i] = 1 + 0.125f * static_cast<float>(random.integer(0, levels));
            mask.data()[i] = !random.chance(out);
        }
        const SurfaceStep step{0.0625f, 0.0625f, round % 2 ? 0.0625f : 0.0f};
        fast.find(z, mask, step);
        const Image<std::int32_t> slow = slow_components(z, mask, step);
        ASSERT_EQ(fast.labels(), slow) << round;
        EXPECT_EQ(fast.count(), *std::max_element(slow.pixels().begin(), slow.pixels().end()));
    }
}

// Every way to pair: the most pairs first, then the least sum.
std::pair<int, double> best_by_trying(const std::vector<double>& cost, int rows, int columns) {
    std::vector<int> order(static_cast<std::size_t>(columns + rows));
    std::iota(order.begin(), order.end(), 0);
    std::pair<int, double> best{0, 0.0};
    const auto try_rows = [&](auto&& self, int row, std::vector<char>& used, int pairs,
                              double sum) -> void {
        if (row == rows) {
            if (pairs > best.first || (pairs == best.first && sum < best.second)) {
                best = {pairs, sum};
            }
            return;
        }
        self(self, row + 1, used, pairs, sum);
        for (int c = 0; c < columns; ++c) {
            const double price = cost[static_cast<std::size_t>(row * columns + c)];
            if (used[static_cast<std::size_t>(c)] || price >= kNoPair) continue;
            used[static_cast<std::size_t>(c)] = 1;
            self(self, row + 1, used, pairs + 1, sum + price);
            used[static_cast<std::size_t>(c)] = 0;
        }
    };
    std::vector<char> used(static_cast<std::size_t>(columns), 0);
    try_rows(try_rows, 0, used, 0, 0.0);
    return best;
}

TEST(Assignment, IsTheBestOfAllPairings) {
    Random random(17);
    for (int round = 0; round < 300; ++round) {
        const int rows = random.integer(0, 6), columns = random.integer(0, 5);
        std::vector<double> cost;
        for (int i = 0; i < rows * columns; ++i) {
            cost.push_back(random.chance(0.35) ? kNoPair : random.integer(0, 20) * 0.25);
        }
        const std::vector<int> got = assign(cost, rows, columns);
        ASSERT_EQ(got.size(), static_cast<std::size_t>(rows));
        int pairs = 0;
        double sum = 0;
        std::vector<int> seen;
        for (int r = 0; r < rows; ++r) {
            const int c = got[static_cast<std::size_t>(r)];
            if (c < 0) continue;
            ++pairs;
            sum += cost[static_cast<std::size_t>(r * columns + c)];
            EXPECT_EQ(std::count(seen.begin(), seen.end(), c), 0);
            seen.push_back(c);
        }
        auto best = best_by_trying(cost, rows, columns);
        EXPECT_EQ(pairs, best.first) << round;
        if (pairs == 0) sum = best.second = 0;
        EXPECT_NEAR(sum, best.second, 1e-9) << round;
    }
}

struct OneCell {
    Background background{BackgroundOptions{}};
    TimeNs time = 0;
    OneCell() { background.reset(1, 1); }
    void see(float z, double seconds, bool person = false) {
        for (double t = 0; t < seconds - 1e-9; t += 0.1) {
            time += kNsPerSecond / 10;
            background.learn(Image<float>(1, 1, z), Image<std::uint8_t>(1, 1, person), time);
        }
    }
    [[nodiscard]] float depth() const { return background.depth_m(0); }
};

TEST(Background, IsTheFarthestStableDepth) {
    OneCell cell;
    cell.see(3.0f, 0.3);
    EXPECT_EQ(cell.depth(), 0);
    cell.see(3.0f, 0.5);
    EXPECT_FLOAT_EQ(cell.depth(), 3.0f);
    cell.see(2.0f, 5);  // somebody unknown: not yet
    EXPECT_FLOAT_EQ(cell.depth(), 3.0f);
    cell.see(4.0f, 1);  // what was taken for the wall has gone
    EXPECT_FLOAT_EQ(cell.depth(), 4.0f);
    cell.see(2.0f, 12);  // a chair was put there
    EXPECT_FLOAT_EQ(cell.depth(), 2.0f);
}

TEST(Background, NeverLearnsAPerson) {
    OneCell cell;
    cell.see(2.0f, 60, true);
    EXPECT_EQ(cell.depth(), 0);
    cell.see(3.0f, 1);
    cell.see(2.0f, 120, true);
    cell.see(2.95f, 30, true);
    EXPECT_FLOAT_EQ(cell.depth(), 3.0f);
}

TEST(Background, LimitGrowsWithTheNoise) {
    for (const float z : {1.0f, 2.0f, 4.0f}) {
        OneCell cell;
        cell.see(z, 1);
        EXPECT_NEAR(cell.background.limit_m(0), z - std::max(0.03f, 5 * 0.0017f * z * z), 1e-4f);
    }
}

TEST(Background, FollowsSlowChangesAndHolesTeachNothing) {
    OneCell cell;
    cell.see(3.0f, 1);
    for (int i = 0; i < 300; ++i) cell.see(3.0f + 0.001f * static_cast<float>(i), 0.1);
    EXPECT_NEAR(cell.depth(), 3.28f, 0.03f);
    const float before = cell.depth();
    cell.see(0.0f, 60);
    EXPECT_EQ(cell.depth(), before);
}

TEST(UprightAxes, AreARotationWithYUp) {
    Random random(9);
    for (int i = 0; i < 100; ++i) {
        const glm::vec3 up = glm::normalize(
            glm::vec3(random.real(-1, 1), random.real(-1, 1), random.real(-1, 1)) + 1e-3f);
        const glm::mat3 r = upright_from_camera(up);
        EXPECT_NEAR(glm::distance(r * up, glm::vec3(0, 1, 0)), 0, 1e-5f);
        EXPECT_NEAR(glm::determinant(r), 1, 1e-5f);
    }
    const glm::mat3 level = upright_from_camera({0, -1, 0});
    EXPECT_EQ(level * glm::vec3(1, 2, 3), glm::vec3(1, -2, -3));
}

TEST(Floor, IsTheTrueFloorUnderAnyTilt) {
    for (const double tilt : {-30.0, -12.0}) {
        for (const double roll : {-10.0, 0.0, 12.0}) {
            RoomOptions room;
            room.tilt_deg = tilt;
            room.roll_deg = roll;
            room.camera_height_m = 1.4;
            Play play(room);
            play.learn(8);
            const FloorPlane& floor = play.frame.floor;
            EXPECT_GT(floor.confidence, 0.3f) << tilt << " " << roll;
            const double angle =
                std::acos(std::min(1.0, static_cast<double>(glm::dot(floor.up, play.scene.up()))));
            EXPECT_LT(angle * 180 / M_PI, 0.5) << tilt << " " << roll;
            EXPECT_NEAR(floor.height_m, 1.4, 0.015) << tilt << " " << roll;
        }
    }
}

// A camera on its side sees a wall where the floor should be; the accelerometer knows better.
TEST(Floor, GravityKeepsAWallFromBeingTheFloor) {
    RoomOptions room;
    room.roll_deg = 80;
    room.tilt_deg = -10;
    PeopleScene scene(room);
    PeopleFinder finder = finder_for(scene);
    PeopleFrame frame;
    scene.draw({}, 1);
    finder.find(scene.depth_m(), 1, 9.8f * scene.up(), frame);
    ASSERT_TRUE(frame.floor.known());
    EXPECT_GT(glm::dot(frame.floor.up, scene.up()), std::cos(1.0 * M_PI / 180));
    EXPECT_NEAR(frame.floor.height_m, 1.05, 0.03);
}

TEST(Floor, NoneInViewIsSaid) {
    RoomOptions room;
    room.tilt_deg = 25;
    Play play(room);
    play.learn(5);
    EXPECT_FALSE(play.frame.floor.known());
    EXPECT_EQ(play.frame.floor.height_m, 0);
}

}  // namespace
}  // namespace kino
