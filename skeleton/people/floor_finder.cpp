#include "skeleton/people/floor_finder.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

namespace kino {
namespace {

constexpr int kThin = 4;                // every fourth cell of a row and a column votes
constexpr int kReach = 4;               // cells to each side over which a slope is measured
constexpr float kNormalNoiseDeg = 15;   // of such a slope
constexpr float kFewestShare = 0.015f;  // of the picture's cells, to believe in a floor
constexpr float kSureShare = 0.08f;
constexpr std::size_t kFewestVotes = 40;

float radians(float degrees) {
    return degrees * 0.017453292f;
}

// SplitMix64, as in Steele, Lea & Flood 2014: the same on every machine.
std::uint64_t next_bits(std::uint64_t& state) {
    state += 0x9E3779B97F4A7C15u;
    std::uint64_t z = state;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
    return z ^ (z >> 31);
}

std::optional<FloorPlane> through(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
    const glm::vec3 n = glm::cross(b - a, c - a);
    const float length = glm::length(n);
    if (!(length > 0.02f)) return std::nullopt;  // m^2: near one line says little
    FloorPlane plane;
    plane.up = n / length;
    plane.height_m = -glm::dot(plane.up, a);
    if (plane.height_m < 0) {  // the camera is above its floor
        plane.up = -plane.up;
        plane.height_m = -plane.height_m;
    }
    return plane;
}

}  // namespace

float FloorFinder::band_m(const FloorPlane& plane, float z) const {
    // A ray meets the floor at a slope of height / distance, so noise along it of k z^2 lifts a
    // point by k z height.
    return 0.015f + 3 * options_.noise_per_m * z * plane.height_m;
}

FloorFinder::Score FloorFinder::score(const FloorPlane& plane) const {
    Score s;
    for (const glm::vec3& p : points_) {
        const float h = glm::dot(plane.up, p) + plane.height_m;
        s.below += h < -2 * band_m(plane, p.z) ? 1 : 0;
    }
    for (const glm::vec3& p : level_) {
        const float h = glm::dot(plane.up, p) + plane.height_m;
        s.inliers += std::abs(h) <= band_m(plane, p.z) ? 1 : 0;
    }
    s.value = static_cast<float>(s.inliers) - 1.5f * static_cast<float>(s.below);
    return s;
}

void FloorFinder::gather(const DepthGrid& grid, const glm::vec3& prior, float within_rad) {
    points_.clear();
    level_.clear();
    const int width = grid.width();
    const float least = std::cos(std::min(within_rad + radians(kNormalNoiseDeg), radians(75)));
    for (int y = kThin / 2; y < grid.height(); y += kThin) {
        for (int x = kThin / 2; x < width; x += kThin) {
            const auto cell = static_cast<std::size_t>(y * width + x);
            if (grid.z_m().data()[cell] == 0) continue;
            points_.push_back(grid.point(cell));
            if (x < kReach || y < kReach || x + kReach >= width || y + kReach >= grid.height()) {
                continue;
            }
            const auto side = static_cast<std::size_t>(kReach);
            const auto line = side * static_cast<std::size_t>(width);
            const float* z = grid.z_m().data();
            if (z[cell - side] == 0 || z[cell + side] == 0 || z[cell - line] == 0 ||
                z[cell + line] == 0) {
                continue;
            }
            const glm::vec3 normal = glm::cross(grid.point(cell + line) - grid.point(cell - line),
                                                grid.point(cell + side) - grid.point(cell - side));
            if (glm::dot(normal, prior) >= least * glm::length(normal)) {
                level_.push_back(points_.back());
            }
        }
    }
}

bool FloorFinder::allowed(const FloorPlane& plane, const glm::vec3& prior, float cosine) const {
    return glm::dot(plane.up, prior) >= cosine && plane.height_m >= options_.min_camera_height_m &&
           plane.height_m <= options_.max_camera_height_m;
}

std::optional<FloorPlane> FloorFinder::refine(const FloorPlane& plane) const {
    // n.P + h = 0 with P = z r gives 1/z = -(n.r)/h: least squares of 1/z in the ray r.
    glm::dmat3 sum(0.0);
    glm::dvec3 right(0.0);
    int count = 0;
    for (const glm::vec3& p : level_) {
        if (std::abs(glm::dot(plane.up, p) + plane.height_m) > band_m(plane, p.z)) continue;
        const auto z = static_cast<double>(p.z);
        const glm::dvec3 ray = glm::dvec3(p) / z;
        sum += glm::outerProduct(ray, ray);
        right += ray / z;
        ++count;
    }
    if (count < 30) return std::nullopt;
    const double determinant = glm::determinant(sum);
    if (!(std::abs(determinant) > 1e-9 * count)) return std::nullopt;
    const glm::dvec3 m = -(glm::inverse(sum) * right);
    const double length = glm::length(m);
    if (!(length > 1e-6)) return std::nullopt;
    FloorPlane fine;
    fine.up = glm::vec3(m / length);
    fine.height_m = static_cast<float>(1 / length);
    return fine;
}

FloorPlane FloorFinder::find(const DepthGrid& grid, const std::optional<glm::vec3>& gravity_up,
                             TimeNs time) {
    const glm::vec3 prior = gravity_up.value_or(glm::vec3(0, -1, 0));
    const float cosine =
        std::cos(radians(gravity_up ? options_.gravity_within_deg : options_.max_tilt_deg));
    FloorPlane none;
    none.up = prior;

    gather(grid, prior, std::acos(cosine));
    std::optional<FloorPlane> best;
    Score best_score;
    const auto consider = [&](const FloorPlane& plane) {
        if (!allowed(plane, prior, cosine)) return;
        const Score s = score(plane);
        if (!best || s.value > best_score.value) {
            best = plane;
            best_score = s;
        }
    };
    if (level_.size() >= kFewestVotes) {
        if (last_) consider(*last_);
        std::uint64_t random = 1;
        const auto pick = [&] { return level_[next_bits(random) % level_.size()]; };
        for (int round = 0; round < options_.rounds; ++round) {
            const glm::vec3 a = pick(), b = pick(), c = pick();
            if (const auto plane = through(a, b, c)) consider(*plane);
        }
    }
    for (int pass = 0; best && pass < 3; ++pass) {
        const auto fine = refine(*best);
        if (fine && allowed(*fine, prior, cosine)) best = fine;
    }
    if (best) best_score = score(*best);
    const float votes =
        static_cast<float>(grid.width() * grid.height()) / static_cast<float>(kThin * kThin);
    const float share = static_cast<float>(best_score.inliers) / votes;
    if (!best || share < kFewestShare || best_score.value <= 0) {
        last_.reset();
        return none;
    }
    const bool agrees = last_ && glm::dot(last_->up, best->up) > std::cos(radians(2)) &&
                        std::abs(last_->height_m - best->height_m) < 0.06f;
    if (agrees) {
        const double dt = to_seconds(std::max<TimeNs>(time - last_time_, 0));
        const auto w = static_cast<float>(1 - std::exp(-dt / std::max(options_.smooth_s, 1e-9)));
        best->up = glm::normalize(glm::mix(last_->up, best->up, w));
        best->height_m = glm::mix(last_->height_m, best->height_m, w);
    }
    const float clean = 1 - static_cast<float>(best_score.below) /
                                static_cast<float>(best_score.inliers + best_score.below);
    best->confidence = std::min(share / kSureShare, 1.0f) * clean;
    last_ = best;
    last_time_ = time;
    return *best;
}

}  // namespace kino
