#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "base/camera_model.h"
#include "base/image.h"
#include "base/pose.h"
#include "calibration/disparity.h"
#include "skeleton/actors/actor_body.h"
#include "skeleton/synthetic/primitive.h"
#include "skeleton/synthetic/raycast_kernel.h"
#include "skeleton/synthetic/view.h"

namespace kino {

/// What a pixel of the canvas shows: actor n (from 1) as kActorId * n + BodyPart, or this.
constexpr std::int32_t kSceneId = 0;
constexpr std::int32_t kActorId = 256;
[[nodiscard]] constexpr int actor_of(std::int32_t id) {
    return id / kActorId;
}
[[nodiscard]] constexpr int part_of(std::int32_t id) {
    return id % kActorId;
}

struct CanvasNoise {
    double sigma_steps = 0.46;                    ///< of the disparity, raw steps
    double edge_jump_steps = 6;                   ///< between neighbours: an edge
    double drop_next = 0.45, drop_second = 0.15;  ///< chance of loss 1 and 2 px from an edge
    double ragged = 0.25;  ///< chance that a pixel at an edge shows its neighbour
};

/// Depth and identity of what a pinhole Kinect v1 sees, drawn piece by piece, then measured with
/// its noise. Everything happens within a rectangle, so that a body alone costs little.
class ActorCanvas {
  public:
    explicit ActorCanvas(const RigParameters& rig);

    [[nodiscard]] const CameraModel& camera() const { return rig_.depth; }
    [[nodiscard]] raycast::Rect whole() const { return {0, 0, z_.width(), z_.height()}; }

    /// Empties the rectangle (widened to groups of eight pixels) to a wall at `wall_m`.
    void clear(const raycast::Rect& rect, float wall_m);
    /// Solids in view space, seen as `id`.
    void draw(std::span<const Primitive> solids, std::int32_t id);
    void draw(const ActorBody& body, std::span<const glm::vec3> view_m, int actor);
    /// Copies z and id of another canvas of the same size, whole.
    void copy(const ActorCanvas& from);

    /// True depth, metres; what is seen there.
    [[nodiscard]] const Image<float>& z_m() const { return z_; }
    [[nodiscard]] const Image<std::int32_t>& id() const { return id_; }

    /// Readings within the rectangle of the last clear(): projector shadow, range, and, if `noise`
    /// is given, ragged and lost edges and disparity noise, which depend on `seed` and the pixel.
    /// id() then belongs to what was read. Metres; 0: no reading.
    void measure(const CanvasNoise* noise, std::uint32_t seed, Image<float>& depth_m);

  private:
    void cast_shadow();
    void roughen(const CanvasNoise& noise, std::uint32_t seed);

    RigParameters rig_;
    Disparity disparity_;
    raycast::Quantiser quantiser_;
    CastView view_;
    raycast::Rect rect_;
    Image<float> z_;
    Image<std::int32_t> id_, lit_, new_id_;
    std::vector<float> exact_, rough_;  // unrounded raw values with a margin on all sides
    std::vector<std::uint16_t> raw_;
    std::vector<float> shadow_;
};

/// The solid as seen from another frame.
[[nodiscard]] Primitive moved(const Primitive& solid, const Pose& to_from_solid);

}  // namespace kino
