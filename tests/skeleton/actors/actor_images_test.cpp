#include "skeleton/actors/actor_images.h"

#include <gtest/gtest.h>

#include <array>
#include <set>
#include <thread>

#include "skeleton/actors/cached_images.h"
#include "skeleton/forest/body_part.h"

namespace kino {
namespace {

std::shared_ptr<const TrainingImages> make(const ActorImagesOptions& options) {
    auto images = ActorImages::create(options);
    EXPECT_TRUE(images);
    return std::move(*images);
}

bool same(const TrainingImage& a, const TrainingImage& b) {
    return a.depth_mm == b.depth_mm && a.label == b.label && a.focal_px == b.focal_px;
}

TEST(ActorImages, RefusesWhatMakesNoSense) {
    EXPECT_FALSE(ActorImages::create({.count = 0}));
    EXPECT_FALSE(ActorImages::create({.width = 100}));
    EXPECT_FALSE(ActorImages::create({.height = 0}));
    EXPECT_FALSE(ActorImages::create({.width = 4096}));
}

TEST(ActorImages, AreTheSameAtEveryCallInAnyOrder) {
    const auto images = make({.seed = 3, .count = 12}), again = make({.seed = 3, .count = 500});
    std::vector<TrainingImage> first(12);
    for (int i = 0; i < 12; ++i) ASSERT_TRUE(images->load(i, first[static_cast<std::size_t>(i)]));
    TrainingImage picture;
    for (int i = 11; i >= 0; --i) {
        ASSERT_TRUE(again->load(i, picture));
        EXPECT_TRUE(same(picture, first[static_cast<std::size_t>(i)])) << i;
    }
    for (std::size_t i = 1; i < first.size(); ++i) EXPECT_FALSE(same(first[i], first[0]));
}

// The shipped forest can be made again only from the pictures it was made from. Who changes the
// draws on purpose trains it anew and puts the new number here.
TEST(ActorImages, AreThoseOfTheShippedForest) {
    const auto images = make({.seed = 1, .count = 20000});
    std::uint64_t hash = 0xCBF29CE484222325u;  // FNV-1a of the numbers
    const auto add = [&](std::uint64_t v) { hash = (hash ^ v) * 0x100000001B3u; };
    TrainingImage picture;
    for (const std::int64_t i : {0, 1, 2, 3, 5, 8, 13, 999, 4711, 12345, 19999}) {
        ASSERT_TRUE(images->load(i, picture));
        for (const std::uint16_t v : picture.depth_mm.pixels()) add(v);
        for (const std::uint8_t v : picture.label.pixels()) add(v);
    }
    EXPECT_EQ(hash, 7248138081390383666u);
}

TEST(ActorImages, HeldOutOnesAreOthers) {
    const auto train = make({.seed = 3, .count = 6}),
               held = make({.seed = 3, .count = 6, .held_out = true}),
               other = make({.seed = 4, .count = 6});
    for (int i = 0; i < 6; ++i) {
        TrainingImage a, b, c;
        ASSERT_TRUE(train->load(i, a) && held->load(i, b) && other->load(i, c));
        EXPECT_FALSE(same(a, b));
        EXPECT_FALSE(same(a, c));
    }
}

TEST(ActorImages, HoldBodiesAndNothingElse) {
    const auto images = make({.seed = 8, .count = 150});
    const std::vector<std::string> labels = images->labels();
    ASSERT_EQ(labels.size(), static_cast<std::size_t>(kBodyPartCount));
    EXPECT_EQ(labels[0], "head");
    std::array<int, kBodyPartCount> pictures_with{};
    int near = 0, far = 0;
    TrainingImage picture;
    for (int i = 0; i < 150; ++i) {
        ASSERT_TRUE(images->load(i, picture));
        EXPECT_NEAR(picture.focal_px, 285.63, 0.01);
        ASSERT_EQ(picture.depth_mm.size(), picture.label.size());
        std::set<int> parts;
        int body = 0;
        double sum = 0;
        for (std::size_t k = 0; k < picture.label.size(); ++k) {
            const int label = picture.label.pixels()[k], mm = picture.depth_mm.pixels()[k];
            if (label == kNotBody) {
                ASSERT_EQ(mm, 0);
                continue;
            }
            ASSERT_LT(label, kBodyPartCount);
            ASSERT_GE(mm, 300);
            ASSERT_LE(mm, 6500);
            parts.insert(label);
            ++body;
            sum += mm;
        }
        EXPECT_GE(body, 250);
        near += sum / body < 1700;
        far += sum / body > 2700;
        for (const int p : parts) ++pictures_with[static_cast<std::size_t>(p)];
        // Cut to the body.
        const auto any = [&](int x0, int y0, int dx, int dy, int n) {
            for (int k = 0; k < n; ++k) {
                if (picture.label.at(x0 + k * dx, y0 + k * dy) != kNotBody) return true;
            }
            return false;
        };
        const int w = picture.label.width(), h = picture.label.height();
        EXPECT_TRUE(any(0, 0, 1, 0, w) && any(0, h - 1, 1, 0, w) && any(0, 0, 0, 1, h) &&
                    any(w - 1, 0, 0, 1, h));
    }
    for (const int n : pictures_with) EXPECT_GT(n, 45);
    EXPECT_GT(near, 20);
    EXPECT_GT(far, 20);
    // Neither side is favoured.
    const auto l = pictures_with[static_cast<std::size_t>(BodyPart::hand_left)],
               r = pictures_with[static_cast<std::size_t>(BodyPart::hand_right)];
    EXPECT_LT(std::abs(l - r), 35);
}

TEST(CachedImages, GivesBackWhatCameOnManyThreads) {
    const auto images = make({.seed = 5, .count = 24});
    const CachedImages cached(images);
    EXPECT_EQ(cached.count(), 24);
    EXPECT_EQ(cached.bytes(), 0u);
    std::array<int, 3> wrong{};
    std::vector<std::thread> threads;
    for (std::size_t t = 0; t < 3; ++t) {
        threads.emplace_back([&, t] {
            TrainingImage from, out;
            for (int k = 0; k < 36; ++k) {
                const int i = (k * 5 + static_cast<int>(t) * 7) % 24;
                wrong[t] += !cached.load(i, out) || !images->load(i, from) || !same(from, out);
            }
        });
    }
    for (std::thread& t : threads) t.join();
    for (const int w : wrong) EXPECT_EQ(w, 0);
    // 20,000 pictures have to fit in 3 GB.
    EXPECT_LT(cached.bytes() / 24, 75000u);
}

class Broken : public TrainingImages {
  public:
    [[nodiscard]] std::vector<std::string> labels() const override { return {"a"}; }
    [[nodiscard]] std::int64_t count() const override { return 1; }
    [[nodiscard]] Result<void> load(std::int64_t, TrainingImage&) const override {
        return fail("no picture", "here");
    }
};

TEST(CachedImages, PassesErrorsOnEveryTime) {
    const CachedImages cached(std::make_shared<Broken>());
    TrainingImage out;
    for (int i = 0; i < 2; ++i) {
        const auto loaded = cached.load(0, out);
        ASSERT_FALSE(loaded);
        EXPECT_EQ(loaded.error().what, "no picture");
    }
}

}  // namespace
}  // namespace kino
