#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/image.h"
#include "skeleton/synthetic/scene.h"
#include "skeleton/synthetic/view.h"

namespace kino {

/// Which surface a camera sees in each pixel, and how far it is. What never moves is drawn once;
/// each frame only draws the person over it. Ids: furniture from 0 in the scene's order, then the
/// six room planes, then the person's solids from first_person_id().
class Visibility {
  public:
    /// `emitter_x_m` > 0 also keeps track of what a projector there (same axes, to the right of the
    /// camera) lights. The scene must pass validate(); it is read here only.
    Visibility(const SyntheticScene& scene, CastView view, double emitter_x_m = 0);

    /// Draws the person. `person` must be what the scene gives for one moment.
    void draw(std::span<const Primitive> person);

    [[nodiscard]] const CastView& view() const { return view_; }
    [[nodiscard]] const Image<float>& z_m() const { return z_; }  ///< 0: outside the room
    [[nodiscard]] const Image<std::int32_t>& id() const { return id_; }
    /// -1 where the emitter sees the surface, 0 in its shadow.
    [[nodiscard]] const Image<std::int32_t>& lit() const { return lit_; }
    [[nodiscard]] std::int32_t first_person_id() const { return first_person_id_; }
    [[nodiscard]] PartId part_of(std::int32_t id) const {
        return id < 0 ? kPartNone : parts_[static_cast<std::size_t>(id)];
    }
    /// Where the person may be seen, and each solid ready for this view.
    [[nodiscard]] const raycast::Rect& person_bounds() const { return person_bounds_; }
    [[nodiscard]] const std::vector<raycast::Solid>& person_solids() const { return solids_; }
    [[nodiscard]] const std::vector<raycast::Rect>& person_rects() const { return rects_; }
    [[nodiscard]] raycast::Target target();

    /// Surfaces this near behind the one that is seen throw no projector shadow on it, metres.
    static constexpr float kShadowMarginM = 0.001f;

  private:
    void draw_room(const RoomBox& room);
    void shadow_person(std::span<const Primitive> person);

    CastView view_;
    double emitter_x_m_;
    std::int32_t first_person_id_ = 0;
    std::vector<PartId> parts_;
    std::vector<raycast::Solid> furniture_shadow_;  // ready for the emitter
    std::vector<raycast::Rect> furniture_shadow_rects_;
    Image<float> still_z_, z_;
    Image<std::int32_t> still_id_, id_, still_lit_, lit_;
    std::vector<raycast::Solid> solids_;
    std::vector<raycast::Rect> rects_;
    raycast::Rect person_bounds_;
    raycast::Rect drawn_, shaded_;  // what differs from the still pictures
};

}  // namespace kino
