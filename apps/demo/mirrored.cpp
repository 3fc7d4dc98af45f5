#include "apps/demo/mirrored.h"

#include <utility>

namespace kino::demo {
namespace {

Joint other_side(Joint joint) {
    const auto i = static_cast<int>(joint);
    constexpr int kLeftArm = 4, kRightArm = 8, kLeftLeg = 12, kRightLeg = 16, kLimb = 4;
    int other = i;
    if (i >= kLeftArm && i < kLeftArm + kLimb) other = i + kRightArm - kLeftArm;
    if (i >= kRightArm && i < kRightArm + kLimb) other = i - (kRightArm - kLeftArm);
    if (i >= kLeftLeg && i < kLeftLeg + kLimb) other = i + kRightLeg - kLeftLeg;
    if (i >= kRightLeg && i < kRightLeg + kLimb) other = i - (kRightLeg - kLeftLeg);
    return static_cast<Joint>(other);
}

template <class T>
Image<T> turned_over(const Image<T>& image) {
    Image<T> out(image.width(), image.height());
    for (int y = 0; y < image.height(); ++y) {
        const T* from = image.row(y);
        T* to = out.row(y);
        for (int x = 0; x < image.width(); ++x) to[x] = from[image.width() - 1 - x];
    }
    return out;
}

}  // namespace

BodyFrame mirrored(const BodyFrame& frame) {
    BodyFrame out = frame;
    for (std::size_t b = 0; b < frame.bodies.size(); ++b) {
        for (std::size_t i = 0; i < kJointCount; ++i) {
            JointPosition& joint = out.bodies[b].joints[i];
            joint = frame.bodies[b][other_side(static_cast<Joint>(i))];
            joint.position_m.x = -joint.position_m.x;
        }
    }
    return out;
}

std::shared_ptr<const DepthSurface> SurfaceMirror::of(const DepthSurface& surface) {
    if (surface.rays != rays_) {
        rays_ = surface.rays;
        mirrored_rays_.reset();
        if (rays_) {
            Image<RayXy> rays = turned_over(*rays_);
            for (int y = 0; y < rays.height(); ++y) {
                for (int x = 0; x < rays.width(); ++x) rays.row(y)[x].x = -rays.row(y)[x].x;
            }
            mirrored_rays_ = std::make_shared<const Image<RayXy>>(std::move(rays));
        }
    }
    auto out = std::make_shared<DepthSurface>();
    out->depth_m = turned_over(surface.depth_m);
    if (!surface.color.empty()) out->color = turned_over(surface.color);
    out->rays = mirrored_rays_;
    out->focal_px = surface.focal_px;
    out->version = surface.version;
    return out;
}

}  // namespace kino::demo
