#include "tests/reference/edge_reference.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <vector>

namespace kino::reference {
namespace {

constexpr double kMostDepth = 1e4;  // in powers of two
constexpr double kForeignObject = 1e4;
constexpr double kEmpty = 2e4;

bool is_something(double z) {
    return z > 0 && z < 1e9;
}

glm::dvec2 foreshortened(const glm::dvec3& n) {
    return glm::dvec2(n) / std::max(-n.z, 0.05);
}

glm::dvec3 ray_of(double x, double y, const LodRules& rules) {
    return {(x - rules.cx) / rules.fx, (y - rules.cy) / rules.fy, 1};
}

/// Quadratic B-spline, by its pieces.
double spline(double d) {
    const double a = std::abs(d);
    if (a < 0.5) return 0.75 - a * a;
    return a < 1.5 ? 0.5 * (1.5 - a) * (1.5 - a) : 0.0;
}

/// Minus the logarithm to base 2 of Eq. 1's two range weights.
double exponent(const EdgeSurface& i, glm::dvec2 at_i, const EdgeSurface& j, glm::dvec2 at_j,
                const LodRules& rules) {
    const double ln2 = std::log(2.0);
    const double zi = is_something(i.z) ? i.z : 1.0;
    const double zj = is_something(j.z) ? j.z : 1.0;
    double e = 0;
    if (std::isfinite(rules.sigma_z)) {
        double d = zi - zj;
        if (rules.metric == LodMetric::log_depth) d = std::log(zi / zj);
        if (rules.metric == LodMetric::plane) {
            d = glm::dot(i.normal,
                         ray_of(at_i.x, at_i.y, rules) * zi - ray_of(at_j.x, at_j.y, rules) * zj) /
                zi;
        }
        e = is_something(j.z)
                ? std::min(d * d / (2 * rules.sigma_z * rules.sigma_z * ln2), kMostDepth)
                : kEmpty;
    }
    if (std::isfinite(rules.sigma_n)) {
        const glm::dvec2 apart = foreshortened(i.normal) - foreshortened(j.normal);
        e += glm::dot(apart, apart) / (2 * rules.sigma_n * rules.sigma_n * ln2);
    }
    if (i.object != j.object) e += kForeignObject;
    return e;
}

double curve(double c) {
    return c <= 0.7 ? c : 0.7 + 0.3 * (c - 0.7) / (c - 0.7 + 0.3);
}

double curve_back(double c) {
    if (c <= 0.7) return c;
    const double t = std::min((c - 0.7) / 0.3, 0.9995);
    return 0.7 + 0.3 * t / (1 - t);
}

}  // namespace

double edge_excess(const EdgeSurface& centre, const std::array<EdgeSurface, 4>& samples, double x,
                   double y, const LodRules& rules) {
    double most = 0;
    for (const EdgeSurface& s : samples) {
        if (s.object != centre.object || is_something(s.z) != is_something(centre.z)) {
            return std::numeric_limits<double>::infinity();
        }
        if (!is_something(s.z)) continue;
        const glm::dvec3 ray = ray_of(x, y, rules);
        const double off = std::abs(glm::dot(centre.normal, ray * (s.z - centre.z))) / centre.z;
        const double turned = glm::length(foreshortened(s.normal) - foreshortened(centre.normal));
        most = std::max({most, off / (2 * rules.sigma_z), turned / (2 * rules.sigma_n)});
    }
    return most;
}

glm::dvec4 edge_color(const Image<glm::dvec3>& picture, const Image<EdgeSurface>& surface,
                      const std::array<EdgeSurface, 4>& samples, int x, int y,
                      const EdgeRules& rules) {
    const auto floored = [&](const glm::dvec3& own) {
        return rules.lod.fine_grained ? glm::max(own, glm::dvec3(rules.least_albedo))
                                      : glm::dvec3(1);
    };
    glm::dvec3 sum(0);
    double alpha = 0;
    for (std::size_t s = 0; s < samples.size(); ++s) {
        const EdgeSurface& sample = samples[s];
        glm::dvec3 color = sample.own;
        if (sample.covered || !std::isfinite(rules.lod.sigma_z)) {
            std::vector<double> e, f;
            std::vector<glm::dvec3> light;
            for (int j = y - 1; j <= y + 1; ++j) {
                for (int i = x - 1; i <= x + 1; ++i) {
                    const int u = std::clamp(i, 0, picture.width() - 1);
                    const int v = std::clamp(j, 0, picture.height() - 1);
                    const EdgeSurface& other = surface.at(u, v);
                    glm::dvec3 seen = picture.at(u, v);
                    for (int k = 0; k < 3; ++k) {
                        seen[k] = std::isnan(seen[k]) ? 0.0 : std::clamp(seen[k], 0.0, 65000.0);
                    }
                    f.push_back(spline(i - (x + kFourSamples[s][0])) *
                                spline(j - (y + kFourSamples[s][1])));
                    e.push_back(exponent(sample, {x, y}, other, {u, v}, rules.lod));
                    light.push_back((seen - other.emission) / floored(other.own));
                }
            }
            const double least = *std::min_element(e.begin(), e.end());
            glm::dvec3 mixed(0);
            double weights = 0;
            for (std::size_t k = 0; k < e.size(); ++k) {
                const double w = f[k] * std::exp2(least - e[k]);
                mixed += w * light[k];
                weights += w;
            }
            color =
                glm::max(mixed / weights * floored(sample.own) + sample.emission, glm::dvec3(0));
        }
        for (int k = 0; k < 3; ++k) {
            double c = color[k] * (sample.covered ? rules.exposure : 1.0);
            if (rules.as_shown) {
                c = rules.tone_map && sample.covered ? curve(c) : std::clamp(c, 0.0, 1.0);
            }
            sum[k] += c / 4;
        }
        alpha += sample.covered ? 0.25 : 0;
    }
    if (alpha > 0) {
        for (int k = 0; k < 3; ++k) {
            if (rules.as_shown && rules.tone_map) sum[k] = curve_back(sum[k]);
            sum[k] /= rules.exposure;
        }
    }
    return {sum, alpha > 0 ? 1.0 : 0.0};
}

}  // namespace kino::reference
