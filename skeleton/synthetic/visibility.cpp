#include "skeleton/synthetic/visibility.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

namespace kino {
namespace {

using glm::dvec3;

constexpr PartId kRoomParts[6] = {kPartLeftWall, kPartRightWall, kPartFloor,
                                  kPartCeiling,  kPartBackWall,  kPartFrontWall};

template <class T>
void copy_rect(const Image<T>& from, Image<T>& to, const raycast::Rect& rect) {
    if (!any_pixel(rect)) return;
    const auto bytes = static_cast<std::size_t>(rect.x1 - rect.x0) * sizeof(T);
    for (int y = rect.y0; y < rect.y1; ++y) {
        std::memcpy(to.row(y) + rect.x0, from.row(y) + rect.x0, bytes);
    }
}

// The kernels work on whole groups of eight pixels.
raycast::Rect whole_groups(raycast::Rect r) {
    r.x0 &= ~7;
    r.x1 = (r.x1 + 7) & ~7;
    return r;
}

}  // namespace

Visibility::Visibility(const SyntheticScene& scene, CastView view, double emitter_x_m)
    : view_(std::move(view)),
      emitter_x_m_(emitter_x_m),
      still_z_(view_.width(), view_.height()),
      still_id_(view_.width(), view_.height()),
      still_lit_(view_.width(), view_.height(), -1) {
    for (const Primitive& p : scene.furniture) parts_.push_back(p.part);
    parts_.insert(parts_.end(), std::begin(kRoomParts), std::end(kRoomParts));
    first_person_id_ = static_cast<std::int32_t>(parts_.size());

    draw_room(scene.room);
    const raycast::Kernels& k = raycast::kernels();
    const raycast::Target still{view_.ray_x().data(), view_.ray_y().data(), still_z_.data(),
                                still_id_.data(),     still_lit_.data(),    view_.width()};
    for (std::size_t i = 0; i < scene.furniture.size(); ++i) {
        const Primitive& p = scene.furniture[i];
        k.nearest(view_.prepare(p, static_cast<std::int32_t>(i)), view_.bounds(p), still);
    }
    if (emitter_x_m > 0) {
        for (std::size_t i = 0; i < scene.furniture.size(); ++i) {
            const Primitive& p = scene.furniture[i];
            const raycast::Rect rect = view_.shadow_bounds(p, emitter_x_m);
            if (!any_pixel(rect)) continue;
            furniture_shadow_.push_back(
                view_.prepare(p, static_cast<std::int32_t>(i), emitter_x_m));
            furniture_shadow_rects_.push_back(rect);
            k.block(furniture_shadow_.back(), rect, still, static_cast<float>(emitter_x_m),
                    kShadowMarginM, 0);
        }
    }
    z_ = still_z_;
    id_ = still_id_;
    lit_ = still_lit_;
}

void Visibility::draw_room(const RoomBox& room) {
    const Pose world_from_view = inverse(view_.view_from_world());
    const dvec3 eye = world_from_view.translation;
    const bool inside = eye.x > room.min_m.x && eye.y > room.min_m.y && eye.z > room.min_m.z &&
                        eye.x < room.max_m.x && eye.y < room.max_m.y && eye.z < room.max_m.z;
    const auto first = first_person_id_ - 6;
    for (int y = 0; y < view_.height(); ++y) {
        for (int x = 0; x < view_.width(); ++x) {
            const dvec3 d =
                world_from_view.rotation * dvec3(view_.ray_x().at(x, y), view_.ray_y().at(x, y), 1);
            double nearest = INFINITY;
            int plane = -1;
            for (int axis = 0; axis < 3 && inside; ++axis) {
                if (d[axis] == 0) continue;
                const double wall = d[axis] > 0 ? room.max_m[axis] : room.min_m[axis];
                const double t = (wall - eye[axis]) / d[axis];
                if (t < nearest) {
                    nearest = t;
                    plane = 2 * axis + (d[axis] > 0 ? 1 : 0);
                }
            }
            still_z_.at(x, y) = plane < 0 ? 1e9f : static_cast<float>(nearest);
            still_id_.at(x, y) = plane < 0 ? -1 : first + plane;
        }
    }
}

raycast::Target Visibility::target() {
    return {view_.ray_x().data(), view_.ray_y().data(), z_.data(),
            id_.data(),           lit_.data(),          view_.width()};
}

void Visibility::draw(std::span<const Primitive> person) {
    // Only what the last person covered or shaded differs from the still pictures.
    copy_rect(still_z_, z_, drawn_);
    copy_rect(still_id_, id_, drawn_);
    copy_rect(still_lit_, lit_, shaded_);
    const raycast::Kernels& k = raycast::kernels();
    parts_.resize(static_cast<std::size_t>(first_person_id_));
    solids_.clear();
    rects_.clear();
    person_bounds_ = {};
    for (const Primitive& p : person) {
        const auto id = first_person_id_ + static_cast<std::int32_t>(solids_.size());
        parts_.push_back(p.part);
        solids_.push_back(view_.prepare(p, id));
        rects_.push_back(view_.bounds(p));
        person_bounds_ = join(person_bounds_, rects_.back());
        if (any_pixel(rects_.back())) k.nearest(solids_.back(), rects_.back(), target());
    }
    drawn_ = whole_groups(person_bounds_);
    shaded_ = drawn_;
    if (emitter_x_m_ > 0) shadow_person(person);
}

void Visibility::shadow_person(std::span<const Primitive> person) {
    const raycast::Kernels& k = raycast::kernels();
    const auto emitter_x = static_cast<float>(emitter_x_m_);
    for (const Primitive& p : person) {
        const raycast::Rect rect = view_.shadow_bounds(p, emitter_x_m_);
        if (!any_pixel(rect)) continue;
        k.block(view_.prepare(p, 0, emitter_x_m_), rect, target(), emitter_x, kShadowMarginM, 0);
        shaded_ = join(shaded_, whole_groups(rect));
    }
    for (std::size_t i = 0; i < furniture_shadow_.size(); ++i) {
        const raycast::Rect rect = intersect(furniture_shadow_rects_[i], person_bounds_);
        if (!any_pixel(rect)) continue;
        k.block(furniture_shadow_[i], rect, target(), emitter_x, kShadowMarginM, first_person_id_);
    }
}

}  // namespace kino
