#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <numbers>

#include "calibration/rig.h"
#include "tests/calibration/rig_samples.h"
#include "tests/reference/registration_reference.h"

namespace kino {
namespace {

struct Agreement {
    double worst_uv_px = 0;
    double worst_depth_m = 0;     // of the depth image
    double worst_in_color_m = 0;  // where both chose the same winner
    std::size_t seen = 0;         // depth pixels with a place in the reference's colour image
    std::size_t other_validity = 0;
    std::size_t filled = 0;  // colour pixels
    std::size_t other_winner = 0;
};

double clamped(double value, int size) {
    return std::clamp(value, 0.0, size - 1.0);
}

Agreement compare(const RigParameters& parameters, const DepthFrame& frame) {
    Rig rig = Rig::create(parameters).value();
    RegisteredDepth fast;
    EXPECT_TRUE(rig.register_depth(frame, fast));
    const reference::Registration slow =
        reference::register_depth(parameters, reference::rays(parameters.depth), frame);
    Agreement a;
    for (std::size_t i = 0; i < slow.uv.size(); ++i) {
        a.worst_depth_m = std::max(a.worst_depth_m,
                                   std::abs(fast.depth_m.pixels()[i] - slow.depth_m.pixels()[i]));
        const ColorUv uv = fast.uv.pixels()[i];
        const glm::dvec2 exact = slow.uv.pixels()[i];
        const bool in_picture = !std::isnan(exact.x);
        const bool shown = in_picture && slow.hidden.pixels()[i] == 0;
        if (in_picture) ++a.seen;
        if (uv.valid() != shown) {
            ++a.other_validity;
        } else if (shown) {
            const glm::dvec2 expected(clamped(exact.x, parameters.color->width),
                                      clamped(exact.y, parameters.color->height));
            const double error = glm::length(glm::dvec2(uv.u, uv.v) / 16.0 - expected);
            a.worst_uv_px = std::max(a.worst_uv_px, error);
        }
    }
    for (std::size_t i = 0; i < slow.depth_in_color_m.size(); ++i) {
        const double z = fast.depth_in_color_m.pixels()[i];
        const double exact = slow.depth_in_color_m.pixels()[i];
        if (exact > 0) ++a.filled;
        // Rounding moves a winner by micrometres; another winner differs by a unit of depth or by
        // what a pixel's slope makes of it. 0.1 mm tells them apart.
        const double error = std::abs(z - exact);
        if ((z > 0) != (exact > 0) || error > 1e-4) {
            ++a.other_winner;
        } else {
            a.worst_in_color_m = std::max(a.worst_in_color_m, error);
        }
    }
    return a;
}

void expect_agreement(const Agreement& a, const std::string& what, bool all_hidden_ok = false) {
    EXPECT_LT(a.worst_uv_px, 0.05) << what;
    EXPECT_LT(a.worst_depth_m, 1e-5) << what;
    EXPECT_LT(a.worst_in_color_m, 1e-5) << what;
    // One pixel may always fall on the other side of a border, however small the picture.
    EXPECT_LE(a.other_winner, 1 + a.filled / 1000) << what << ", of " << a.filled;
    EXPECT_LE(a.other_validity, 1 + a.seen / 1000) << what << ", of " << a.seen;
    if (!all_hidden_ok) {
        EXPECT_GT(a.seen, 1000u) << what;
    }
}

TEST(RigAgainstReference, RandomRigs) {
    RigSamples samples(1);
    for (int i = 0; i < 12; ++i) {
        const RigParameters parameters = samples.rig(320, 240);
        expect_agreement(compare(parameters, samples.room(320, 240)), "rig " + std::to_string(i));
    }
}

TEST(RigAgainstReference, FinerAndCoarserColour) {
    RigSamples samples(2);
    for (const int factor : {1, 2, 3}) {
        RigParameters parameters = samples.rig(200, 150);
        parameters.color = samples.camera(200 * factor + 1, 150 * factor);
        expect_agreement(compare(parameters, samples.room(200, 150)),
                         "finer " + std::to_string(factor));
        parameters.color = samples.camera(200 / factor, 150 / factor);
        expect_agreement(compare(parameters, samples.room(200, 150)),
                         "coarser " + std::to_string(factor));
    }
}

TEST(RigAgainstReference, StrongDistortion) {
    RigSamples samples(3);
    RigParameters parameters = samples.rig(320, 240);
    parameters.depth = RigSamples::folding_camera(320, 240);
    expect_agreement(compare(parameters, samples.room(320, 240)), "folding depth");
    parameters = samples.rig(320, 240);
    parameters.color = RigSamples::folding_camera(320, 240);
    expect_agreement(compare(parameters, samples.room(320, 240)), "folding colour");
    parameters.color->k1 = 1.5;
    parameters.color->p1 = 0.02;
    parameters.color->p2 = -0.03;
    expect_agreement(compare(parameters, samples.room(320, 240)), "strong pincushion");
    parameters.color->k4 = -0.9;
    expect_agreement(compare(parameters, samples.room(320, 240)), "denominator near zero");
}

TEST(RigAgainstReference, Disparity) {
    RigSamples samples(4);
    const RigParameters parameters = samples.rig(320, 240);
    DepthFrame frame = samples.room(320, 240);
    frame.unit = DepthUnit::kinect_disparity11;
    for (auto& raw : frame.raw.pixels()) raw = static_cast<std::uint16_t>(400 + raw % 700);
    expect_agreement(compare(parameters, frame), "disparity");
    // Every 16-bit number there is.
    for (std::size_t i = 0; i < frame.raw.size(); ++i) {
        frame.raw.pixels()[i] = static_cast<std::uint16_t>(i);
    }
    expect_agreement(compare(parameters, frame), "all raw values", true);
}

TEST(RigAgainstReference, HardFrames) {
    RigSamples samples(5);
    const RigParameters parameters = samples.rig(320, 240);
    DepthFrame frame = samples.room(320, 240);
    for (const int raw : {0, 65535, 10'000}) {
        frame.raw.fill(static_cast<std::uint16_t>(raw));
        expect_agreement(compare(parameters, frame), "all " + std::to_string(raw), true);
    }
    // Near and far in turn, one pixel each: neighbours fight for the same colour pixels.
    for (int y = 0; y < 240; ++y) {
        for (int x = 0; x < 320; ++x) {
            frame.raw.at(x, y) = (x + y) % 2 == 0 ? 500 : 6000;
        }
    }
    expect_agreement(compare(parameters, frame), "checkerboard");
    frame = samples.room(320, 240);
    frame.metres_per_unit = 0.0002;
    for (auto& raw : frame.raw.pixels()) raw = static_cast<std::uint16_t>(raw * 5);
    expect_agreement(compare(parameters, frame), "fifths of a millimetre");
}

TEST(RigAgainstReference, HardPoses) {
    RigSamples samples(6);
    RigParameters parameters = samples.rig(320, 240);
    const DepthFrame frame = samples.room(320, 240);
    const Pose usual = parameters.color_from_depth;

    parameters.color_from_depth.translation = {1.5, -0.4, 0.2};
    expect_agreement(compare(parameters, frame), "baseline larger than depth");
    parameters.color_from_depth = usual;
    parameters.color_from_depth.rotation =
        glm::angleAxis(std::numbers::pi, glm::dvec3(0, 0, 1)) * usual.rotation;
    expect_agreement(compare(parameters, frame), "upside down");
    parameters.color_from_depth.rotation =
        glm::angleAxis(std::numbers::pi, glm::dvec3(0, 1, 0)) * usual.rotation;
    const Agreement away = compare(parameters, frame);
    expect_agreement(away, "looking away", true);
    EXPECT_EQ(away.seen, 0u);
    parameters.color_from_depth.translation = {0, 0, 6};
    expect_agreement(compare(parameters, frame), "colour camera behind the scene");
    parameters.color_from_depth = usual;
    parameters.color_from_depth.translation = {0, 0, -2.5};
    expect_agreement(compare(parameters, frame), "colour camera inside the scene");
}

}  // namespace
}  // namespace kino
