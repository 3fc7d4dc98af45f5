#include "calibration/disparity.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "calibration/rig.h"

namespace kino {
namespace {

constexpr DisparityFormula kFormulas[] = {
    DisparityFormula::zero_plane, DisparityFormula::inverse_linear, DisparityFormula::tangent,
    DisparityFormula::baseline_over_raw};

Disparity with(DisparityFormula formula) {
    return Disparity({}, 0.3, 10.0, formula);
}

TEST(Disparity, EveryRawValueComesBack) {
    for (const auto formula : kFormulas) {
        const Disparity d = with(formula);
        int valid = 0;
        for (int raw = 0; raw < 2047; ++raw) {
            const auto z = d.metres(raw);
            if (!z) continue;
            ++valid;
            EXPECT_EQ(d.raw(*z), raw) << name(formula);
            EXPECT_NEAR(d.raw_exact(*z).value(), raw, 1e-6) << name(formula);
        }
        EXPECT_GT(valid, 700) << name(formula);
    }
}

TEST(Disparity, DepthComesBackWithinHalfAStep) {
    for (const auto formula : kFormulas) {
        const Disparity d = with(formula);
        for (double z = 0.5; z < 9.0; z *= 1.0007) {
            EXPECT_NEAR(d.metres(d.raw_exact(z).value()).value(), z, 1e-9);
            const double rounded = d.metres(d.raw(z)).value();
            // The step itself grows by up to a half per cent across half a step at 9 m.
            EXPECT_LE(std::abs(rounded - z), 0.5 * d.step_m(std::max(z, rounded)) * 1.001)
                << name(formula) << " at " << z;
        }
    }
}

TEST(Disparity, FartherMeansLargerRaw) {
    for (const auto formula : kFormulas) {
        const Disparity d = with(formula);
        double before = 0;
        for (int raw = 0; raw < 2047; ++raw) {
            const auto z = d.metres(raw);
            if (!z) continue;
            EXPECT_GT(*z, before) << name(formula) << " raw " << raw;
            before = *z;
        }
    }
}

TEST(Disparity, PublishedTableOfTheFormulas) {
    struct Row {
        int raw;
        double mm[4];
    };
    const Row rows[] = {{500, {586, 557, 584, 590}},
                        {800, {1194, 1144, 1195, 1200}},
                        {900, {1824, 1764, 1818, 1832}},
                        {1000, {3864, 3848, 3779, 3867}},
                        {1050, {8767, 9408, 8183, 8700}}};
    for (const Row& row : rows) {
        for (int f = 0; f < 4; ++f) {
            EXPECT_NEAR(with(kFormulas[f]).metres(row.raw).value() * 1000, row.mm[f], 0.51)
                << name(kFormulas[f]) << " raw " << row.raw;
        }
    }
}

TEST(Disparity, TheQuarterStays) {
    // With the quarter dropped by integer division, four neighbours would share one depth.
    const Disparity d;
    for (int raw = 800; raw < 804; ++raw) {
        EXPECT_NEAR(d.metres(raw + 1).value() - d.metres(raw).value(), d.step_m(1.2), 2e-4);
    }
}

TEST(Disparity, StepIsTheSlopeOfTheFormula) {
    for (const auto formula : kFormulas) {
        const Disparity d = with(formula);
        for (const double z : {0.6, 1.0, 2.0, 4.0, 8.0}) {
            const double raw = d.raw_exact(z).value();
            const double slope =
                (d.metres(raw + 1e-4).value() - d.metres(raw - 1e-4).value()) / 2e-4;
            EXPECT_NEAR(d.step_m(z) / slope, 1, 1e-5) << name(formula) << " at " << z;
        }
    }
}

TEST(Disparity, QuantisationStepTable) {
    const double z[] = {0.8, 1, 1.5, 2, 3, 4};
    const double mm[] = {2.0, 3.1, 6.9, 12.3, 27.6, 49.1};
    for (int i = 0; i < 6; ++i) {
        EXPECT_NEAR(Rig::quantisation_step_m(static_cast<float>(z[i])) * 1000, mm[i], 0.06);
        EXPECT_NEAR(with(DisparityFormula::inverse_linear).step_m(z[i]) * 1000, mm[i], 0.06);
        // The factory's own constants give 0.00289 z^2: 6 % finer than the rounded rule, never
        // coarser, so that limits in steps stay on the safe side.
        EXPECT_LT(Disparity().step_m(z[i]) * 1000, mm[i] * 1.01);
        EXPECT_GT(Disparity().step_m(z[i]) * 1000, mm[i] * 0.92);
    }
}

TEST(Disparity, Raw2047AndBeyondIsNoReading) {
    for (const auto formula : kFormulas) {
        const Disparity d = with(formula);
        EXPECT_FALSE(d.metres(2047));
        EXPECT_FALSE(d.metres(2048));
        EXPECT_FALSE(d.metres(0xFFFF));
        EXPECT_FALSE(d.metres(-1));
        EXPECT_FALSE(d.metres(std::numeric_limits<double>::quiet_NaN()));
        EXPECT_EQ(d.table()[2047], 0.0f);
    }
}

TEST(Disparity, RawNear1084Point6) {
    for (const auto formula : kFormulas) {
        const Disparity d = with(formula);
        for (double raw = 1050; raw < 2047; raw += 0.05) {
            const auto z = d.metres(raw);
            if (z) {
                EXPECT_GE(*z, 0.3) << name(formula) << " raw " << raw;
                EXPECT_LE(*z, 10.000001) << name(formula) << " raw " << raw;
            }
        }
        EXPECT_FALSE(d.metres(1084.6)) << name(formula);
        EXPECT_FALSE(d.metres(1084.612)) << name(formula);
        for (int raw = 1080; raw < 1100; ++raw) {
            EXPECT_EQ(d.table()[static_cast<std::size_t>(raw)], 0.0f) << name(formula);
        }
    }
    // The poles themselves: 1/x at 1084.61, b f/(doff - raw) at 1090.
    EXPECT_FALSE(with(DisparityFormula::inverse_linear).metres(3.3309495161 / 0.0030711016));
    EXPECT_FALSE(with(DisparityFormula::baseline_over_raw).metres(1090));
}

TEST(Disparity, ShiftTableAtDepth0) {
    for (const auto formula : kFormulas) {
        const Disparity d = with(formula);
        EXPECT_EQ(d.raw(0), Disparity::kNoReading);
        EXPECT_EQ(d.raw(-0.0), Disparity::kNoReading);
        EXPECT_EQ(d.raw(-1), Disparity::kNoReading);
        EXPECT_EQ(d.raw(std::numeric_limits<double>::quiet_NaN()), Disparity::kNoReading);
        EXPECT_EQ(d.raw(std::numeric_limits<double>::infinity()), Disparity::kNoReading);
        for (int mm = 0; mm < 12'000; ++mm) {
            const std::uint16_t raw = d.raw(mm / 1000.0);
            EXPECT_LE(raw, Disparity::kNoReading);
            if (raw != Disparity::kNoReading) {
                EXPECT_GT(d.table()[raw], 0.29f);
            }
        }
    }
}

TEST(Disparity, RangeIsAtMost300MillimetresTo10Metres) {
    const Disparity wide({}, 0.0, 100.0);
    const Disparity narrow({}, 0.8, 4.0);
    int wide_count = 0;
    int narrow_count = 0;
    for (int raw = 0; raw < 2048; ++raw) {
        const float w = wide.table()[static_cast<std::size_t>(raw)];
        const float n = narrow.table()[static_cast<std::size_t>(raw)];
        if (w > 0) ++wide_count;
        if (n > 0) ++narrow_count;
        EXPECT_TRUE(w == 0 || (w >= 0.3f && w <= 10.0f)) << raw;
        EXPECT_TRUE(n == 0 || (n >= 0.8f && n <= 4.0f)) << raw;
        if (n > 0) {
            EXPECT_EQ(n, w);
        }
    }
    EXPECT_GT(wide_count, narrow_count);
    EXPECT_GT(narrow_count, 300);
    EXPECT_EQ(wide.raw(0.29), Disparity::kNoReading);
    EXPECT_EQ(narrow.raw(4.01), Disparity::kNoReading);
}

}  // namespace
}  // namespace kino
