#include "calibration/depth_points.h"

#include "calibration/registration_kernel.h"

namespace kino {

static_assert(sizeof(glm::vec3) == 12 && sizeof(RayXy) == 8);

void unproject_depth(const Image<float>& depth_m, const Image<RayXy>& rays,
                     Image<glm::vec3>& points) {
    KINO_CHECK_EQ(depth_m.width(), rays.width());
    KINO_CHECK_EQ(depth_m.height(), rays.height());
    points.resize(depth_m.width(), depth_m.height());
    registration::best().unproject(depth_m.data(), reinterpret_cast<const float*>(rays.data()),
                                   depth_m.size(), reinterpret_cast<float*>(points.data()));
}

}  // namespace kino
