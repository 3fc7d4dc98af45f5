#include "calibration/solve/plane_check.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <map>

#include "base/check.h"

namespace kino {
namespace {

constexpr int kTile = 32;
constexpr double kFilled = 0.9;
constexpr double kSteps = 4;
constexpr double kBandM = 0.25;
constexpr int kLeastParts = 5;

}  // namespace

std::vector<FlatPart> flat_parts(const Image<float>& depth_m, const Image<RayXy>& rays) {
    KINO_CHECK_EQ(depth_m.width(), rays.width());
    KINO_CHECK_EQ(depth_m.height(), rays.height());
    std::vector<FlatPart> out;
    std::vector<Eigen::Vector3d> points;
    std::vector<double> depths;
    for (int top = 0; top + kTile <= depth_m.height(); top += kTile) {
        for (int left = 0; left + kTile <= depth_m.width(); left += kTile) {
            points.clear();
            depths.clear();
            Eigen::Vector3d sum = Eigen::Vector3d::Zero();
            for (int y = top; y < top + kTile; ++y) {
                for (int x = left; x < left + kTile; ++x) {
                    const double z = depth_m.at(x, y);
                    const RayXy ray = rays.at(x, y);
                    if (!(z > 0) || std::isnan(ray.x)) continue;
                    points.emplace_back(z * ray.x, z * ray.y, z);
                    depths.push_back(z);
                    sum += points.back();
                }
            }
            if (static_cast<double>(points.size()) < kFilled * kTile * kTile) continue;
            const auto count = static_cast<double>(points.size());
            const Eigen::Vector3d mean = sum / count;
            Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
            for (const auto& p : points) spread += (p - mean) * (p - mean).transpose();
            const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(spread);
            const Eigen::Vector3d normal = eigen.eigenvectors().col(0);
            double worst = 0;
            double squares = 0;
            for (const auto& p : points) {
                const double off = std::abs(normal.dot(p - mean));
                worst = std::max(worst, off);
                squares += off * off;
            }
            const auto middle = depths.begin() + static_cast<std::ptrdiff_t>(depths.size() / 2);
            std::nth_element(depths.begin(), middle, depths.end());
            const double distance = *middle;
            if (worst > kSteps * Rig::quantisation_step_m(static_cast<float>(distance))) continue;
            out.push_back(
                {distance, 1000 * std::sqrt(squares / count), static_cast<int>(points.size())});
        }
    }
    return out;
}

std::vector<PlaneBand> by_distance(const std::vector<FlatPart>& parts) {
    std::map<int, PlaneBand> bands;
    for (const FlatPart& part : parts) {
        PlaneBand& band = bands[static_cast<int>(part.distance_m / kBandM)];
        ++band.planes;
        band.distance_m += part.distance_m;
        band.rms_mm += part.rms_mm * part.rms_mm;
    }
    std::vector<PlaneBand> out;
    for (auto& [key, band] : bands) {
        if (band.planes < kLeastParts) continue;
        band.distance_m /= band.planes;
        band.rms_mm = std::sqrt(band.rms_mm / band.planes);
        out.push_back(band);
    }
    return out;
}

}  // namespace kino
