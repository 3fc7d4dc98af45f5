#pragma once

#include <glm/vec3.hpp>
#include <optional>
#include <vector>

#include "base/error.h"
#include "calibration/rig.h"
#include "skeleton/people/background.h"
#include "skeleton/people/body_reach.h"
#include "skeleton/people/components.h"
#include "skeleton/people/depth_grid.h"
#include "skeleton/people/floor_finder.h"
#include "skeleton/people/head_finder.h"
#include "skeleton/people/person.h"
#include "skeleton/people/person_tracker.h"

namespace kino {

struct PeopleOptions {
    /// The sensor may move: no background is learned; people are what stands on the floor, free on
    /// all sides.
    bool moving_sensor = false;
    int cell_px = 0;  ///< edge of a cell; 0: so that about 160 of them make a row
    BackgroundOptions background;
    FloorOptions floor;
    TrackerOptions tracker;
    PersonTest person;
};

/// Finds up to six people in depth pictures and keeps them apart through time. Deterministic: the
/// same pictures and times give the same answers, bit for bit. One thread at a time.
class PeopleFinder {
  public:
    /// `rays`: of the depth camera, one a pixel (Rig::depth_rays()); NaN where there is none. Fails
    /// for pictures below 16x16 pixels or without rays, and for cells that are too large for them.
    [[nodiscard]] static Result<PeopleFinder> create(Image<RayXy> rays,
                                                     const PeopleOptions& options = {});

    /// `depth_m`: metres along the axis, of the rays' size; 0, NaN, infinite and negative values
    /// are no reading. Times that fall (a seek, a loop) forget the people but not the room.
    /// `specific_force`: of the accelerometer in depth-camera axes, any unit; ignored if not finite
    /// or zero. Fills `out`, reusing its memory.
    void find(const Image<float>& depth_m, TimeNs time,
              const std::optional<glm::vec3>& specific_force, PeopleFrame& out);

    /// Forgets the people, the floor and the room.
    void reset();

    [[nodiscard]] const Background& background() const { return background_; }
    [[nodiscard]] const DepthGrid& grid() const { return grid_; }

  private:
    PeopleFinder(Image<RayXy> rays, const PeopleOptions& options, int cell_px);
    void remember(TimeNs time);
    [[nodiscard]] bool changed(std::size_t cell) const;
    void mark_foreground(const FloorPlane& floor);
    void find_heads(TimeNs time);
    void mark_surroundings(TimeNs time);
    [[nodiscard]] std::vector<Blob> collect() const;
    [[nodiscard]] bool in_front(std::size_t cell, float z, float height_m) const;
    void paint(const Image<float>& depth_m, PeopleFrame& out);
    void describe(TimeNs time, PeopleFrame& out) const;

    Image<RayXy> rays_;
    PeopleOptions options_;
    DepthGrid grid_;
    Background background_;
    FloorFinder floor_finder_;
    PersonTracker tracker_;
    Components components_;
    HeadFinder head_finder_;
    BodyReach reach_;
    Image<std::int32_t> labels_;  // of cells: components, people cut out of what they touch
    SurfaceStep step_;
    FloorPlane floor_;
    Image<float> before_m_;  // of cells, a moment ago
    Image<float> last_m_;    // of cells, in the picture before
    TimeNs before_time_ = 0;
    // Of cells: foreground, that before a known background, slot, somebody or perhaps.
    Image<std::uint8_t> mask_, certain_, slots_, seen_;
    std::vector<glm::vec3> upright_m_;
    std::vector<PixelBox> boxes_;
    std::vector<std::int32_t> pixels_;
    TimeNs last_ = 0;
    bool first_ = true;
};

}  // namespace kino
