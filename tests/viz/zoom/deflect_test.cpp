#include "viz/quality/zoom/deflect.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <limits>
#include <random>
#include <utility>

#include "tests/reference/zoom_reference.h"
#include "viz/quality/zoom/zoom_view.h"

namespace kino {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr int kW = 160;
constexpr int kH = 96;

const WindowScreen kScreen{.size_m = {0.5, 0.3}};

View window_at(const glm::dvec3& eye) {
    return window_view(kScreen, eye, kW, kH);
}

/// The pixel of `view` that shows a world point.
glm::dvec2 pixel_of(const View& view, const glm::dvec3& world) {
    return project_to_pixel(view, world).value_or(glm::dvec2(kNaN));
}

Image<std::uint32_t> noise(int width, int height, unsigned seed) {
    std::mt19937 random(seed);
    Image<std::uint32_t> image(width, height);
    for (std::uint32_t& pixel : image.pixels()) pixel = static_cast<std::uint32_t>(random());
    return image;
}

TEST(Deflect, HomographyTakesThePlanesPointsFromViewToView) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> any(-1, 1);
    for (int i = 0; i < 300; ++i) {
        View from{.width = kW, .height = kH, .projection = perspective(0.9, kW, kH)};
        View to = from;
        to.projection.cx += 20 * any(random);
        to.world_from_view = {
            glm::angleAxis(0.3 * any(random),
                           glm::normalize(glm::dvec3(any(random), any(random), any(random)))),
            0.1 * glm::dvec3(any(random), any(random), any(random))};
        const double z = i % 5 == 0 ? 1e9 : 1 + std::abs(3 * any(random));
        const glm::dvec3 point =
            from.world_from_view * glm::dvec3(0.4 * z * any(random), 0.4 * z * any(random), z);
        const glm::dvec2 at = pixel_of(to, point);
        const glm::dvec3 mapped = plane_homography(to, from, 1 / z) * glm::dvec3(at, 1);
        EXPECT_LT(glm::distance(glm::dvec2(mapped) / mapped.z, pixel_of(from, point)), 1e-4);
    }
}

// The card: content at depth d behind a screen seen from D moves by d / (D + d) of what the eye
// moves, in px of the screen.
TEST(Deflect, PanIsTheCardsFormula) {
    const double away = 0.6, depth = 0.9;
    const View drawn = window_at({0.05, 0.02, away});
    for (const glm::dvec2 move : {glm::dvec2(0.05, 0), glm::dvec2(-0.02, 0.04)}) {
        const View shown = window_at({0.05 + move.x, 0.02 + move.y, away});
        const glm::ivec2 pan = pan_of(shown, drawn, 1 / (away + depth));
        // A point that is now here was there: against the move, y down.
        const double ratio = depth / (away + depth);
        EXPECT_NEAR(pan.x, -ratio * move.x / 0.5 * kW, 0.5 + 1e-9);
        EXPECT_NEAR(pan.y, ratio * move.y / 0.3 * kH, 0.5 + 1e-9);
    }
}

// Infinite depth: what is infinitely far moves with the eye, ratio 1; on the screen nothing moves.
TEST(Deflect, SkyMovesWithTheEyeAndTheScreenStays) {
    const View drawn = window_at({0, 0, 0.6});
    const View shown = window_at({0.1, 0, 0.6});
    EXPECT_EQ(pan_of(shown, drawn, 0).x, -std::lround(0.1 / 0.5 * kW));
    EXPECT_EQ(pan_of(shown, drawn, 1 / 0.6), glm::ivec2(0, 0));
    Image<float> depth(4, 3, 0.0f), inverse;
    EXPECT_EQ(invert_depths(std::as_const(depth).view(), 0.1, inverse), 0);
    depth.at(1, 1) = std::numeric_limits<float>::quiet_NaN();
    depth.at(2, 1) = std::numeric_limits<float>::infinity();
    EXPECT_EQ(invert_depths(std::as_const(depth).view(), 0.1, inverse), 0);
    // At the eye, and behind it: no nearer than the limit.
    depth.at(0, 0) = 1e-9f;
    depth.at(3, 2) = -1.0f;
    EXPECT_NEAR(invert_depths(std::as_const(depth).view(), 0.1, inverse), 10.0 / 12, 1e-6);
}

TEST(Deflect, MeanOfInverseDepthsLeavesNoWorseThanHalfTheParallax) {
    // d in 0..3 m, D = 0.6: ratios 0..0.83; a pan by the mid-range ratio halves the worst error.
    const double away = 0.6;
    const View drawn = window_at({0, 0, away});
    const View shown = window_at({0.06, 0, away});
    const double mid = 0.5 * (3 / (away + 3));
    const int pan = pan_of(shown, drawn, (1 - mid) / away).x;
    double worst = 0, worst_before = 0;
    for (double d = 0; d <= 3; d += 0.05) {
        const glm::dvec3 point(0.02, 0.01, -d);
        const double moved = pixel_of(shown, point).x - pixel_of(drawn, point).x;
        worst_before = std::max(worst_before, std::abs(moved));
        worst = std::max(worst, std::abs(moved + pan));
    }
    EXPECT_GT(worst_before, 10);
    EXPECT_LE(worst, 0.55 * worst_before);
}

TEST(Deflect, BilinearReadsWhereTheHomographySays) {
    const View full = window_at({0.02, 0.03, 0.6});
    const View shown = window_at({0.05, 0.01, 0.57});
    for (const int z : {1, 2, 3}) {
        const View small = zoomed_view(full, z, 6);
        const Image<std::uint32_t> picture = noise(small.width, small.height, 7);
        const double inverse_z = 1 / 1.3;
        Image<std::uint32_t> out(kW, kH);
        const auto outside =
            deflect({picture.view(), small, {}}, shown, inverse_z, true, out.view());
        const glm::dmat3 h = plane_homography(shown, small, inverse_z);
        double worst = 0;
        std::int64_t expected_outside = 0;
        for (int y = 0; y < kH; ++y) {
            for (int x = 0; x < kW; ++x) {
                const glm::dvec3 p = h * glm::dvec3(x, y, 1);
                const glm::dvec2 at{p.x / p.z, p.y / p.z};
                expected_outside += at.x < -0.5 || at.y < -0.5 || at.x >= small.width - 0.5 ||
                                    at.y >= small.height - 0.5;
                const auto i = static_cast<int>(std::floor(at.x));
                const auto j = static_cast<int>(std::floor(at.y));
                const auto pixel = [&](int a, int b) {
                    return reference::channel(picture.at(std::clamp(a, 0, small.width - 1),
                                                         std::clamp(b, 0, small.height - 1)),
                                              x % 4);
                };
                const double a = at.x - i, b = at.y - j;
                const double expected = (1 - b) * ((1 - a) * pixel(i, j) + a * pixel(i + 1, j)) +
                                        b * ((1 - a) * pixel(i, j + 1) + a * pixel(i + 1, j + 1));
                worst =
                    std::max(worst, std::abs(reference::channel(out.at(x, y), x % 4) - expected));
            }
        }
        // Noise has the steepest steps there are: 1/256 of a pixel either way, and two roundings.
        EXPECT_LE(worst, 3.5) << z;
        EXPECT_NEAR(static_cast<double>(outside), static_cast<double>(expected_outside), 2);
    }
}

/// Two planes: a near one on the left half of the screen, a far one behind all.
struct TwoPlanes {
    double near_z = 0.9, far_z = 2.6;  ///< from the eye's plane, for an eye at 0.6
    double edge = -0.02;               ///< world x where the near plane ends
    /// Colour and view depth of a view's pixel, by rays: black and white tells the planes apart,
    /// green and red where on them.
    [[nodiscard]] std::pair<std::uint32_t, double> seen(const View& view, double x,
                                                        double y) const {
        const Projection& k = view.projection;
        const glm::dvec3 eye = view.world_from_view.translation;
        const glm::dvec3 ray =
            view.world_from_view.rotation * glm::dvec3((x - k.cx) / k.fx, (y - k.cy) / k.fy, 1);
        for (const bool near : {true, false}) {
            const double plane = 0.6 - (near ? near_z : far_z);
            const double t = (plane - eye.z) / ray.z;
            const glm::dvec3 at = eye + t * ray;
            if (near && at.x > edge) continue;
            const auto wave = [](double v) {
                return static_cast<std::uint32_t>(std::lround(127 + 100 * std::sin(v)));
            };
            return {wave(14 * at.x) | wave(11 * at.y) << 8 | (near ? 0u : 200u) << 16, t};
        }
        return {0, 0};
    }
    [[nodiscard]] Image<std::uint32_t> picture(const View& view,
                                               Image<float>* depth = nullptr) const {
        Image<std::uint32_t> out(view.width, view.height);
        if (depth != nullptr) depth->resize(view.width, view.height);
        for (int y = 0; y < view.height; ++y) {
            for (int x = 0; x < view.width; ++x) {
                const auto [color, z] = seen(view, x, y);
                out.at(x, y) = color;
                if (depth != nullptr) depth->at(x, y) = static_cast<float>(z);
            }
        }
        return out;
    }
};

double mean_error(const Image<std::uint32_t>& a, const Image<std::uint32_t>& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        for (int c = 0; c < 3; ++c) {
            sum += std::abs(reference::channel(a.pixels()[i], c) -
                            reference::channel(b.pixels()[i], c));
        }
    }
    return sum / static_cast<double>(3 * a.size());
}

// Against pictures drawn at the new pose: each form is nearer to them than the cheaper one.
TEST(Deflect, EachFormIsNearerToThePictureDrawnThere) {
    const TwoPlanes planes;
    const View old = window_at({0, 0, 0.6});
    const int guard = 16;
    const View drawn = zoomed_view(old, 1, guard);
    Image<float> depth, inverse;
    const Image<std::uint32_t> picture = planes.picture(drawn, &depth);
    const double mean = invert_depths(std::as_const(depth).view(), 0.1, inverse);
    Image<std::uint32_t> out(kW, kH);
    double none = 0, pan = 0, plane = 0, warp = 0;
    std::int64_t good = 0;
    const glm::dvec3 moves[] = {{0.02, 0.01, -0.03},
                                {-0.03, 0, 0.04},
                                {0.01, -0.02, -0.04},
                                {-0.02, 0.02, 0.03},
                                {0.03, -0.01, 0.03}};
    for (const glm::dvec3& move : moves) {
        const View now = window_at(glm::dvec3(0, 0, 0.6) + move);
        const Image<std::uint32_t> truth = planes.picture(now);
        const auto shifted = [&](glm::ivec2 by) {
            for (int y = 0; y < kH; ++y) {
                for (int x = 0; x < kW; ++x) {
                    out.at(x, y) = picture.at(std::clamp(x + guard + by.x, 0, drawn.width - 1),
                                              std::clamp(y + guard + by.y, 0, drawn.height - 1));
                }
            }
            return mean_error(out, truth);
        };
        none += shifted({0, 0});
        pan += shifted(pan_of(now, old, mean));
        deflect({picture.view(), drawn, {}}, now, mean, true, out.view());
        plane += mean_error(out, truth);
        deflect({picture.view(), drawn, std::as_const(inverse).view()}, now, mean, true,
                out.view());
        warp += mean_error(out, truth);
        // Away from what the near plane hid and uncovers, the warp is the picture itself.
        for (std::size_t i = 0; i < out.size(); ++i) {
            bool same = true;
            for (int c = 0; c < 3; ++c) {
                same = same && std::abs(reference::channel(out.pixels()[i], c) -
                                        reference::channel(truth.pixels()[i], c)) <= 4;
            }
            good += same;
        }
    }
    EXPECT_LT(pan, 0.8 * none);
    EXPECT_LT(plane, 0.95 * pan);
    EXPECT_LT(warp, 0.5 * plane);
    EXPECT_GT(static_cast<double>(good) / static_cast<double>(std::size(moves) * out.size()), 0.9);
}

TEST(Deflect, UncoveredPlacesShowTheFartherSurface) {
    const TwoPlanes planes;
    const View old = window_at({0, 0, 0.6});
    const View now = window_at({0.05, 0, 0.6});
    const View drawn = zoomed_view(old, 1, 16);
    Image<float> depth, inverse;
    const Image<std::uint32_t> picture = planes.picture(drawn, &depth);
    const double mean = invert_depths(std::as_const(depth).view(), 0.1, inverse);
    Image<std::uint32_t> out(kW, kH);
    deflect({picture.view(), drawn, std::as_const(inverse).view()}, now, mean, false, out.view());
    std::int64_t near_where_far = 0, uncovered = 0;
    for (int y = 0; y < kH; ++y) {
        for (int x = 0; x < kW; ++x) {
            const auto [color, z] = planes.seen(now, x, y);
            if (color >> 16 != 200u) continue;
            // Not seen from the old eye: its ray there ends on the near plane.
            const Projection& k = now.projection;
            const glm::dvec3 at =
                now.world_from_view * glm::dvec3((x - k.cx) / k.fx * z, (y - k.cy) / k.fy * z, z);
            const glm::dvec2 before = pixel_of(old, at);
            if (planes.seen(old, before.x, before.y).first >> 16 == 200u) continue;
            ++uncovered;
            near_where_far += out.at(x, y) >> 16 != 200u;
        }
    }
    EXPECT_GT(uncovered, 50);
    EXPECT_LE(near_where_far, uncovered / 5);
}

TEST(Deflect, SimdAgreesWithPortableToTheBit) {
    std::mt19937 random(8);
    std::uniform_real_distribution<double> any(-1, 1);
    for (int trial = 0; trial < 60; ++trial) {
        const int w = 1 + static_cast<int>(random() % 70), h = 1 + static_cast<int>(random() % 20);
        const View full = window_view(kScreen, {0.2 * any(random), 0.1 * any(random), 0.6}, w, h);
        View shown = window_view(kScreen, {0.3 * any(random), 0.3 * any(random), 0.5}, w, h);
        shown.world_from_view.rotation =
            glm::normalize(shown.world_from_view.rotation *
                           glm::angleAxis(trial % 3 * any(random), glm::dvec3(0, 1, 0)));
        const View drawn = zoomed_view(full, 1 + trial % 4 % std::min(w, h), trial % 3);
        const Image<std::uint32_t> picture =
            noise(drawn.width, drawn.height, static_cast<unsigned>(random()));
        Image<float> inverse(drawn.width, drawn.height);
        for (float& v : inverse.pixels()) v = static_cast<float>(2 + 2 * any(random));
        const DrawnPicture in{picture.view(), drawn,
                              trial % 2 ? std::as_const(inverse).view() : ImageView<const float>{}};
        Image<std::uint32_t> a(w, h), b(w, h);
        const double plane = std::abs(any(random));
        EXPECT_EQ(deflect(in, shown, plane, trial % 4 < 2, a.view()),
                  deflect_portable(in, shown, plane, trial % 4 < 2, b.view()));
        ASSERT_EQ(a, b) << trial;
    }
}

TEST(Deflect, TurnsAreLimitedAndNoNumbersAreNoPose) {
    const View drawn = window_at({0, 0, 0.6});
    View turned = drawn;
    turned.world_from_view.rotation =
        drawn.world_from_view.rotation * glm::angleAxis(1.2, glm::dvec3(0, 1, 0));
    const View limited = deflectable(turned, drawn);
    const double angle = 2 * std::acos(std::abs(glm::dot(limited.world_from_view.rotation,
                                                         drawn.world_from_view.rotation)));
    EXPECT_NEAR(angle, 0.349066, 1e-5);
    turned.world_from_view.rotation =
        drawn.world_from_view.rotation * glm::angleAxis(0.2, glm::dvec3(0, 1, 0));
    EXPECT_EQ(deflectable(turned, drawn), turned);
    View wrong = drawn;
    wrong.world_from_view.translation.x = kNaN;
    EXPECT_EQ(deflectable(wrong, drawn), drawn);
    wrong = drawn;
    wrong.projection.fx = kNaN;
    EXPECT_EQ(deflectable(wrong, drawn), drawn);
    // Rays that look away from what was drawn do not read from behind the camera.
    const Image<std::uint32_t> picture = noise(kW, kH, 4);
    View behind = drawn;
    behind.world_from_view.rotation =
        drawn.world_from_view.rotation * glm::angleAxis(3.0, glm::dvec3(0, 1, 0));
    Image<std::uint32_t> out(kW, kH);
    EXPECT_GT(deflect({picture.view(), drawn, {}}, behind, 0.5, true, out.view()),
              kW * kH * 9 / 10);
}

}  // namespace
}  // namespace kino
