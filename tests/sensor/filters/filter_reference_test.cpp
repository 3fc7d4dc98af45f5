#include <gtest/gtest.h>

#include <cstring>
#include <functional>

#include "sensor/filters/decimation_filter.h"
#include "sensor/filters/flying_pixel_filter.h"
#include "sensor/filters/hole_filter.h"
#include "sensor/filters/spatial_filter.h"
#include "sensor/filters/temporal_filter.h"
#include "tests/reference/depth_filters.h"
#include "tests/sensor/filters/depth_samples.h"

namespace kino {
namespace {

// Stated bound of fast against double: relative, at any depth in the samples.
constexpr double kBound = 2e-6;

bool matches(float fast, double exact) {
    return std::abs(fast - exact) <= kBound * exact;
}

// A pixel may take either decision where the difference is within rounding of the threshold.
void expect_one_of(const Image<float>& fast, const std::vector<Image<double>>& exact,
                   double allowed_ambiguous) {
    std::size_t ambiguous = 0;
    for (std::size_t i = 0; i < fast.size(); ++i) {
        const float z = fast.pixels()[i];
        bool good = false;
        bool differs = false;
        for (const auto& one : exact) {
            good = good || matches(z, one.pixels()[i]);
            differs =
                differs || !matches(static_cast<float>(one.pixels()[i]), exact.front().pixels()[i]);
        }
        ASSERT_TRUE(good) << "pixel " << i << ": " << z << " against " << exact.front().pixels()[i];
        ambiguous += differs ? 1 : 0;
    }
    EXPECT_LE(static_cast<double>(ambiguous),
              allowed_ambiguous * static_cast<double>(fast.size()) + 1);
}

template <class Check>
void on_all_samples(Check check) {
    std::uint64_t seed = 1;
    for (const test::Size size : test::kSizes) {
        for (const bool simd : {false, true}) {
            SCOPED_TRACE(testing::Message()
                         << size.width << "x" << size.height << (simd ? " simd" : " portable"));
            check(test::noisy_room(size.width, size.height, ++seed), simd);
            check(test::hostile_room(size.width, size.height, ++seed), simd);
            check(Image<float>(size.width, size.height, 0.0f), simd);
        }
    }
}

TEST(FilterReference, Spatial) {
    for (const int radius : {1, 2, 3, 4}) {
        const SpatialParameters p{.radius = radius, .sigmas = 1.5 + 2 * radius};
        on_all_samples([&](const Image<float>& in, bool simd) {
            const auto out = test::filtered(*test::make_filter<SpatialFilter>(p, simd), in);
            expect_one_of(out, {reference::spatial(in, p.radius, p.sigmas, p.noise_per_m)}, 0);
        });
    }
}

TEST(FilterReference, FlyingPixels) {
    for (const int support : {0, 2, 5, 8}) {
        const FlyingPixelParameters p{
            .steps = 2.5, .angle_deg = 70, .support = support, .focal_px = 500};
        on_all_samples([&](const Image<float>& in, bool simd) {
            const auto out = test::filtered(*test::make_filter<FlyingPixelFilter>(p, simd), in);
            const auto with = [&](double near) {
                return reference::flying_pixels(in, p.steps * near, p.angle_deg, support,
                                                p.focal_px / near);
            };
            expect_one_of(out, {with(1), with(1 - 1e-4), with(1 + 1e-4)}, 0.01);
        });
    }
}

TEST(FilterReference, Holes) {
    for (const int gap : {1, 3, 8, 250}) {
        for (const bool background : {true, false}) {
            const HoleParameters p{
                .gap = gap, .focal_px = 500, .edge = gap / 2, .background = background};
            on_all_samples([&](const Image<float>& in, bool simd) {
                const auto out = test::filtered(*test::make_filter<HoleFilter>(p, simd), in);
                const auto with = [&](double near) {
                    return reference::fill_holes(in, gap, p.steps * near, p.angle_deg,
                                                 p.focal_px / near, p.edge, background);
                };
                expect_one_of(out, {with(1), with(1 - 1e-4), with(1 + 1e-4)}, 0.01);
            });
        }
    }
}

TEST(FilterReference, Decimation) {
    for (const int factor : {1, 2, 3, 4, 8}) {
        for (const int readings : {1, 3}) {
            const DecimationParameters p{.factor = factor, .readings = readings};
            on_all_samples([&](const Image<float>& in, bool simd) {
                const auto out = test::filtered(*test::make_filter<DecimationFilter>(p, simd), in);
                const auto with = [&](double near) {
                    return reference::decimate(in, factor, p.steps * near, readings);
                };
                ASSERT_EQ(out.size(), with(1).size());
                expect_one_of(out, {with(1), with(1 - 1e-4), with(1 + 1e-4)}, 0.01);
            });
        }
    }
}

// A room whose seeds change from frame to frame: noise, jumps and holes everywhere.
TEST(FilterReference, Temporal) {
    std::vector<TemporalParameters> settings = {
        {}, {.alpha = 0}, {.alpha = 1}, {.alpha = 0.5, .persistence = 0}, {.persistence = 250}};
    settings.push_back(TemporalParameters::librealsense());
    for (const TemporalParameters& p : settings) {
        for (const bool hostile : {false, true}) {
            for (const bool simd : {false, true}) {
                const auto filter = test::make_filter<TemporalFilter>(p, simd);
                reference::Temporal exact({.alpha = p.alpha,
                                           .sigmas = p.sigmas,
                                           .noise = p.noise_per_m,
                                           .persistence = p.persistence,
                                           .running = p.running,
                                           .soft = p.soft});
                for (std::uint64_t frame = 0; frame < 9; ++frame) {
                    // Every third frame is another room.
                    Image<float> in = hostile
                                          ? test::hostile_room(83, 31, 100 + frame / 3)
                                          : test::noisy_room(83, 31, 200 + frame / 3, 0.0017, 0.02);
                    test::Random random(frame);
                    for (float& z : in.pixels()) {
                        if (random.chance(0.3)) z = 0;
                        z *= static_cast<float>(random.real(0.999, 1.001));
                    }
                    SCOPED_TRACE(testing::Message() << "frame " << frame << " alpha " << p.alpha);
                    expect_one_of(test::filtered(*filter, in), {exact.next(in)}, 0);
                }
            }
        }
    }
}

TEST(FilterTwins, GiveTheSameBits) {
    const auto twins = [](auto make) {
        for (const test::Size size : test::kSizes) {
            const auto fast = make(true);
            const auto portable = make(false);
            for (std::uint64_t seed = 0; seed < 4; ++seed) {
                const auto in = test::hostile_room(size.width, size.height, seed);
                ASSERT_TRUE(
                    test::same_bits(test::filtered(*fast, in), test::filtered(*portable, in)))
                    << fast->name() << " " << size.width << "x" << size.height;
            }
        }
    };
    twins([](bool simd) { return test::make_filter<SpatialFilter>(SpatialParameters{}, simd); });
    twins([](bool simd) {
        return test::make_filter<FlyingPixelFilter>(FlyingPixelParameters{}, simd);
    });
    for (const int factor : {1, 2, 3}) {
        twins([&](bool simd) {
            return test::make_filter<DecimationFilter>(
                DecimationParameters{.factor = factor, .readings = factor}, simd);
        });
    }
    twins([](bool simd) { return test::make_filter<HoleFilter>(HoleParameters{}, simd); });
    twins([](bool simd) { return test::make_filter<TemporalFilter>(TemporalParameters{}, simd); });
    twins([](bool simd) {
        return test::make_filter<TemporalFilter>(TemporalParameters::librealsense(), simd);
    });
}

}  // namespace
}  // namespace kino
