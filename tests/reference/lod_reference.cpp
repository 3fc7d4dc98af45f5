#include "tests/reference/lod_reference.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <numeric>
#include <vector>

namespace kino::reference {
namespace {

// What the contract adds to Eq. 1's exponents, in powers of two: depth counts up to here, ...
constexpr double kFarthest = 1e4;
constexpr double kOtherObject = 1e4;  // ... hard filters beyond it.
constexpr double kNothing = 2e4;
// Samples with less of the tent do not decide which is nearest.
constexpr double kLeastTent = 1e-3;

struct Neighbour {
    int x = 0, y = 0;
    double tent = 0;  ///< or Gaussian
};

/// Those that a Gaussian of sigma 0.7 weighs, with weights that add up to one.
std::vector<Neighbour> gauss_neighbours(double at_x, double at_y, int width, int height) {
    const int left = static_cast<int>(std::floor(at_x)) - 1;
    const int top = static_cast<int>(std::floor(at_y)) - 1;
    std::vector<Neighbour> out;
    double sum = 0;
    for (int y = top; y < top + 4; ++y) {
        for (int x = left; x < left + 4; ++x) {
            const double squared = (at_x - x) * (at_x - x) + (at_y - y) * (at_y - y);
            const double weight = std::exp(-squared / (2 * 0.7 * 0.7));
            out.push_back({std::clamp(x, 0, width - 1), std::clamp(y, 0, height - 1), weight});
            sum += weight;
        }
    }
    for (Neighbour& neighbour : out) neighbour.tent /= sum;
    return out;
}

std::array<Neighbour, 4> neighbours(double at_x, double at_y, int width, int height) {
    const int left = static_cast<int>(std::floor(at_x));
    const int top = static_cast<int>(std::floor(at_y));
    std::array<Neighbour, 4> out;
    for (int k = 0; k < 4; ++k) {
        const int x = left + k % 2;
        const int y = top + k / 2;
        out[k] = {std::clamp(x, 0, width - 1), std::clamp(y, 0, height - 1),
                  std::max(0.0, 1 - std::abs(at_x - x)) * std::max(0.0, 1 - std::abs(at_y - y))};
    }
    return out;
}

double coarse_of_fine(int fine_at, int fine, int coarse) {
    // lod_place is a line; where it meets fine_at.
    const double first = lod_place(0, fine, coarse);
    const double step = static_cast<double>(fine) / coarse;
    return (fine_at - first) / step;
}

}  // namespace

double lod_place(int j, int fine, int coarse) {
    const int divisor = std::gcd(fine, coarse);
    const int p = fine / divisor;
    const int q = coarse / divisor;
    const double bias = p % 2 == 0 ? 1.0 / (2.0 * q) : 0.0;
    return (j + 0.5) * fine / coarse - 0.5 + bias;
}

int lod_texel(int j, int fine, int coarse) {
    // In whole numbers: floor((j + 1/2) fine / coarse).
    return static_cast<int>((2LL * j + 1) * fine / (2LL * coarse));
}

glm::dvec3 lod_reconstruct(const Image<LodSample>& coarse, const Image<LodPixel>& fine, int x,
                           int y, const LodRules& rules, double* doubt_bits) {
    const LodPixel& pixel = fine.at(x, y);
    const bool depth_counts = std::isfinite(rules.sigma_z);
    if (doubt_bits != nullptr) *doubt_bits = 0;
    if (depth_counts && !pixel.covered) return pixel.own;
    const double z = pixel.z > 0 ? pixel.z : 1.0;
    const auto ray = [&](double px, double py) {
        return glm::dvec3((px - rules.cx) / rules.fx, (py - rules.cy) / rules.fy, 1);
    };
    const double at_x = coarse_of_fine(x, fine.width(), coarse.width());
    const double at_y = coarse_of_fine(y, fine.height(), coarse.height());
    const auto four = neighbours(at_x, at_y, coarse.width(), coarse.height());
    const std::vector<Neighbour> around =
        rules.gauss ? gauss_neighbours(at_x, at_y, coarse.width(), coarse.height())
                    : std::vector<Neighbour>(four.begin(), four.end());
    std::vector<double> e(around.size(), 0.0);
    for (std::size_t k = 0; k < around.size(); ++k) {
        const LodSample& sample = coarse.at(around[k].x, around[k].y);
        const bool nothing = !(sample.z > 0);
        const double zj = sample.z;
        double d = z - zj;
        if (rules.metric == LodMetric::log_depth && !nothing) d = std::log(z) - std::log(zj);
        if (rules.metric == LodMetric::plane) {
            const glm::dvec3 own = ray(x, y) * z;
            const glm::dvec3 other = ray(lod_place(around[k].x, fine.width(), coarse.width()),
                                         lod_place(around[k].y, fine.height(), coarse.height())) *
                                     zj;
            d = glm::dot(pixel.normal, own - other) / z;
        }
        const double ln2 = std::log(2.0);
        if (depth_counts) {
            e[k] = nothing ? kNothing * ln2
                           : std::min(d * d / (2 * rules.sigma_z * rules.sigma_z), kFarthest * ln2);
        }
        if (std::isfinite(rules.sigma_n)) {
            const glm::dvec2 apart = pixel.slope - sample.slope;
            e[k] += glm::dot(apart, apart) / (2 * rules.sigma_n * rules.sigma_n);
        }
        if (rules.objects && sample.object != pixel.object) e[k] += kOtherObject * ln2;
    }
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < around.size(); ++k) {
        if (around[k].tent >= kLeastTent) least = std::min(least, e[k]);
    }
    glm::dvec3 sum(0);
    double weights = 0;
    for (std::size_t k = 0; k < around.size(); ++k) {
        const double weight = around[k].tent * std::exp(-std::max(e[k] - least, 0.0));
        sum += weight * coarse.at(around[k].x, around[k].y).light;
        weights += weight;
    }
    if (doubt_bits != nullptr) *doubt_bits = least / std::log(2.0) - std::log2(weights);
    const glm::dvec3 light = sum / weights;
    return rules.fine_grained ? light * pixel.own : light;
}

glm::dvec3 lod_bilinear(const Image<LodSample>& coarse, int fine_width, int fine_height, int x,
                        int y) {
    glm::dvec3 sum(0);
    for (const Neighbour& n : neighbours(coarse_of_fine(x, fine_width, coarse.width()),
                                         coarse_of_fine(y, fine_height, coarse.height()),
                                         coarse.width(), coarse.height())) {
        sum += n.tent * coarse.at(n.x, n.y).light;
    }
    return sum;
}

}  // namespace kino::reference
