#include "calibration/solve/pair_checks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <optional>

#include "base/check.h"
#include "calibration/solve/initial.h"
#include "calibration/solve/start.h"

namespace kino {
namespace {

// A view disagrees if its error is this many times what the cameras alone have, and visible.
constexpr double kDisagrees = 4;
constexpr double kVisiblePx = 0.8;

double median(std::vector<double> values) {
    if (values.empty()) return 0;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

bool by_both(const Shots& shots, std::size_t view) {
    return !shots.cameras[0].views[view].empty() && !shots.cameras[1].views[view].empty();
}

Shots both_see(const Shots& shots) {
    std::vector<bool> keep;
    for (std::size_t view = 0; view < shots.names.size(); ++view) {
        keep.push_back(by_both(shots, view));
    }
    return only_views(shots, keep);
}

// From the median length, as if the errors were Gaussian: single wrong corners do not count.
std::vector<double> view_rms(const Shots& shots, const BundleState& state) {
    std::vector<std::vector<double>> lengths(shots.names.size());
    for (const auto& camera : corner_errors(shots, state)) {
        for (const CornerError& e : camera) {
            lengths[static_cast<std::size_t>(e.view)].push_back(glm::length(e.error));
        }
    }
    std::vector<double> out;
    for (auto& view : lengths) out.push_back(median(std::move(view)) / std::sqrt(std::log(2.0)));
    return out;
}

const BundleFreedom kBoardsOnly = {{std::array<bool, 12>{}, std::array<bool, 12>{}}, false};
const BundleFreedom kRigAndBoards = {{std::array<bool, 12>{}, std::array<bool, 12>{}}, true};

struct JoinedPair {
    BundleState state;
    std::vector<double> rms_px;  // by view
};

// The lenses as each camera alone found them, the pose between by what most views say.
Result<JoinedPair> join(const Shots& shots, const std::vector<Lens>& lenses) {
    KINO_ASSIGN(BundleState start, start_state(shots, lenses));
    BundleOptions options;
    options.max_iterations = 50;
    KINO_ASSIGN(BundleResult solved, solve_bundle(shots, std::move(start), kRigAndBoards, options));
    JoinedPair out{std::move(solved.state), {}};
    out.rms_px = view_rms(shots, out.state);
    return out;
}

double shared(const std::vector<double>& rms, double alone_px) {
    const double limit = std::max(kVisiblePx, kDisagrees * alone_px);
    const auto good =
        std::count_if(rms.begin(), rms.end(), [&](double value) { return value <= limit; });
    return static_cast<double>(good) / static_cast<double>(rms.size());
}

Shots one_view(const Shots& shots, std::size_t view, double scale) {
    std::vector<bool> keep(shots.names.size(), false);
    keep[view] = true;
    Shots out = only_views(shots, keep);
    for (auto& corner : out.corners_m) corner *= scale;
    return out;
}

// The size of the board relative to the stated one, if that alone explains the view.
std::optional<double> other_size(const Shots& shots, std::size_t view, const BundleState& state,
                                 double limit_px) {
    const auto first = initial_pose(shots, 0, view, state.lenses[0]);
    const auto second = initial_pose(shots, 1, view, state.lenses[1]);
    if (!first || !second) return std::nullopt;
    const Pose rig = pose_of(state.second_from_first);
    const glm::dvec3 apparent = second->translation - rig.rotation * first->translation;
    const double guess = glm::dot(apparent, rig.translation) / glm::dot(apparent, apparent);
    if (!(guess > 0.05) || !(guess < 20)) return std::nullopt;
    double best_px = limit_px;
    std::optional<double> best;
    for (double scale = 0.8 * guess; scale <= 1.25 * guess; scale += 0.01 * guess) {
        const Shots one = one_view(shots, view, scale);
        BundleState start = state;
        Pose board = *first;
        board.translation *= scale;
        start.boards = {turned(board)};
        const auto solved = solve_bundle(one, std::move(start), kBoardsOnly);
        if (!solved) continue;
        const double rms = view_rms(one, solved->state)[0];
        if (rms < best_px) {
            best_px = rms;
            best = scale;
        }
    }
    if (best && std::abs(*best - 1) < 0.1) return std::nullopt;
    return best;
}

}  // namespace

CameraShots mirrored(const Shots& shots, std::size_t camera) {
    double highest = 0;
    for (const glm::dvec2& corner : shots.corners_m) highest = std::max(highest, corner.y);
    std::vector<int> turned_id;
    for (const glm::dvec2& corner : shots.corners_m) {
        const glm::dvec2 wanted(corner.x, highest - corner.y);
        const auto nearest =
            std::min_element(shots.corners_m.begin(), shots.corners_m.end(),
                             [&](const glm::dvec2& a, const glm::dvec2& b) {
                                 return glm::distance(a, wanted) < glm::distance(b, wanted);
                             });
        turned_id.push_back(static_cast<int>(nearest - shots.corners_m.begin()));
    }
    CameraShots out = shots.cameras[camera];
    for (auto& view : out.views) {
        for (ShotCorner& corner : view) {
            corner.px.x = out.width - 1 - corner.px.x;
            corner.id = turned_id[static_cast<std::size_t>(corner.id)];
        }
    }
    return out;
}

Result<PairFindings> check_pair(const Shots& shots, const std::vector<BundleResult>& alone) {
    KINO_CHECK_EQ(shots.cameras.size(), 2u);
    PairFindings out;
    out.keep.assign(shots.names.size(), true);
    const Shots pair = both_see(shots);
    const double alone_px = std::sqrt(2.0) * std::max(alone[0].sigma_px, alone[1].sigma_px);
    std::vector<Lens> lenses = {alone[0].state.lenses[0], alone[1].state.lenses[0]};
    KINO_ASSIGN(const JoinedPair joint, join(pair, lenses));
    const double limit = std::max(kVisiblePx, kDisagrees * alone_px);
    if (shared(joint.rms_px, alone_px) < 0.5) {
        for (const std::size_t camera : {std::size_t{1}, std::size_t{0}}) {
            Shots turned_shots = pair;
            turned_shots.cameras[camera] = mirrored(pair, camera);
            std::vector<Lens> turned_lenses = lenses;
            Lens& lens = turned_lenses[camera];
            lens[2] = pair.cameras[camera].width - 1 - lens[2];
            lens[7] = -lens[7];
            const auto again = join(turned_shots, turned_lenses);
            if (again && shared(again->rms_px, alone_px) > 0.8) {
                return fail(
                    "these pictures are mirrored: with left and right exchanged they fit "
                    "those of " +
                        pair.cameras[1 - camera].name,
                    pair.cameras[camera].name,
                    "switch the mirroring of this camera off and take them again");
            }
        }
        return fail(fmt::format("no fixed pose between the cameras explains the views: RMS {:.2f} "
                                "px together, {:.2f} px alone",
                                median(joint.rms_px), alone_px),
                    pair.cameras[0].name + " and " + pair.cameras[1].name,
                    "are the pictures paired rightly, and was the board still?");
    }
    // What is said about the views that disagree rests on those that agree.
    std::vector<bool> agree;
    for (const double rms : joint.rms_px) agree.push_back(rms <= limit);
    KINO_ASSIGN(const JoinedPair agreed, join(only_views(pair, agree), lenses));
    std::size_t at = 0;
    for (std::size_t view = 0; view < shots.names.size(); ++view) {
        if (!by_both(shots, view)) continue;
        const std::size_t own = at++;
        if (joint.rms_px[own] <= limit) continue;
        out.keep[view] = false;
        if (const auto size = other_size(pair, own, agreed.state, limit)) {
            out.notes.push_back(fmt::format(
                "{}: boards of two sizes are mixed: this one's squares are {:.2f} times as large "
                "as stated; left out",
                shots.names[view], *size));
        } else {
            out.notes.push_back(
                fmt::format("{}: the board moved between the two pictures ({:.1f} px RMS, {:.1f} "
                            "px where it was still); left out",
                            shots.names[view], joint.rms_px[own], median(agreed.rms_px)));
        }
    }
    return out;
}

}  // namespace kino
