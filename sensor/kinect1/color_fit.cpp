#include "sensor/kinect1/color_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <utility>
#include <vector>

namespace kino::kinect1 {
namespace {

constexpr std::size_t kCount = 14;
using Vector = std::array<double, kCount>;
using Matrix = std::array<Vector, kCount>;
enum Index : std::size_t { kFx, kFy, kCx, kCy, kK1, kK2, kP1, kP2, kRx, kRy, kRz, kTx, kTy, kTz };

struct Sample {
    glm::dvec3 point;  // in depth camera axes
    glm::dvec2 pixel;
};

glm::dquat rotation_of(const Vector& v) {
    const glm::dvec3 axis(v[kRx], v[kRy], v[kRz]);
    const double angle = glm::length(axis);
    return angle < 1e-12 ? glm::dquat(1, 0, 0, 0) : glm::angleAxis(angle, axis / angle);
}

// base/camera_model.h's model, OpenCV's order of terms.
glm::dvec2 project(const Vector& v, const glm::dquat& rotation, const glm::dvec3& point) {
    const glm::dvec3 p = rotation * point + glm::dvec3(v[kTx], v[kTy], v[kTz]);
    const double x = p.x / p.z;
    const double y = p.y / p.z;
    const double s = x * x + y * y;
    const double g = 1 + s * (v[kK1] + s * v[kK2]);
    const double xd = g * x + 2 * v[kP1] * x * y + v[kP2] * (s + 2 * x * x);
    const double yd = g * y + v[kP1] * (s + 2 * y * y) + 2 * v[kP2] * x * y;
    return {v[kFx] * xd + v[kCx], v[kFy] * yd + v[kCy]};
}

// How far from its expected value an unknown may stray for the price of one pixel at one sample.
struct Expectation {
    Vector mean{};
    Vector spread{};
};

double cost(const Vector& v, const std::vector<Sample>& samples, const Expectation& expected) {
    const glm::dquat rotation = rotation_of(v);
    double sum = 0;
    for (const Sample& s : samples) {
        const glm::dvec2 off = project(v, rotation, s.point) - s.pixel;
        sum += glm::dot(off, off);
    }
    for (std::size_t i = 0; i < kCount; ++i) {
        if (expected.spread[i] == 0) continue;
        const double off = (v[i] - expected.mean[i]) / expected.spread[i];
        sum += off * off;
    }
    return sum;
}

struct NormalEquations {
    Matrix a{};
    Vector b{};
};

NormalEquations linearise(const Vector& v, const std::vector<Sample>& samples,
                          const Expectation& expected) {
    // Steps that move a pixel by about 1e-4.
    constexpr Vector kStep = {1e-4, 1e-4, 1e-4, 1e-4, 1e-6, 1e-6, 1e-7,
                              1e-7, 1e-7, 1e-7, 1e-7, 1e-7, 1e-7, 1e-7};
    std::array<std::pair<Vector, glm::dquat>, kCount> moved;
    for (std::size_t i = 0; i < kCount; ++i) {
        moved[i].first = v;
        moved[i].first[i] += kStep[i];
        moved[i].second = rotation_of(moved[i].first);
    }
    const glm::dquat rotation = rotation_of(v);
    NormalEquations n;
    for (const Sample& s : samples) {
        const glm::dvec2 here = project(v, rotation, s.point);
        const glm::dvec2 off = s.pixel - here;
        std::array<glm::dvec2, kCount> slope;
        for (std::size_t i = 0; i < kCount; ++i) {
            slope[i] = (project(moved[i].first, moved[i].second, s.point) - here) / kStep[i];
        }
        for (std::size_t i = 0; i < kCount; ++i) {
            n.b[i] += glm::dot(slope[i], off);
            for (std::size_t k = 0; k <= i; ++k) n.a[i][k] += glm::dot(slope[i], slope[k]);
        }
    }
    for (std::size_t i = 0; i < kCount; ++i) {
        if (expected.spread[i] == 0) continue;
        const double weight = 1 / (expected.spread[i] * expected.spread[i]);
        n.a[i][i] += weight;
        n.b[i] += weight * (expected.mean[i] - v[i]);
    }
    return n;
}

// Cholesky; only the lower triangle of `a` is read. False where it is not positive definite.
bool solve(Matrix a, const Vector& b, Vector& x) {
    for (std::size_t i = 0; i < kCount; ++i) {
        for (std::size_t k = 0; k <= i; ++k) {
            double sum = a[i][k];
            for (std::size_t j = 0; j < k; ++j) sum -= a[i][j] * a[k][j];
            if (k < i) {
                a[i][k] = sum / a[k][k];
            } else if (sum > 0) {
                a[i][i] = std::sqrt(sum);
            } else {
                return false;
            }
        }
    }
    for (std::size_t i = 0; i < kCount; ++i) {
        double sum = b[i];
        for (std::size_t j = 0; j < i; ++j) sum -= a[i][j] * x[j];
        x[i] = sum / a[i][i];
    }
    for (std::size_t i = kCount; i-- > 0;) {
        double sum = x[i];
        for (std::size_t j = i + 1; j < kCount; ++j) sum -= a[j][i] * x[j];
        x[i] = sum / a[i][i];
    }
    return true;
}

std::vector<Sample> sample(const PixelMap& map, const CameraModel& depth, int width, int height) {
    constexpr int kColumns = 21;
    constexpr int kRows = 16;
    constexpr double kMarginPx = 16;
    std::vector<Sample> out;
    for (const double z : {0.5, 0.8, 1.2, 2.0, 8.0}) {
        for (int r = 0; r < kRows; ++r) {
            for (int c = 0; c < kColumns; ++c) {
                const int x = c * (depth.width - 1) / (kColumns - 1);
                const int y = r * (depth.height - 1) / (kRows - 1);
                const glm::dvec2 pixel = map(x, y, z);
                if (!(pixel.x > -kMarginPx && pixel.x < width + kMarginPx && pixel.y > -kMarginPx &&
                      pixel.y < height + kMarginPx)) {
                    continue;
                }
                const glm::dvec3 ray((x - depth.cx) / depth.fx, (y - depth.cy) / depth.fy, 1);
                out.push_back({ray * z, pixel});
            }
        }
    }
    return out;
}

}  // namespace

ColorFit fit_color_camera(const PixelMap& map, const CameraModel& depth, int width, int height,
                          double baseline_m) {
    constexpr int kMaxRounds = 60;
    constexpr double kRotationSpread = 0.0175;  // a degree
    constexpr double kOffBaselineM = 0.003;
    const std::vector<Sample> samples = sample(map, depth, width, height);

    Vector v{};
    v[kFx] = v[kFy] = 525.0 * width / 640;
    v[kCx] = (width - 1) / 2.0;
    v[kCy] = (height - 1) / 2.0;
    v[kTx] = -baseline_m;
    Expectation expected;
    expected.mean[kTx] = v[kTx];
    for (const std::size_t i : {kRx, kRy, kRz}) expected.spread[i] = kRotationSpread;
    for (const std::size_t i : {kTx, kTy, kTz}) expected.spread[i] = kOffBaselineM;
    for (const std::size_t i : {kP1, kP2}) expected.spread[i] = 0.01;
    for (const std::size_t i : {kK1, kK2}) expected.spread[i] = 1;

    double best = cost(v, samples, expected);
    double damping = 1e-3;
    for (int round = 0; round < kMaxRounds && damping < 1e12; ++round) {
        const NormalEquations n = linearise(v, samples, expected);
        const double before = best;
        for (; damping < 1e12; damping *= 10) {
            Matrix a = n.a;
            for (std::size_t i = 0; i < kCount; ++i) a[i][i] *= 1 + damping;
            Vector step{};
            if (!solve(a, n.b, step)) continue;
            Vector next = v;
            for (std::size_t i = 0; i < kCount; ++i) next[i] += step[i];
            const double reached = cost(next, samples, expected);
            if (reached < best) {
                best = reached;
                v = next;
                damping = std::max(damping / 10, 1e-9);
                break;
            }
        }
        if (before - best <= 1e-10 * before) break;
    }

    ColorFit out;
    out.color = {.width = width,
                 .height = height,
                 .fx = v[kFx],
                 .fy = v[kFy],
                 .cx = v[kCx],
                 .cy = v[kCy],
                 .k1 = v[kK1],
                 .k2 = v[kK2],
                 .p1 = v[kP1],
                 .p2 = v[kP2]};
    out.color_from_depth = {glm::normalize(rotation_of(v)), {v[kTx], v[kTy], v[kTz]}};
    double sum = 0;
    for (const Sample& s : samples) {
        const glm::dvec2 off = project(v, out.color_from_depth.rotation, s.point) - s.pixel;
        sum += glm::dot(off, off);
        out.max_px = std::max(out.max_px, glm::length(off));
    }
    // A map that leads nowhere near the picture fits nothing.
    const bool enough = samples.size() >= 500 && std::isfinite(sum);
    out.rms_px = enough ? std::sqrt(sum / static_cast<double>(samples.size())) : 1e9;
    if (!enough) out.max_px = 1e9;
    return out;
}

}  // namespace kino::kinect1
