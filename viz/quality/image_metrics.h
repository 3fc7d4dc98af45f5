#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "base/error.h"
#include "base/image.h"

namespace kino {

struct CompareOptions {
    /// A pixel fails where a channel differs by more than this, in 1/255.
    int tolerance = 0;
    /// 0: pixels are compared where they are. 1: a pixel passes if one of its 3x3 neighbours in the
    /// other picture matches, both ways, which forgives a sample that fell to the next pixel. At
    /// most 8.
    int shift_radius = 0;
};

/// How two pictures differ, over all four channels. Swapping the pictures changes nothing but the
/// order of operands.
struct ImageDifference {
    std::array<int, 4> max_abs{};  ///< r, g, b, a, in 1/255, without shift
    std::int64_t failing_pixels = 0;
    double failing_fraction = 0;  ///< of all pixels
    double rmse = 0;              ///< over r, g, b, in 1/255, without shift
    double psnr_db = 0;           ///< 20 log10(255 / rmse); infinity for equal pictures

    [[nodiscard]] bool equal() const { return max_abs == std::array<int, 4>{}; }
    [[nodiscard]] int max_abs_any() const;
    /// One line for a person.
    [[nodiscard]] std::string to_string() const;
};

/// Fails where the sizes differ or a picture is empty.
[[nodiscard]] Result<ImageDifference> compare_images(const Image<Rgba8>& a, const Image<Rgba8>& b,
                                                     const CompareOptions& options = {});

/// The gate for stored pictures: exact, or else at most 0.1 % of the pixels differ by more than
/// 2/255 when forgiven a shift of one pixel.
struct GoldenGate {
    CompareOptions options{.tolerance = 2, .shift_radius = 1};
    double max_failing_fraction = 0.001;
};

struct GoldenVerdict {
    bool passes = false;
    bool exact = false;
    ImageDifference difference;
};

/// Fails where the pictures cannot be compared at all.
[[nodiscard]] Result<GoldenVerdict> judge_golden(const Image<Rgba8>& actual,
                                                 const Image<Rgba8>& golden,
                                                 const GoldenGate& gate = {});

/// A picture of where two pictures differ: equal pixels as a dark grey copy, others from blue (1)
/// over red to yellow (64 and more). Pictures of different sizes are compared where both have
/// pixels; the rest is magenta. Size: the larger of each side.
[[nodiscard]] Image<Rgba8> difference_picture(const Image<Rgba8>& a, const Image<Rgba8>& b);

}  // namespace kino
