#include "calibration/solve/calibrate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "base/check.h"
#include "calibration/solve/pair_checks.h"
#include "calibration/solve/start.h"
#include "calibration/solve/view_checks.h"

namespace kino {
namespace {

constexpr double kDegrees = 180 / 3.14159265358979323846;

class Run {
  public:
    Run(const Shots& shots, const CalibrateOptions& options) : shots_(shots), options_(options) {}

    Result<Calibration> run() {
        for (std::size_t c = 0; c < shots_.cameras.size(); ++c) KINO_TRY(check_views(shots_, c));
        for (std::size_t c = 0; c < shots_.cameras.size(); ++c) KINO_TRY(choose_lens(c));
        if (shots_.cameras.size() == 2) {
            tell("checking that the views of both cameras belong together");
            KINO_ASSIGN(PairFindings findings, check_pair(shots_, alone_));
            for (std::string& note : findings.notes) out_.notes.push_back(std::move(note));
            shots_ = only_views(shots_, findings.keep);
            for (std::size_t c = 0; c < 2; ++c) KINO_TRY(check_views(shots_, c));
        }
        KINO_TRY(solve_all());
        write_down();
        return std::move(out_);
    }

  private:
    void tell(const std::string& what) const {
        if (options_.progress) options_.progress(what);
    }

    Result<void> choose_lens(std::size_t camera) {
        const Shots one = only_camera(shots_, camera);
        CameraResult result;
        result.name = one.cameras[0].name;
        result.model = options_.models.front();
        if (options_.models.size() > 1) {
            for (const LensModel model : options_.models) {
                tell(fmt::format("{}: {} on views held out", result.name, name(model)));
                auto score = held_out(one, model, options_.folds, options_.bundle);
                if (score) result.scores.push_back(std::move(*score));
            }
            if (result.scores.empty()) {
                return fail("no lens model could be fitted to part of the views", result.name,
                            "take more views, with the board whole and sharp in each");
            }
            result.model = choose(result.scores);
        }
        auto solved = solve_camera(one, result.model, options_.bundle);
        if (!solved) return fail(std::move(solved).error(), result.name);
        alone_.push_back(std::move(*solved));
        out_.cameras.push_back(std::move(result));
        return {};
    }

    // The number of a camera that is least worth its freedom, or none.
    struct Weak {
        std::size_t camera;
        std::size_t number;
        double sigma;
    };
    std::optional<Weak> weakest() const {
        for (const auto& place : deviations_.undetermined) {
            if (place.camera < shots_.cameras.size() && place.number >= 4) {
                return Weak{place.camera, place.number,
                            deviations_.lenses[place.camera][place.number]};
            }
        }
        std::optional<Weak> out;
        double worst = 1;
        for (std::size_t c = 0; c < shots_.cameras.size(); ++c) {
            const double focal = solved_.state.lenses[c][0];
            for (std::size_t i = 0; i < 12; ++i) {
                const double sigma = deviations_.lenses[c][i] / (i < 4 ? focal : 1);
                if (!(sigma / kHeldAbove[i] > worst)) continue;
                worst = sigma / kHeldAbove[i];
                out = Weak{c, i, deviations_.lenses[c][i]};
            }
        }
        return out;
    }

    Result<void> solve_all() {
        tell("solving everything together");
        BundleState state;
        if (shots_.cameras.size() == 1) {
            state = alone_[0].state;
            solved_.iterations = alone_[0].iterations;
        } else {
            std::vector<Lens> lenses;
            for (const BundleResult& one : alone_) lenses.push_back(one.state.lenses[0]);
            KINO_ASSIGN(state, start_state(shots_, lenses));
        }
        std::vector<LensModel> models;
        for (const CameraResult& camera : out_.cameras) models.push_back(camera.model);
        freedom_ = freedom_of(models);
        for (;;) {
            KINO_ASSIGN(solved_, solve_bundle(shots_, state, freedom_, options_.bundle));
            deviations_ = bundle_deviations(shots_, solved_, freedom_, options_.bundle);
            const auto weak = weakest();
            if (!weak) return {};
            const std::string_view number = kLensNames[weak->number];
            if (weak->number < 4) {
                return fail(
                    fmt::format("the views do not determine {} ({:.0f} +- {:.0f} px)", number,
                                solved_.state.lenses[weak->camera][weak->number], weak->sigma),
                    shots_.cameras[weak->camera].name,
                    "tilt the board more, bring it nearer, and to all parts of the picture");
            }
            out_.notes.push_back(fmt::format(
                "{}: {} is held at 0: these views do not determine it (its standard deviation "
                "would be {:.3g})",
                shots_.cameras[weak->camera].name, number, weak->sigma));
            freedom_.lenses[weak->camera][weak->number] = false;
            state = solved_.state;
            state.lenses[weak->camera][weak->number] = 0;
        }
    }

    void write_down() {
        const auto errors = corner_errors(shots_, solved_.state);
        double sum = 0;
        std::size_t count = 0;
        for (std::size_t c = 0; c < shots_.cameras.size(); ++c) {
            CameraResult& camera = out_.cameras[c];
            const CameraShots& own = shots_.cameras[c];
            const Lens& lens = solved_.state.lenses[c];
            camera.camera = camera_of(lens, own.width, own.height);
            for (std::size_t i = 0; i < static_cast<std::size_t>(free_numbers(camera.model)); ++i) {
                camera.numbers.push_back({std::string(kLensNames[i]), lens[i],
                                          deviations_.lenses[c][i], i < 4 ? "px" : "",
                                          !freedom_.lenses[c][i]});
            }
            camera.errors = errors[c];
            camera.rms_px = rms_px(errors[c]);
            camera.coverage = coverage(own);
            sum += camera.rms_px * camera.rms_px * static_cast<double>(errors[c].size());
            count += errors[c].size();
            std::vector<std::vector<CornerError>> by_view(shots_.names.size());
            for (const CornerError& e : errors[c]) {
                by_view[static_cast<std::size_t>(e.view)].push_back(e);
            }
            for (const auto& view : by_view) {
                camera.view_rms_px.push_back(view.empty() ? std::nullopt
                                                          : std::optional(rms_px(view)));
            }
        }
        out_.rms_px = std::sqrt(sum / std::max(1.0, static_cast<double>(count)));
        out_.sigma_px = solved_.sigma_px;
        out_.iterations = solved_.iterations;
        out_.views = shots_.names;
        for (const TurnedPose& board : solved_.state.boards) {
            out_.first_from_board.push_back(pose_of(board));
        }
        if (shots_.cameras.size() == 2) write_rig();
    }

    void write_rig() {
        out_.second_from_first = pose_of(solved_.state.second_from_first);
        constexpr std::array<const char*, 6> kNames = {"turn x",  "turn y",  "turn z",
                                                       "shift x", "shift y", "shift z"};
        for (std::size_t i = 0; i < 6; ++i) {
            const double scale = i < 3 ? kDegrees : 1000;
            out_.rig.push_back({kNames[i], scale * solved_.state.second_from_first[i],
                                scale * deviations_.rig[i], i < 3 ? "deg" : "mm", false});
        }
    }

    Shots shots_;
    const CalibrateOptions& options_;
    std::vector<BundleResult> alone_;
    BundleFreedom freedom_;
    BundleResult solved_;
    BundleDeviations deviations_;
    Calibration out_;
};

}  // namespace

Result<Calibration> calibrate(const Shots& shots, const CalibrateOptions& options) {
    KINO_CHECK(!options.models.empty());
    KINO_CHECK(shots.cameras.size() == 1 || shots.cameras.size() == 2);
    return Run(shots, options).run();
}

}  // namespace kino
