#include "viz/quality/flip.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <numbers>
#include <utility>
#include <vector>

#include "base/check.h"

namespace kino {
namespace {

using std::numbers::pi;
using Plane = Image<double>;

// Linear sRGB to CIE XYZ with white D65 (IEC 61966-2-1), by columns.
const glm::dmat3 kXyzFromRgb(glm::dvec3(10135552, 2 * 2613072, 1425312 / 3.0) / 24577794.0,
                             glm::dvec3(8788810, 2 * 8788810, 8788810 / 3.0) / 24577794.0,
                             glm::dvec3(4435075, 2 * 887015, 70074185 / 3.0) / 24577794.0);

glm::dvec3 xyz_of_white() {
    return kXyzFromRgb * glm::dvec3(1);
}

double linear_of_byte(int value) {
    const double c = value / 255.0;
    return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}

/// The opponent space of the paper's spatial filters: achromatic, red-green, blue-yellow.
glm::dvec3 opponent_from_xyz(const glm::dvec3& xyz) {
    const glm::dvec3 t = xyz / xyz_of_white();
    return {116 * t.y - 16, 500 * (t.x - t.y), 200 * (t.y - t.z)};
}

glm::dvec3 xyz_from_opponent(const glm::dvec3& c) {
    const double y = (c.x + 16) / 116;
    return glm::dvec3(c.y / 500 + y, y, y - c.z / 200) * xyz_of_white();
}

/// CIELAB with chroma scaled by lightness, after Hunt.
glm::dvec3 hunt_lab_from_xyz(const glm::dvec3& xyz) {
    const auto f = [](double t) {
        constexpr double kDelta = 6.0 / 29;
        return t > kDelta * kDelta * kDelta ? std::cbrt(t) : t / (3 * kDelta * kDelta) + 4.0 / 29;
    };
    const glm::dvec3 t = xyz / xyz_of_white();
    const double lightness = 116 * f(t.y) - 16;
    return {lightness, 0.01 * lightness * 500 * (f(t.x) - f(t.y)),
            0.01 * lightness * 200 * (f(t.y) - f(t.z))};
}

double hyab(const glm::dvec3& a, const glm::dvec3& b) {
    const glm::dvec3 d = a - b;
    return std::abs(d.x) + std::hypot(d.y, d.z);
}

/// A filter along one axis, `taps[radius]` in its middle.
using Taps = std::vector<double>;

template <class Weight>
Taps make_taps(int radius, Weight weight) {
    Taps taps;
    for (int i = -radius; i <= radius; ++i) taps.push_back(weight(i));
    return taps;
}

double sum_of(const Taps& taps) {
    double sum = 0;
    for (const double t : taps) sum += t;
    return sum;
}

/// Rows with `across`, then columns with `down`; the border repeats its outermost pixel.
Plane filtered(const Plane& in, const Taps& across, const Taps& down) {
    const int radius = static_cast<int>(across.size() / 2);
    const int width = in.width();
    const int height = in.height();
    Plane rows(width, height);
    std::vector<double> padded(static_cast<std::size_t>(width + 2 * radius));
    for (int y = 0; y < height; ++y) {
        for (int x = -radius; x < width + radius; ++x) {
            padded[static_cast<std::size_t>(x + radius)] = in.at(std::clamp(x, 0, width - 1), y);
        }
        for (int x = 0; x < width; ++x) {
            double sum = 0;
            for (std::size_t i = 0; i < across.size(); ++i) {
                sum += across[i] * padded[static_cast<std::size_t>(x) + i];
            }
            rows.at(x, y) = sum;
        }
    }
    Plane out(width, height, 0.0);
    for (int y = 0; y < height; ++y) {
        double* const to = out.row(y);
        for (std::size_t i = 0; i < down.size(); ++i) {
            const int from = std::clamp(y + static_cast<int>(i) - radius, 0, height - 1);
            const double* const row = rows.row(from);
            for (int x = 0; x < width; ++x) to[x] += down[i] * row[x];
        }
    }
    return out;
}

/// Contrast sensitivity of one channel: a sum of two Gaussians whose Fourier transforms are
/// a exp(-b f^2), f in cycles a degree (Table 1 of the paper).
struct Sensitivity {
    double a1, b1, a2, b2;
};
constexpr std::array<Sensitivity, 3> kSensitivity = {
    {{1, 0.0047, 0, 1e-5}, {1, 0.0053, 0, 1e-5}, {34.1, 0.04, 13.5, 0.025}}};

Plane blurred(const Plane& in, const Sensitivity& s, double pixels_per_degree) {
    // Three standard deviations of the widest of all.
    const int radius =
        static_cast<int>(std::ceil(3 * std::sqrt(0.04 / (2 * pi * pi)) * pixels_per_degree));
    // Normalised, with the weight it has in the sum of both.
    const auto gauss = [&](double a, double b) {
        Taps taps = make_taps(radius, [&](int i) {
            const double degrees = i / pixels_per_degree;
            return std::exp(-pi * pi * degrees * degrees / b);
        });
        const double sum = sum_of(taps);
        for (double& t : taps) t /= sum;
        return std::pair(taps, a * std::sqrt(pi / b) * sum * sum);
    };
    const auto [first, first_weight] = gauss(s.a1, s.b1);
    Plane out = filtered(in, first, first);
    if (s.a2 == 0) return out;
    const auto [second, second_weight] = gauss(s.a2, s.b2);
    const Plane other = filtered(in, second, second);
    const double share = first_weight / (first_weight + second_weight);
    for (std::size_t i = 0; i < out.size(); ++i) {
        out.pixels()[i] = share * out.pixels()[i] + (1 - share) * other.pixels()[i];
    }
    return out;
}

struct Prepared {
    std::array<Plane, 3> opponent;
};

Prepared prepare(const Image<Rgba8>& image) {
    std::array<double, 256> linear{};
    for (int i = 0; i < 256; ++i) linear[static_cast<std::size_t>(i)] = linear_of_byte(i);
    Prepared out;
    for (Plane& plane : out.opponent) plane.resize(image.width(), image.height());
    for (std::size_t i = 0; i < image.size(); ++i) {
        const Rgba8 p = image.pixels()[i];
        const glm::dvec3 c =
            opponent_from_xyz(kXyzFromRgb * glm::dvec3(linear[p.r], linear[p.g], linear[p.b]));
        for (int k = 0; k < 3; ++k) out.opponent[static_cast<std::size_t>(k)].pixels()[i] = c[k];
    }
    return out;
}

/// What the eye gets of the colours, as Hunt-adjusted CIELAB.
Image<glm::dvec3> seen_colors(const Prepared& prepared, double pixels_per_degree) {
    std::array<Plane, 3> blur;
    for (std::size_t k = 0; k < 3; ++k) {
        blur[k] = blurred(prepared.opponent[k], kSensitivity[k], pixels_per_degree);
    }
    const glm::dmat3 rgb_from_xyz = glm::inverse(kXyzFromRgb);
    Image<glm::dvec3> out(blur[0].width(), blur[0].height());
    for (std::size_t i = 0; i < out.size(); ++i) {
        const glm::dvec3 c(blur[0].pixels()[i], blur[1].pixels()[i], blur[2].pixels()[i]);
        const glm::dvec3 rgb = glm::clamp(rgb_from_xyz * xyz_from_opponent(c), 0.0, 1.0);
        out.pixels()[i] = hunt_lab_from_xyz(kXyzFromRgb * rgb);
    }
    return out;
}

constexpr double kColorExponent = 0.7;

/// The paper's remapping: small differences use most of the range.
double color_error(double distance, double largest) {
    constexpr double kKnee = 0.4;     // share of the largest difference ...
    constexpr double kAtKnee = 0.95;  // ... that gets this error
    const double powered = std::pow(distance, kColorExponent);
    const double knee = kKnee * largest;
    return powered < knee
               ? kAtKnee / knee * powered
               : std::min(1.0, kAtKnee + (powered - knee) / (largest - knee) * (1 - kAtKnee));
}

/// Strengths of edges and points in the achromatic channel.
struct Features {
    Plane edges;
    Plane points;
};

Features features_of(const Prepared& prepared, double pixels_per_degree) {
    constexpr double kFeatureDegrees = 0.082;
    const double deviation = 0.5 * kFeatureDegrees * pixels_per_degree;
    const int radius = static_cast<int>(std::ceil(3 * deviation));
    const auto gauss = [&](int i) { return std::exp(-i * i / (2 * deviation * deviation)); };
    Taps smooth = make_taps(radius, gauss);
    Taps slope = make_taps(radius, [&](int i) { return -i * gauss(i); });
    Taps bend =
        make_taps(radius, [&](int i) { return (i * i / (deviation * deviation) - 1) * gauss(i); });
    const double smooth_sum = sum_of(smooth);
    for (double& t : smooth) t /= smooth_sum;
    // Positive and negative weights sum to one each.
    for (Taps* taps : {&slope, &bend}) {
        double positive = 0;
        double negative = 0;
        for (const double t : *taps) (t > 0 ? positive : negative) += std::abs(t);
        for (double& t : *taps) t /= t > 0 ? positive : std::max(negative, 1e-300);
    }
    Plane grey = prepared.opponent[0];
    for (double& v : grey.pixels()) v = (v + 16) / 116;
    const auto strength = [&](const Taps& taps) {
        Plane x = filtered(grey, taps, smooth);
        const Plane y = filtered(grey, smooth, taps);
        for (std::size_t i = 0; i < x.size(); ++i) {
            x.pixels()[i] = std::hypot(x.pixels()[i], y.pixels()[i]);
        }
        return x;
    };
    return {strength(slope), strength(bend)};
}

double largest_color_difference() {
    // Of all colours of a screen, green and blue lie farthest apart.
    const glm::dvec3 green = hunt_lab_from_xyz(kXyzFromRgb * glm::dvec3(0, 1, 0));
    const glm::dvec3 blue = hunt_lab_from_xyz(kXyzFromRgb * glm::dvec3(0, 0, 1));
    return std::pow(hyab(green, blue), kColorExponent);
}

}  // namespace

Result<FlipResult> flip_error(const Image<Rgba8>& a, const Image<Rgba8>& b,
                              const FlipOptions& options) {
    KINO_CHECK(options.pixels_per_degree > 0);
    if (a.width() != b.width() || a.height() != b.height()) {
        return fail(fmt::format("the pictures have different sizes: {}x{} and {}x{}", a.width(),
                                a.height(), b.width(), b.height()));
    }
    if (a.empty()) return fail("the pictures are empty");
    const double scale = options.pixels_per_degree;
    const Prepared prepared_a = prepare(a);
    const Prepared prepared_b = prepare(b);
    const Image<glm::dvec3> colors_a = seen_colors(prepared_a, scale);
    const Image<glm::dvec3> colors_b = seen_colors(prepared_b, scale);
    const Features features_a = features_of(prepared_a, scale);
    const Features features_b = features_of(prepared_b, scale);
    const double largest = largest_color_difference();

    FlipResult result;
    result.map.resize(a.width(), a.height());
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        const double color = color_error(hyab(colors_a.pixels()[i], colors_b.pixels()[i]), largest);
        const double edge = std::abs(features_a.edges.pixels()[i] - features_b.edges.pixels()[i]);
        const double point =
            std::abs(features_a.points.pixels()[i] - features_b.points.pixels()[i]);
        const double feature =
            std::sqrt(std::min(1.0, std::max(edge, point) / std::numbers::sqrt2));
        const double error = std::pow(color, 1 - feature);
        result.map.pixels()[i] = static_cast<float>(error);
        sum += error;
    }
    result.mean = sum / static_cast<double>(a.size());
    return result;
}

Image<Rgba8> flip_picture(const FlipResult& result) {
    constexpr std::array<glm::dvec3, 5> kRamp = {
        {{0, 0, 0}, {40, 20, 140}, {210, 30, 60}, {250, 190, 40}, {255, 255, 255}}};
    Image<Rgba8> picture(result.map.width(), result.map.height());
    for (std::size_t i = 0; i < picture.size(); ++i) {
        const double at = 4 * std::clamp(static_cast<double>(result.map.pixels()[i]), 0.0, 1.0);
        const auto step = std::min<std::size_t>(3, static_cast<std::size_t>(at));
        const glm::dvec3 c = glm::mix(kRamp[step], kRamp[step + 1], at - static_cast<double>(step));
        const auto byte = [](double v) { return static_cast<std::uint8_t>(std::lround(v)); };
        picture.pixels()[i] = {byte(c.x), byte(c.y), byte(c.z), 255};
    }
    return picture;
}

}  // namespace kino
