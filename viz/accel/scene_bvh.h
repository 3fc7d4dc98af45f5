#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "base/error.h"
#include "viz/accel/device_bvh.h"
#include "viz/accel/triangle_soup.h"
#include "viz/scene/scene.h"

namespace kino {

/// Where the tree is built. Both make the same nodes.
enum class BuildPlace : std::uint8_t {
    host,   ///< and copied: the faster one where the device is a processor
    device  ///< by passes of the frame
};

struct SceneBvhOptions {
    BuildPlace place = BuildPlace::host;
    GatherOptions gather;
    BvhOptions tree;
    /// Where the live frame casts shadows it has a small tree of its own, made anew each frame: of
    /// every so many depth pixels that about this many are left across.
    int live_columns = 80;
    /// A refitted tree is built again once its estimated cost is this many times what it was.
    double rebuild_above = 1.5;
};

/// What a scene's tree is to the passes of one frame.
struct SceneBvhPasses {
    BvhBuffers tree;
    BvhBuffers live;  ///< the live frame's, in the same space
    glm::dvec3 center{
        0};  ///< world; where the tree's space has its origin. Its axes are the world's
};

/// The tree over a scene's triangles, kept from frame to frame: built once for a scene that stands
/// still, refitted while the same triangles move, rebuilt where others come.
class SceneBvh {
  public:
    explicit SceneBvh(gpu::Device& device) : device_tree_(device), live_tree_(device) {}

    /// Brings triangles and, on the host, the tree up to date. The GPU must not be reading
    /// (Executor::run waits).
    [[nodiscard]] Result<void> upload(const Scene& scene, const SceneBvhOptions& options = {});
    /// Adds what is left to do on the device; to be called once after upload().
    [[nodiscard]] SceneBvhPasses add(graph::FrameGraph& graph);

    /// Gives the memory back: nothing in the scene asks for rays.
    void clear();
    [[nodiscard]] std::uint64_t bytes() const { return device_tree_.bytes() + live_tree_.bytes(); }

    struct Counts {
        std::uint64_t builds = 0, refits = 0, kept = 0;  ///< uploads by what they did
    };
    [[nodiscard]] const Counts& counts() const { return counts_; }
    [[nodiscard]] const TriangleSoup& soup() const { return soup_; }
    /// What the live frame's tree is of; relative to soup()'s center.
    [[nodiscard]] const TriangleSoup& live_soup() const { return live_soup_; }
    /// The host's tree, for picking; empty where the device builds.
    [[nodiscard]] const Bvh& host_tree() const { return host_tree_; }

  private:
    /// What the triangles depend on.
    struct Part {
        std::shared_ptr<const void>
            shape;  ///< mesh or depth frame, kept so that no other takes its place
        std::shared_ptr<const void> pose;
        glm::dmat4 world_from_object{1};
        std::uint32_t id = 0;
        friend bool operator==(const Part&, const Part&) = default;
    };
    enum class Pending : std::uint8_t { nothing, build, refit };
    [[nodiscard]] static std::vector<Part> parts_of(const Scene& scene,
                                                    const SceneBvhOptions& options);

    [[nodiscard]] Result<void> upload_meshes(const Scene& scene, const SceneBvhOptions& options);
    [[nodiscard]] Result<void> upload_live(const Scene& scene, const SceneBvhOptions& options);

    DeviceBvh device_tree_;
    DeviceBvh live_tree_;
    Bvh host_tree_;
    TriangleSoup soup_, live_soup_;
    std::shared_ptr<const DepthSurface> live_frame_;  ///< that live_soup_ is of
    Pose live_pose_;
    bool live_pending_ = false;
    std::vector<Part> parts_;
    std::optional<SceneBvhOptions> options_;
    double cost_when_built_ = 0;
    int device_refits_ = 0;
    Pending pending_ = Pending::nothing;
    Counts counts_;
};

}  // namespace kino
