#pragma once

#include <array>
#include <glm/vec3.hpp>
#include <map>
#include <memory>
#include <string_view>
#include <vector>

#include "viz/quality/zoom/cost_model.h"
#include "viz/scene/scene.h"
#include "viz/scene/view.h"

namespace kino {

/// What a frame at z = 1 is going to do, counted before it is drawn.
struct FrameWork {
    double live_points = 0;                         ///< pixels of the live depth picture
    double vertices = 0, triangles = 0, draws = 0;  ///< of meshes that may be seen
    double pixels = 0;                              ///< of the picture
    double covered = 0;                             ///< pixels with a surface
    double lobes = 0;     ///< of those, times the lights that reach them, times their lobes
    double shadowed = 0;  ///< of those, times the lights whose shadows are cast by rays

    [[nodiscard]] ZoomWork counted() const;
    /// The share that a group of passes (FrameReport::groups) has of it; nothing for groups whose
    /// work is not counted.
    [[nodiscard]] ZoomWork of_group(std::string_view group) const;
};

/// Counts by sixteen times nine rays through the picture, against the boxes around meshes and
/// against the live surface; at the point that a ray hits, lights within reach are counted.
class WorkCounter {
  public:
    [[nodiscard]] FrameWork count(const Scene& scene, const View& view);

  private:
    struct Box {
        std::weak_ptr<const MeshAsset> mesh;
        glm::vec3 least{0}, most{0};
    };
    struct Hit {
        double z_m = 0;  ///< along the view's axis; 0: nothing
        double lobes = 1;
        std::uint32_t material = 0;
    };
    static constexpr int kColumns = 16, kRows = 9;

    [[nodiscard]] const Box& box_of(const std::shared_ptr<const MeshAsset>& mesh);
    void add_mesh(const MeshNode& node, const Scene& scene, const View& view, FrameWork& work);
    void add_live(const LiveDepth& live, const View& view, FrameWork& work);
    void light(const Scene& scene, const View& view, FrameWork& work) const;

    std::map<const MeshAsset*, Box> boxes_;
    std::array<Hit, kColumns * kRows> hits_;
};

}  // namespace kino
