#include "calibration/solve/shots.h"

namespace kino {

Shots only_views(const Shots& shots, const std::vector<bool>& keep) {
    Shots out;
    out.corners_m = shots.corners_m;
    for (const CameraShots& camera : shots.cameras) {
        out.cameras.push_back({camera.name, camera.width, camera.height, {}});
    }
    for (std::size_t view = 0; view < shots.names.size(); ++view) {
        if (!keep[view]) continue;
        out.names.push_back(shots.names[view]);
        for (std::size_t c = 0; c < shots.cameras.size(); ++c) {
            out.cameras[c].views.push_back(shots.cameras[c].views[view]);
        }
    }
    return out;
}

Shots only_camera(const Shots& shots, std::size_t camera) {
    Shots one;
    one.corners_m = shots.corners_m;
    one.names = shots.names;
    one.cameras = {shots.cameras[camera]};
    std::vector<bool> keep;
    for (const auto& view : one.cameras[0].views) keep.push_back(!view.empty());
    return only_views(one, keep);
}

}  // namespace kino
