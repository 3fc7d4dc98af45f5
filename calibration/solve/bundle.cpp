#include "calibration/solve/bundle.h"

#include <ceres/ceres.h>
#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "base/check.h"
#include "calibration/solve/reprojection.h"

namespace kino {
namespace {

// The first phase does not know the noise yet.
constexpr double kFirstHuberPx = 2;
constexpr double kLeastSigmaPx = 1e-6;
constexpr double kRough = 1e-4;  // enough to know the noise
constexpr double kFine = 1e-10;

// The poses of one evaluation, each prepared once for all corners.
class PreparedPoses : public ceres::EvaluationCallback {
  public:
    explicit PreparedPoses(const BundleState& state) : state_(state), boards_(state.boards.size()) {
        update();
    }
    void PrepareForEvaluation(bool, bool new_point) override {
        if (new_point) update();
    }
    [[nodiscard]] const PreparedPose* board(std::size_t view) const { return &boards_[view]; }
    [[nodiscard]] const PreparedPose* second() const { return &second_; }

  private:
    void update() {
        second_ = prepare(state_.second_from_first);
        std::transform(state_.boards.begin(), state_.boards.end(), boards_.begin(), prepare);
    }
    const BundleState& state_;
    std::vector<PreparedPose> boards_;
    PreparedPose second_{};
};

class CornerCost : public ceres::CostFunction {
  public:
    /// `second` null: the first camera. Both must outlive the cost and hold what the parameters
    /// say.
    CornerCost(const glm::dvec2& corner_m, const glm::dvec2& px, const PreparedPose* board,
               const PreparedPose* second)
        : corner_m_(corner_m), px_(px), board_(board), second_(second) {
        set_num_residuals(2);
        *mutable_parameter_block_sizes() =
            second ? std::vector<int>{12, 6, 6} : std::vector<int>{12, 6};
    }

    bool Evaluate(double const* const* parameters, double* residuals,
                  double** jacobians) const override {
        ReprojectionJacobian jacobian;
        glm::dvec2 px;
        if (!reproject(parameters[0], second_, *board_, corner_m_, px,
                       jacobians ? &jacobian : nullptr)) {
            return false;
        }
        residuals[0] = px.x - px_.x;
        residuals[1] = px.y - px_.y;
        if (!jacobians) return true;
        if (jacobians[0]) std::copy(jacobian.lens.begin(), jacobian.lens.end(), jacobians[0]);
        if (jacobians[1]) std::copy(jacobian.board.begin(), jacobian.board.end(), jacobians[1]);
        if (second_ && jacobians[2]) {
            std::copy(jacobian.camera.begin(), jacobian.camera.end(), jacobians[2]);
        }
        return true;
    }

  private:
    glm::dvec2 corner_m_;
    glm::dvec2 px_;
    const PreparedPose* board_;
    const PreparedPose* second_;
};

class Progress : public ceres::IterationCallback {
  public:
    Progress(const BundleOptions& options, std::size_t corners, int before)
        : options_(options), corners_(static_cast<double>(corners)), before_(before) {}
    ceres::CallbackReturnType operator()(const ceres::IterationSummary& summary) override {
        if (options_.progress) {
            options_.progress(before_ + summary.iteration, std::sqrt(2 * summary.cost / corners_));
        }
        return ceres::SOLVER_CONTINUE;
    }

  private:
    const BundleOptions& options_;
    double corners_;
    int before_;
};

std::size_t corner_count(const Shots& shots) {
    std::size_t count = 0;
    for (const CameraShots& camera : shots.cameras) {
        for (const auto& view : camera.views) count += view.size();
    }
    return count;
}

// huber_px 0: squared loss; `tolerance`: least relative gain of a step. Returns the iterations.
Result<int> minimise(const Shots& shots, BundleState& state, const BundleFreedom& freedom,
                     const BundleOptions& options, double huber_px, double tolerance, int before) {
    ceres::Problem::Options problem_options;
    problem_options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    problem_options.disable_all_safety_checks = true;
    PreparedPoses poses(state);
    problem_options.evaluation_callback = &poses;
    ceres::HuberLoss huber(huber_px > 0 ? huber_px : 1);
    ceres::Problem problem(problem_options);
    for (std::size_t c = 0; c < shots.cameras.size(); ++c) {
        double* lens = state.lenses[c].data();
        const auto& views = shots.cameras[c].views;
        for (std::size_t view = 0; view < views.size(); ++view) {
            for (const ShotCorner& corner : views[view]) {
                auto* cost =
                    new CornerCost(shots.corners_m[static_cast<std::size_t>(corner.id)], corner.px,
                                   poses.board(view), c == 1 ? poses.second() : nullptr);
                std::vector<double*> blocks = {lens, state.boards[view].data()};
                if (c == 1) blocks.push_back(state.second_from_first.data());
                problem.AddResidualBlock(cost, huber_px > 0 ? &huber : nullptr, blocks);
            }
        }
        if (!problem.HasParameterBlock(lens)) continue;
        std::vector<int> held;
        for (int i = 0; i < 12; ++i) {
            if (!freedom.lenses[c][static_cast<std::size_t>(i)]) held.push_back(i);
        }
        if (held.size() == 12) {
            problem.SetParameterBlockConstant(lens);
        } else if (!held.empty()) {
            problem.SetManifold(lens, new ceres::SubsetManifold(12, held));
        }
    }
    if (!freedom.rig && problem.HasParameterBlock(state.second_from_first.data())) {
        problem.SetParameterBlockConstant(state.second_from_first.data());
    }
    ceres::Solver::Options solver;
    solver.linear_solver_type = ceres::DENSE_SCHUR;
    solver.linear_solver_ordering = std::make_shared<ceres::ParameterBlockOrdering>();
    for (TurnedPose& board : state.boards) {
        if (problem.HasParameterBlock(board.data())) {
            solver.linear_solver_ordering->AddElementToGroup(board.data(), 0);
        }
    }
    for (Lens& lens : state.lenses) {
        if (problem.HasParameterBlock(lens.data())) {
            solver.linear_solver_ordering->AddElementToGroup(lens.data(), 1);
        }
    }
    if (problem.HasParameterBlock(state.second_from_first.data())) {
        solver.linear_solver_ordering->AddElementToGroup(state.second_from_first.data(), 1);
    }
    solver.max_num_iterations = options.max_iterations;
    solver.function_tolerance = tolerance;
    solver.gradient_tolerance = 1e-12;
    solver.parameter_tolerance = 1e-12;
    solver.num_threads = 1;
    solver.logging_type = ceres::SILENT;
    Progress progress(options, corner_count(shots), before);
    solver.callbacks.push_back(&progress);
    // Ceres tells of every failed step through glog; what matters comes back in the summary.
    FLAGS_minloglevel = google::GLOG_FATAL;
    ceres::Solver::Summary summary;
    ceres::Solve(solver, &problem, &summary);
    if (!summary.IsSolutionUsable()) {
        return fail("the solver found no minimum: " + summary.message);
    }
    return static_cast<int>(summary.iterations.size());
}

// From the median length of the residuals: outliers do not widen it. Both axes equally noisy.
double median_sigma(const std::vector<std::vector<CornerError>>& errors) {
    std::vector<double> lengths;
    for (const auto& camera : errors) {
        for (const CornerError& e : camera) lengths.push_back(glm::length(e.error));
    }
    if (lengths.empty()) return kLeastSigmaPx;
    const auto middle = lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() / 2);
    std::nth_element(lengths.begin(), middle, lengths.end());
    return std::max(kLeastSigmaPx, *middle / std::sqrt(2 * std::log(2.0)));
}

int free_count(const Shots& shots, const BundleFreedom& freedom) {
    int count = shots.cameras.size() == 2 && freedom.rig ? 6 : 0;
    for (const auto& lens : freedom.lenses) {
        count += static_cast<int>(std::count(lens.begin(), lens.end(), true));
    }
    return count + 6 * static_cast<int>(shots.names.size());
}

// From the residuals that the loss counts as noise (all of them without a loss). What Gaussian
// noise loses by being cut off at `sigmas` is given back; so is the freedom that fitting costs.
double noise_sigma(const Shots& shots, const BundleFreedom& freedom,
                   const std::vector<std::vector<CornerError>>& errors, double huber_px,
                   double sigmas) {
    double sum = 0;
    double count = 0;
    for (const auto& camera : errors) {
        for (const CornerError& e : camera) {
            const double square = glm::dot(e.error, e.error);
            if (huber_px > 0 && square > huber_px * huber_px) continue;
            sum += square;
            ++count;
        }
    }
    const double tail = huber_px > 0 ? std::exp(-sigmas * sigmas / 2) : 0;
    const double cut = 2 * (1 - tail) / (2 - (sigmas * sigmas + 2) * tail);
    const double left = std::max(1.0, 2 * count - free_count(shots, freedom));
    return std::max(kLeastSigmaPx, std::sqrt(cut * sum / left));
}

}  // namespace

BundleFreedom freedom_of(const std::vector<LensModel>& models) {
    BundleFreedom out;
    for (const LensModel model : models) {
        out.lenses.emplace_back();
        for (int i = 0; i < free_numbers(model); ++i) {
            out.lenses.back()[static_cast<std::size_t>(i)] = true;
        }
    }
    return out;
}

Result<BundleResult> solve_bundle(const Shots& shots, BundleState start,
                                  const BundleFreedom& freedom, const BundleOptions& options) {
    KINO_CHECK_EQ(start.boards.size(), shots.names.size());
    KINO_CHECK_EQ(start.lenses.size(), shots.cameras.size());
    BundleResult out;
    out.state = std::move(start);
    const bool robust = options.huber_sigmas > 0;
    KINO_ASSIGN(out.iterations, minimise(shots, out.state, freedom, options,
                                         robust ? kFirstHuberPx : 0, robust ? kRough : kFine, 0));
    double huber_px = 0;
    if (robust) {
        huber_px = options.huber_sigmas * median_sigma(corner_errors(shots, out.state));
        KINO_ASSIGN(const int more,
                    minimise(shots, out.state, freedom, options, huber_px, kFine, out.iterations));
        out.iterations += more;
    }
    out.sigma_px = noise_sigma(shots, freedom, corner_errors(shots, out.state), huber_px,
                               options.huber_sigmas);
    return out;
}

std::vector<std::vector<CornerError>> corner_errors(const Shots& shots, const BundleState& state) {
    std::vector<std::vector<CornerError>> out(shots.cameras.size());
    const PreparedPose second = prepare(state.second_from_first);
    for (std::size_t c = 0; c < shots.cameras.size(); ++c) {
        const auto& views = shots.cameras[c].views;
        for (std::size_t view = 0; view < views.size(); ++view) {
            const PreparedPose board = prepare(state.boards[view]);
            for (const ShotCorner& corner : views[view]) {
                glm::dvec2 px;
                if (reproject(state.lenses[c].data(), c == 1 ? &second : nullptr, board,
                              shots.corners_m[static_cast<std::size_t>(corner.id)], px, nullptr)) {
                    out[c].push_back({static_cast<int>(view), corner.px, px - corner.px});
                }
            }
        }
    }
    return out;
}

double rms_px(const std::vector<CornerError>& errors) {
    double sum = 0;
    for (const CornerError& e : errors) sum += glm::dot(e.error, e.error);
    return errors.empty() ? 0 : std::sqrt(sum / static_cast<double>(errors.size()));
}

}  // namespace kino
