#include "viz/accel/scene_bvh.h"

#include <algorithm>
#include <utility>

#include "base/check.h"

namespace kino {
namespace {

double cost_of(const Bvh& bvh) {
    const BvhStats stats = stats_of(bvh);
    return stats.box_tests + stats.triangle_tests;
}

bool same_options(const SceneBvhOptions& a, const SceneBvhOptions& b) {
    return a.place == b.place && a.gather.meshes == b.gather.meshes &&
           a.gather.live == b.gather.live && a.gather.live_stride == b.gather.live_stride &&
           a.tree.levels == b.tree.levels && a.tree.axes == b.tree.axes &&
           a.tree.leaf_triangles == b.tree.leaf_triangles;
}

// The host sees when a refitted tree has become poor; the device's is built again now and then.
constexpr int kDeviceRefits = 60;

}  // namespace

std::vector<SceneBvh::Part> SceneBvh::parts_of(const Scene& scene, const SceneBvhOptions& options) {
    std::vector<Part> parts;
    if (options.gather.meshes) {
        for (const MeshNode& node : scene.meshes) {
            parts.push_back({node.mesh, node.pose, node.world_from_object, node.id});
        }
    }
    if (options.gather.live && scene.live.has_value()) {
        parts.push_back({scene.live->surface, nullptr, scene.live->world_from_depth.matrix(), 0});
    }
    return parts;
}

Result<void> SceneBvh::upload(const Scene& scene, const SceneBvhOptions& options) {
    KINO_TRY(upload_meshes(scene, options));
    return upload_live(scene, options);
}

Result<void> SceneBvh::upload_live(const Scene& scene, const SceneBvhOptions& options) {
    KINO_CHECK(options.live_columns > 1);
    const bool casts = scene.live && scene.live->surface && scene.live->casts_shadows;
    if (!casts) {
        live_tree_.clear();
        live_soup_ = {};
        live_frame_.reset();
        live_pending_ = false;
        return {};
    }
    const LiveDepth& live = *scene.live;
    if (live.surface == live_frame_ && live.world_from_depth == live_pose_ &&
        soup_.center == live_soup_.center) {
        return {};
    }
    const int columns = live.surface->depth_m.width();
    const int stride = std::max(1, (columns + options.live_columns / 2) / options.live_columns);
    live_soup_ = gather_live_triangles(live, stride, soup_.center);
    live_frame_ = live.surface;
    live_pose_ = live.world_from_depth;
    live_pending_ = options.place == BuildPlace::device;
    if (live_pending_) return live_tree_.upload_soup(live_soup_.triangles, options.tree);
    return live_tree_.upload(build_bvh(live_soup_.triangles, options.tree));
}

Result<void> SceneBvh::upload_meshes(const Scene& scene, const SceneBvhOptions& options) {
    std::vector<Part> parts = parts_of(scene, options);
    const bool same_way = options_.has_value() && same_options(*options_, options);
    if (same_way && parts == parts_) {
        ++counts_.kept;
        return {};
    }
    TriangleSoup soup = gather_triangles(scene, options.gather);
    const bool same_triangles =
        same_way && !soup.triangles.empty() && soup.sources == soup_.sources;
    soup_ = std::move(soup);
    parts_ = std::move(parts);
    options_ = options;
    if (options.place == BuildPlace::device) {
        host_tree_ = {};
        KINO_TRY(device_tree_.upload_soup(soup_.triangles, options.tree));
        // A build that no frame has run yet is still to be run.
        const bool refit =
            same_triangles && device_refits_ < kDeviceRefits && pending_ != Pending::build;
        device_refits_ = refit ? device_refits_ + 1 : 0;
        pending_ = refit ? Pending::refit : Pending::build;
        ++(refit ? counts_.refits : counts_.builds);
        return {};
    }
    bool refit = same_triangles;
    if (refit) {
        refit_bvh(host_tree_, soup_.triangles);
        refit = cost_of(host_tree_) <= options.rebuild_above * cost_when_built_;
    }
    if (!refit) {
        host_tree_ = build_bvh(soup_.triangles, options.tree);
        cost_when_built_ = cost_of(host_tree_);
    }
    ++(refit ? counts_.refits : counts_.builds);
    return device_tree_.upload(host_tree_);
}

SceneBvhPasses SceneBvh::add(graph::FrameGraph& graph) {
    SceneBvhPasses passes{.center = soup_.center};
    switch (std::exchange(pending_, Pending::nothing)) {
        case Pending::build:
            passes.tree = device_tree_.add_build(graph);
            break;
        case Pending::refit:
            passes.tree = device_tree_.add_refit(graph);
            break;
        case Pending::nothing:
            passes.tree = device_tree_.add(graph);
            break;
    }
    passes.live =
        std::exchange(live_pending_, false) ? live_tree_.add_build(graph) : live_tree_.add(graph);
    return passes;
}

void SceneBvh::clear() {
    device_tree_.clear();
    host_tree_ = {};
    soup_ = {};
    live_tree_.clear();
    live_soup_ = {};
    live_frame_.reset();
    live_pending_ = false;
    parts_.clear();
    options_.reset();
    pending_ = Pending::nothing;
}

}  // namespace kino
