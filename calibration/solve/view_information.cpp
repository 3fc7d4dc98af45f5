#include "calibration/solve/view_information.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <cmath>

#include "calibration/solve/reprojection.h"

namespace kino {
namespace {

constexpr int kCount = static_cast<int>(LensInformation::kNumbers);
using Normal = Eigen::Matrix<double, kCount, kCount, Eigen::RowMajor>;

// Focal length and centre as shares of the focal length.
constexpr std::array<double, LensInformation::kNumbers> kKnownBefore = {0.33, 0.33, 0.1,  0.1,
                                                                        0.5,  1,    0.02, 0.02};

}  // namespace

LensInformation& LensInformation::operator+=(const LensInformation& other) {
    for (std::size_t i = 0; i < normal.size(); ++i) normal[i] += other.normal[i];
    return *this;
}

LensInformation view_information(const std::vector<glm::dvec2>& corners_m,
                                 const std::vector<ShotCorner>& seen, const Lens& lens,
                                 const Pose& camera_from_board) {
    Normal own = Normal::Zero();
    Eigen::Matrix<double, 6, 6> board = Eigen::Matrix<double, 6, 6>::Zero();
    Eigen::Matrix<double, kCount, 6> mixed = Eigen::Matrix<double, kCount, 6>::Zero();
    const PreparedPose pose = prepare(turned(camera_from_board));
    for (const ShotCorner& corner : seen) {
        glm::dvec2 px;
        ReprojectionJacobian j;
        if (!reproject(lens.data(), nullptr, pose, corners_m[static_cast<std::size_t>(corner.id)],
                       px, &j)) {
            continue;
        }
        for (std::size_t axis = 0; axis < 2; ++axis) {
            const Eigen::Map<const Eigen::Matrix<double, 1, kCount>> by_lens(j.lens.data() +
                                                                             12 * axis);
            const Eigen::Map<const Eigen::Matrix<double, 1, 6>> by_board(j.board.data() + 6 * axis);
            own += by_lens.transpose() * by_lens;
            mixed += by_lens.transpose() * by_board;
            board += by_board.transpose() * by_board;
        }
    }
    LensInformation out;
    if (!(board.trace() > 0)) return out;
    const Eigen::LDLT<Eigen::Matrix<double, 6, 6>> solver(board);
    Eigen::Map<Normal>(out.normal.data()) = own - mixed * solver.solve(mixed.transpose());
    return out;
}

std::array<double, LensInformation::kNumbers> expected_deviations(
    const LensInformation& information, const Lens& lens, double noise_px) {
    Normal normal = Eigen::Map<const Normal>(information.normal.data()) / (noise_px * noise_px);
    for (int i = 0; i < kCount; ++i) {
        const double known =
            kKnownBefore[static_cast<std::size_t>(i)] * (i < 4 ? std::abs(lens[0]) : 1);
        normal(i, i) += 1 / (known * known);
    }
    const Normal covariance = Eigen::LDLT<Normal>(normal).solve(Normal::Identity());
    std::array<double, LensInformation::kNumbers> out{};
    for (int i = 0; i < kCount; ++i) {
        out[static_cast<std::size_t>(i)] = std::sqrt(std::max(0.0, covariance(i, i)));
    }
    return out;
}

double expected_fall(const LensInformation& before, const LensInformation& view, const Lens& lens,
                     double noise_px) {
    LensInformation sum = before;
    sum += view;
    const auto old_deviations = expected_deviations(before, lens, noise_px);
    const auto new_deviations = expected_deviations(sum, lens, noise_px);
    double fall = 0;
    for (std::size_t i = 0; i < LensInformation::kNumbers; ++i) {
        fall += 1 - new_deviations[i] / old_deviations[i];
    }
    return fall / static_cast<double>(LensInformation::kNumbers);
}

}  // namespace kino
