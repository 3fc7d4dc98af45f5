#include "calibration/solve/start.h"

#include <fmt/format.h>

#include <optional>

#include "base/check.h"
#include "calibration/solve/initial.h"

namespace kino {
namespace {

using Poses = std::vector<std::optional<Pose>>;

Poses poses_of(const Shots& shots, std::size_t camera, const Lens& lens) {
    Poses out;
    for (std::size_t view = 0; view < shots.names.size(); ++view) {
        out.push_back(initial_pose(shots, camera, view, lens));
    }
    return out;
}

}  // namespace

Result<BundleState> start_state(const Shots& shots, const std::vector<Lens>& lenses) {
    BundleState state;
    state.lenses = lenses;
    const Poses first = poses_of(shots, 0, lenses[0]);
    Poses second(shots.names.size());
    Pose second_from_first;
    if (shots.cameras.size() == 2) {
        second = poses_of(shots, 1, lenses[1]);
        std::vector<Pose> relative;
        for (std::size_t view = 0; view < shots.names.size(); ++view) {
            if (first[view] && second[view]) {
                relative.push_back(*second[view] * inverse(*first[view]));
            }
        }
        if (relative.empty()) {
            return fail(fmt::format("no view shows the board to both {} and {}",
                                    shots.cameras[0].name, shots.cameras[1].name),
                        {}, "both cameras must see the board at the same time");
        }
        second_from_first = middle_pose(relative);
        state.second_from_first = turned(second_from_first);
    }
    for (std::size_t view = 0; view < shots.names.size(); ++view) {
        if (first[view]) {
            state.boards.push_back(turned(*first[view]));
        } else if (second[view]) {
            state.boards.push_back(turned(inverse(second_from_first) * *second[view]));
        } else {
            return fail("the corners of this view lead to no pose of the board", shots.names[view]);
        }
    }
    return state;
}

Result<BundleState> start_state(const Shots& shots) {
    std::vector<Lens> lenses;
    for (std::size_t c = 0; c < shots.cameras.size(); ++c) lenses.push_back(initial_lens(shots, c));
    return start_state(shots, lenses);
}

Result<BundleResult> solve_camera(const Shots& one_camera, LensModel model,
                                  const BundleOptions& options) {
    KINO_CHECK_EQ(one_camera.cameras.size(), 1u);
    KINO_ASSIGN(BundleState state, start_state(one_camera));
    if (model != LensModel::pinhole) {
        BundleFreedom few = freedom_of({LensModel::pinhole});
        few.lenses[0][4] = true;
        BundleOptions rough = options;
        rough.max_iterations = 30;
        rough.huber_sigmas = 0;
        if (auto first = solve_bundle(one_camera, state, few, rough)) {
            state = std::move(first->state);
        }
    }
    return solve_bundle(one_camera, std::move(state), freedom_of({model}), options);
}

}  // namespace kino
