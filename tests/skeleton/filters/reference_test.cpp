#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat2x2.hpp>
#include <glm/matrix.hpp>

#include "skeleton/filters/holt_filter.h"
#include "skeleton/filters/kalman_filter.h"
#include "skeleton/filters/lag.h"
#include "skeleton/filters/one_euro_filter.h"
#include "tests/skeleton/filters/tracks.h"

/// Each filter against an obvious one: coordinate by coordinate, the whole history kept, matrices
/// written out.
namespace kino {
namespace {

using glm::dvec3;

std::vector<dvec3> slow_holt(const std::vector<dvec3>& in, const HoltParameters& p) {
    std::vector<dvec3> level = {in[0]}, trend = {dvec3(0)}, out = {in[0]};
    for (std::size_t n = 1; n < in.size(); ++n) {
        dvec3 r = in[n];
        const double away = glm::length(r - level[n - 1]);
        if (away < p.jitter_radius_m) {
            const double share = away / p.jitter_radius_m;
            r = r * share + level[n - 1] * (1 - share);
        }
        level.push_back((1 - p.smoothing) * r + p.smoothing * (level[n - 1] + trend[n - 1]));
        trend.push_back(p.correction * (level[n] - level[n - 1]) +
                        (1 - p.correction) * trend[n - 1]);
        dvec3 ahead = level[n] + p.prediction * trend[n];
        const dvec3 off = ahead - in[n];
        if (glm::length(off) > p.max_deviation_m)
            ahead = in[n] + off * (p.max_deviation_m / glm::length(off));
        out.push_back(ahead);
    }
    return out;
}

std::vector<dvec3> slow_one_euro(const std::vector<dvec3>& in, const OneEuroParameters& p,
                                 double dt_s, bool paper_weight) {
    const auto weight = [&](double cutoff) {
        const double tau = 1 / (2 * std::numbers::pi * cutoff);
        return paper_weight ? 1 / (1 + tau / dt_s) : 1 - std::exp(-dt_s / tau);
    };
    std::vector<dvec3> out = {in[0]};
    dvec3 speed(0);
    for (std::size_t n = 1; n < in.size(); ++n) {
        const double a = weight(p.speed_cutoff_hz);
        speed = a * (in[n] - in[n - 1]) / dt_s + (1 - a) * speed;
        const double w = weight(p.min_cutoff_hz + p.beta_hz_per_mps * std::sqrt(speed.x * speed.x +
                                                                                speed.y * speed.y +
                                                                                speed.z * speed.z));
        out.push_back(w * in[n] + (1 - w) * out.back());
    }
    return out;
}

// The textbook's matrices in the Joseph form, axis by axis.
std::vector<dvec3> slow_kalman(const std::vector<dvec3>& in, const KalmanParameters& p,
                               double dt_s) {
    const glm::dmat2 f(1, 0, dt_s, 1);  // by columns
    const glm::dmat2 q = p.acceleration_density *
                         glm::dmat2(dt_s * dt_s * dt_s / 3, dt_s * dt_s / 2, dt_s * dt_s / 2, dt_s);
    const double r = p.noise_m * p.noise_m / (30 * dt_s);
    std::vector<dvec3> out(in.size());
    for (int axis = 0; axis < 3; ++axis) {
        glm::dvec2 x(in[0][axis], 0);
        glm::dmat2 cov(p.noise_m * p.noise_m, 0, 0,
                       p.start_speed_sigma_mps * p.start_speed_sigma_mps);
        out[0][axis] = x[0];
        for (std::size_t n = 1; n < in.size(); ++n) {
            x = f * x;
            cov = f * cov * glm::transpose(f) + q;
            const glm::dvec2 k = cov * glm::dvec2(1, 0) / (cov[0][0] + r);
            x += k * (in[n][axis] - x[0]);
            const glm::dmat2 rest = glm::dmat2(1) - glm::outerProduct(k, glm::dvec2(1, 0));
            cov = rest * cov * glm::transpose(rest) + r * glm::outerProduct(k, k);
            out[n][axis] = x[0];
        }
    }
    return out;
}

void expect_same(const std::vector<dvec3>& a, const std::vector<dvec3>& b, const char* what) {
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i)
        ASSERT_LT(glm::distance(a[i], b[i]), 2e-6) << what << ", sample " << i;
}

std::vector<dvec3> as_read(std::vector<dvec3> track) {  // through the float of a joint
    for (dvec3& p : track) p = dvec3(glm::vec3(p));
    return track;
}

TEST(Reference, Holt) {
    const auto track = as_read(test::with_noise(test::waving_hand(9, 30), 0.015, 21));
    for (const char* preset : {"default", "somewhat-latent", "very-smooth"}) {
        HoltFilter filter(*holt_preset(preset));
        expect_same(test::run(filter, track, 1 / 30.0), slow_holt(track, *holt_preset(preset)),
                    preset);
    }
}

TEST(Reference, TheSdksPresets) {
    const auto values = [](const char* name) {
        const HoltParameters p = *holt_preset(name);
        return std::array{p.smoothing, p.correction, p.prediction, p.jitter_radius_m,
                          p.max_deviation_m};
    };
    EXPECT_EQ(values("default"), (std::array{0.5, 0.5, 0.5, 0.05, 0.04}));
    EXPECT_EQ(values("somewhat-latent"), (std::array{0.5, 0.1, 0.5, 0.1, 0.1}));
    EXPECT_EQ(values("very-smooth"), (std::array{0.7, 0.3, 1.0, 1.0, 1.0}));
}

TEST(Reference, OneEuro) {
    for (const double rate_hz : {15.0, 30.0, 60.0}) {
        const auto track = as_read(test::with_noise(test::waving_hand(9, rate_hz), 0.015, 22));
        for (const char* preset : {"default", "calm", "quick"}) {
            OneEuroFilter filter(*one_euro_preset(preset));
            expect_same(test::run(filter, track, 1 / rate_hz),
                        slow_one_euro(track, *one_euro_preset(preset), 1 / rate_hz, false), preset);
        }
    }
}

TEST(Reference, OneEuroIsThePapersWhereFramesAreDense) {
    const auto track = as_read(test::waving_hand(4, 2000));
    OneEuroFilter filter;
    const auto ours = test::run(filter, track, 1 / 2000.0);
    const auto paper = slow_one_euro(track, {}, 1 / 2000.0, true);
    for (std::size_t i = 0; i < ours.size(); ++i) ASSERT_LT(glm::distance(ours[i], paper[i]), 1e-3);
}

TEST(Reference, Kalman) {
    for (const double rate_hz : {15.0, 30.0, 60.0}) {
        const auto track = as_read(test::with_noise(test::waving_hand(9, rate_hz), 0.015, 23));
        for (const char* preset : {"default", "calm", "quick"}) {
            KalmanFilter filter(*kalman_preset(preset));
            expect_same(test::run(filter, track, 1 / rate_hz),
                        slow_kalman(track, *kalman_preset(preset), 1 / rate_hz), preset);
        }
    }
}

TEST(Lag, AKnownDelayIsFound) {
    const auto at = [](double t) {
        return dvec3(std::sin(4 * t), std::cos(3.1 * t), 0.3 * std::sin(7 * t));
    };
    for (const double lag_s : {-0.05, 0.0, 0.0125, 0.033, 0.1, 0.21}) {
        const auto truth = test::sampled(at, 10, 30);
        const auto late = test::sampled([&](double t) { return at(t - lag_s); }, 10, 30);
        const LagAndResidual found = measure_lag(truth, late, 1 / 30.0);
        EXPECT_NEAR(found.lag_s, lag_s, 0.001);
        EXPECT_LT(found.residual_rms_m, 0.006);
        EXPECT_GT(found.correlation, 0.999);
    }
}

TEST(Lag, NoiseIsResidualAndStandingStillIsJitter) {
    const auto truth = test::waving_hand(10, 30);
    const auto noisy = test::with_noise(truth, 0.01, 31);
    const LagAndResidual found = measure_lag(truth, noisy, 1 / 30.0);
    EXPECT_NEAR(found.lag_s, 0, 0.002);
    EXPECT_NEAR(found.residual_rms_m, 0.01 * std::sqrt(3.0), 0.0015);
    const std::vector<dvec3> still(300, dvec3(0, 0, 2));
    const auto shaking = test::with_noise(still, 0.01, 32);
    EXPECT_EQ(measure_lag(still, shaking, 1 / 30.0).lag_s, 0);
    EXPECT_NEAR(rms_about_mean_m(shaking), 0.01 * std::sqrt(3.0), 0.0015);
    EXPECT_EQ(rms_about_mean_m({}), 0);
}

// The trade that each preset makes on an arm that waves and one that stands still, with 5 mm of
// noise on each axis: the table in docs/gestures.md.
TEST(Lag, EveryFilterCalmsAStillHandAndFollowsAFastOne) {
    const auto fast = test::waving_hand(10, 30);
    const std::vector<dvec3> still(300, dvec3(0, 0, 2));
    const auto noisy_fast = test::with_noise(fast, 0.005, 33);
    const auto noisy_still = test::with_noise(still, 0.005, 34);
    for (const char* name : test::filter_names()) {
        auto filter = std::move(*make_body_filter(name));
        const auto moving = measure_lag(fast, test::run(*filter, noisy_fast, 1 / 30.0), 1 / 30.0);
        filter->reset();
        const double jitter = rms_about_mean_m(test::run(*filter, noisy_still, 1 / 30.0));
        std::printf("%-22s lag %5.1f ms, residual %4.1f mm, still %4.2f mm\n", name,
                    moving.lag_s * 1e3, moving.residual_rms_m * 1e3, jitter * 1e3);
        EXPECT_LT(jitter, rms_about_mean_m(noisy_still)) << name;
        EXPECT_LT(std::abs(moving.lag_s), 0.15) << name;
    }
}

}  // namespace
}  // namespace kino
