#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "base/camera_model.h"
#include "base/image.h"
#include "base/pose.h"
#include "skeleton/synthetic/primitive.h"
#include "skeleton/synthetic/raycast_kernel.h"

namespace kino {

/// One camera of the synthetic world: its rays, and where a solid can fall on its picture. Widths
/// must be multiples of 8. Pixels whose distortion has no inverse get the nearest ray that has.
class CastView {
  public:
    /// The camera must pass validate(); `view_from_world` must be a valid pose.
    CastView(const CameraModel& camera, const Pose& view_from_world);

    /// The same view with its rays through other points of the pixels, up to half a pixel away: for
    /// several samples a pixel. Rays are interpolated, good to far below the spacing of samples.
    [[nodiscard]] CastView shifted(double x_px, double y_px) const;

    [[nodiscard]] int width() const { return ray_x_.width(); }
    [[nodiscard]] int height() const { return ray_x_.height(); }
    [[nodiscard]] const Image<float>& ray_x() const { return ray_x_; }
    [[nodiscard]] const Image<float>& ray_y() const { return ray_y_; }
    [[nodiscard]] const Pose& view_from_world() const { return view_from_world_; }

    /// The solid ready for an eye at (eye_x_m, 0, 0) of this view.
    [[nodiscard]] raycast::Solid prepare(const Primitive& solid, std::int32_t id,
                                         double eye_x_m = 0) const;
    /// A rectangle that contains every pixel whose ray can meet the solid. Empty if behind.
    [[nodiscard]] raycast::Rect bounds(const Primitive& solid) const;
    /// A rectangle that contains every pixel whose surface the solid can hide from an eye at
    /// (eye_x_m, 0, 0), eye_x_m >= 0: its outline there, moved by the parallax between the solid
    /// and anything behind it.
    [[nodiscard]] raycast::Rect shadow_bounds(const Primitive& solid, double eye_x_m) const;

  private:
    struct Outline {
        double x0, x1, y0, y1, z_min;
    };
    [[nodiscard]] std::optional<Outline> outline(const Primitive& solid, double eye_x_m) const;
    [[nodiscard]] raycast::Rect pixels(const Outline& outline) const;
    [[nodiscard]] raycast::Rect everything() const { return {0, 0, width(), height()}; }

    void find_extremes();

    Pose view_from_world_;
    Image<float> ray_x_, ray_y_;
    // Extremes of the rays of all columns up to, or from, this one: conservative and monotone under
    // any distortion.
    std::vector<float> column_max_, column_min_, row_max_, row_min_;
};

/// True if the rectangle holds a pixel.
[[nodiscard]] inline bool any_pixel(const raycast::Rect& r) {
    return r.x0 < r.x1 && r.y0 < r.y1;
}
[[nodiscard]] raycast::Rect join(const raycast::Rect& a, const raycast::Rect& b);
[[nodiscard]] raycast::Rect intersect(const raycast::Rect& a, const raycast::Rect& b);

}  // namespace kino
