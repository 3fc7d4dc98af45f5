#include "calibration/solve/lens_choice.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numeric>

#include "base/check.h"
#include "calibration/solve/start.h"

namespace kino {
namespace {

Shots every_other_corner(const Shots& shots, std::size_t first) {
    Shots out = shots;
    for (auto& view : out.cameras[0].views) {
        std::vector<ShotCorner> kept;
        for (std::size_t i = first; i < view.size(); i += 2) kept.push_back(view[i]);
        view = std::move(kept);
    }
    return out;
}

struct Squares {
    double sum = 0;
    double count = 0;
};

// Adds each view's squared errors under a lens that is held.
Result<void> judge(const Shots& left_out, const Lens& lens, std::vector<Squares>& out) {
    const BundleFreedom nothing = {{std::array<bool, 12>{}}, false};
    for (const std::size_t half : {std::size_t{0}, std::size_t{1}}) {
        const Shots posed = every_other_corner(left_out, half);
        const Shots judged = every_other_corner(left_out, 1 - half);
        KINO_ASSIGN(BundleState start, start_state(posed, {lens}));
        KINO_ASSIGN(const BundleResult solved, solve_bundle(posed, std::move(start), nothing));
        const auto errors = corner_errors(judged, solved.state);
        for (const CornerError& e : errors[0]) {
            out[static_cast<std::size_t>(e.view)].sum += glm::dot(e.error, e.error);
            ++out[static_cast<std::size_t>(e.view)].count;
        }
    }
    return {};
}

}  // namespace

Result<LensScore> held_out(const Shots& one_camera, int folds,
                           const std::function<Result<Lens>(const Shots& training)>& fit) {
    const std::size_t views = one_camera.names.size();
    const std::size_t parts = std::min(static_cast<std::size_t>(std::max(2, folds)), views);
    LensScore score;
    score.view_squares.resize(views);
    Squares all;
    for (std::size_t part = 0; part < parts; ++part) {
        std::vector<bool> kept(views);
        std::vector<bool> left(views);
        std::vector<std::size_t> places;
        for (std::size_t view = 0; view < views; ++view) {
            left[view] = view % parts == part;
            kept[view] = !left[view];
            if (left[view]) places.push_back(view);
        }
        KINO_ASSIGN(const Lens lens, fit(only_views(one_camera, kept)));
        std::vector<Squares> squares(places.size());
        KINO_TRY(judge(only_views(one_camera, left), lens, squares));
        for (std::size_t i = 0; i < places.size(); ++i) {
            score.view_squares[places[i]] = squares[i].sum / std::max(1.0, squares[i].count);
            all.sum += squares[i].sum;
            all.count += squares[i].count;
        }
    }
    score.held_out_px = std::sqrt(all.sum / std::max(1.0, all.count));
    return score;
}

Result<LensScore> held_out(const Shots& one_camera, LensModel model, int folds,
                           const BundleOptions& options) {
    KINO_ASSIGN(LensScore score,
                held_out(one_camera, folds, [&](const Shots& training) -> Result<Lens> {
                    KINO_ASSIGN(const BundleResult fitted, solve_camera(training, model, options));
                    return fitted.state.lenses[0];
                }));
    score.model = model;
    KINO_ASSIGN(const BundleResult whole, solve_camera(one_camera, model, options));
    score.fit_px = rms_px(corner_errors(one_camera, whole.state)[0]);
    return score;
}

LensModel choose(const std::vector<LensScore>& scores) {
    KINO_CHECK(!scores.empty());
    const auto mean = [](const std::vector<double>& v) {
        return std::accumulate(v.begin(), v.end(), 0.0) / static_cast<double>(v.size());
    };
    const LensScore& best = *std::min_element(
        scores.begin(), scores.end(), [&](const LensScore& a, const LensScore& b) {
            return mean(a.view_squares) < mean(b.view_squares);
        });
    const LensScore* chosen = &best;
    for (const LensScore& score : scores) {
        if (score.model >= chosen->model) continue;
        std::vector<double> difference;
        for (std::size_t i = 0; i < score.view_squares.size(); ++i) {
            difference.push_back(score.view_squares[i] - best.view_squares[i]);
        }
        const double middle = mean(difference);
        double spread = 0;
        for (const double d : difference) spread += (d - middle) * (d - middle);
        const auto n = static_cast<double>(difference.size());
        const double standard_error = std::sqrt(spread / std::max(1.0, n - 1) / n);
        if (middle <= standard_error) chosen = &score;
    }
    return chosen->model;
}

}  // namespace kino
