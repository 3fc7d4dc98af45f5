#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "calibration/solve/bundle.h"
#include "calibration/solve/reprojection.h"

namespace kino {
namespace {

// With columns scaled to length one, an eigenvalue under this is a direction without information.
constexpr double kSingular = 1e-12;

struct Columns {
    std::vector<std::array<int, 12>> lenses;  // -1: held
    int rig = -1;
    int count = 0;
};

Columns columns_of(const Shots& shots, const BundleFreedom& freedom) {
    Columns out;
    for (const auto& lens : freedom.lenses) {
        auto& places = out.lenses.emplace_back();
        for (std::size_t i = 0; i < 12; ++i) places[i] = lens[i] ? out.count++ : -1;
    }
    if (shots.cameras.size() == 2 && freedom.rig) {
        out.rig = out.count;
        out.count += 6;
    }
    return out;
}

// The part of the normal equations that a view's boards leave to the shared numbers.
void add_view(const Shots& shots, const BundleState& state, std::size_t view,
              const Columns& columns, double huber_px, Eigen::MatrixXd& normal) {
    Eigen::Matrix<double, 6, 6> own = Eigen::Matrix<double, 6, 6>::Zero();
    Eigen::MatrixXd mixed = Eigen::MatrixXd::Zero(columns.count, 6);
    std::vector<std::pair<int, double>> row;
    const PreparedPose second = prepare(state.second_from_first);
    const PreparedPose board_pose = prepare(state.boards[view]);
    for (std::size_t c = 0; c < shots.cameras.size(); ++c) {
        const PreparedPose* camera = c == 1 ? &second : nullptr;
        for (const ShotCorner& corner : shots.cameras[c].views[view]) {
            glm::dvec2 px;
            ReprojectionJacobian j;
            if (!reproject(state.lenses[c].data(), camera, board_pose,
                           shots.corners_m[static_cast<std::size_t>(corner.id)], px, &j)) {
                continue;
            }
            const double length = glm::length(px - corner.px);
            const double weight = huber_px > 0 && length > huber_px ? huber_px / length : 1;
            for (std::size_t axis = 0; axis < 2; ++axis) {
                row.clear();
                for (std::size_t i = 0; i < 12; ++i) {
                    if (columns.lenses[c][i] >= 0) {
                        row.emplace_back(columns.lenses[c][i], j.lens[12 * axis + i]);
                    }
                }
                if (camera && columns.rig >= 0) {
                    for (int i = 0; i < 6; ++i) {
                        row.emplace_back(columns.rig + i,
                                         j.camera[6 * axis + static_cast<std::size_t>(i)]);
                    }
                }
                const Eigen::Map<const Eigen::Matrix<double, 1, 6>> board(j.board.data() +
                                                                          6 * axis);
                own += weight * board.transpose() * board;
                for (const auto& [a, value] : row) {
                    mixed.row(a) += weight * value * board;
                    for (const auto& [b, other] : row) normal(a, b) += weight * value * other;
                }
            }
        }
    }
    const Eigen::LDLT<Eigen::Matrix<double, 6, 6>> solver(own);
    normal -= mixed * solver.solve(mixed.transpose());
}

}  // namespace

BundleDeviations bundle_deviations(const Shots& shots, const BundleResult& result,
                                   const BundleFreedom& freedom, const BundleOptions& options) {
    const Columns columns = columns_of(shots, freedom);
    BundleDeviations out;
    out.lenses.resize(shots.cameras.size());
    if (columns.count == 0) return out;
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(columns.count, columns.count);
    const double huber_px = options.huber_sigmas * result.sigma_px;
    for (std::size_t view = 0; view < shots.names.size(); ++view) {
        add_view(shots, result.state, view, columns, huber_px, normal);
    }
    Eigen::VectorXd scale(columns.count);
    for (int i = 0; i < columns.count; ++i)
        scale(i) = 1 / std::sqrt(std::max(1e-300, normal(i, i)));
    const Eigen::MatrixXd scaled = scale.asDiagonal() * normal * scale.asDiagonal();
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scaled);
    Eigen::VectorXd variance = Eigen::VectorXd::Zero(columns.count);
    std::vector<bool> lost(static_cast<std::size_t>(columns.count), false);
    for (int i = 0; i < columns.count; ++i) {
        const auto direction = eigen.eigenvectors().col(i);
        const double value = std::max(eigen.eigenvalues()(i), 1e-15);
        variance += direction.cwiseAbs2() / value;
        if (eigen.eigenvalues()(i) > kSingular) continue;
        Eigen::Index largest = 0;
        direction.cwiseAbs().maxCoeff(&largest);
        lost[static_cast<std::size_t>(largest)] = true;
    }
    const auto deviation = [&](int column) {
        return result.sigma_px * scale(column) * std::sqrt(variance(column));
    };
    for (std::size_t c = 0; c < shots.cameras.size(); ++c) {
        for (std::size_t i = 0; i < 12; ++i) {
            const int column = columns.lenses[c][i];
            if (column < 0) continue;
            out.lenses[c][i] = deviation(column);
            if (lost[static_cast<std::size_t>(column)]) out.undetermined.push_back({c, i});
        }
    }
    for (int i = 0; columns.rig >= 0 && i < 6; ++i) {
        out.rig[static_cast<std::size_t>(i)] = deviation(columns.rig + i);
        if (lost[static_cast<std::size_t>(columns.rig + i)]) {
            out.undetermined.push_back({shots.cameras.size(), static_cast<std::size_t>(i)});
        }
    }
    return out;
}

}  // namespace kino
