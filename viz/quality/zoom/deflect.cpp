#include "viz/quality/zoom/deflect.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <vector>

#include "base/check.h"
#include "viz/quality/zoom/deflect_rows.h"

namespace kino {
namespace {

constexpr double kMostTurnRad = 0.3490658503988659;  // 20 degrees

bool all_finite(const View& view) {
    const Projection& k = view.projection;
    return is_valid(view.world_from_view) && std::isfinite(k.fx) && std::isfinite(k.fy) &&
           std::isfinite(k.cx) && std::isfinite(k.cy) && k.fx > 0 && k.fy > 0;
}

/// Rays of `to` in the space of `from`, without the scale of their pixels.
struct Seen {
    glm::dmat3 ray_of_pixel;
    glm::dvec3 eye;
};

Seen seen_from(const View& to, const View& from) {
    const Projection& k = to.projection;
    const Pose from_to = inverse(from.world_from_view) * to.world_from_view;
    const glm::dmat3 unproject(glm::dvec3(1 / k.fx, 0, 0), glm::dvec3(0, 1 / k.fy, 0),
                               glm::dvec3(-k.cx / k.fx, -k.cy / k.fy, 1));
    return {glm::mat3_cast(from_to.rotation) * unproject, from_to.translation};
}

void set(float (&to)[3], const glm::dvec3& from) {
    for (int i = 0; i < 3; ++i) to[i] = static_cast<float>(from[i]);
}

std::int64_t deflect_by(const deflect_rows::Kernels& kernels, const DrawnPicture& drawn,
                        const View& shown, double inverse_z, bool smooth,
                        const ImageView<std::uint32_t>& out) {
    KINO_CHECK(drawn.picture.width == drawn.view.width && drawn.picture.width > 0);
    KINO_CHECK(drawn.picture.height == drawn.view.height && drawn.picture.height > 0);
    const bool depths = drawn.inverse_z.data != nullptr;
    KINO_CHECK(!depths || (drawn.inverse_z.width == drawn.picture.width &&
                           drawn.inverse_z.height == drawn.picture.height));
    const Seen seen = seen_from(shown, drawn.view);
    const Projection& k = drawn.view.projection;
    deflect_rows::Row row{.fx = static_cast<float>(k.fx),
                          .fy = static_cast<float>(k.fy),
                          .cx = static_cast<float>(k.cx),
                          .cy = static_cast<float>(k.cy),
                          .width = drawn.picture.width,
                          .height = drawn.picture.height,
                          .inverse_z = drawn.inverse_z.data,
                          .depth_pitch = drawn.inverse_z.pitch,
                          .plane = static_cast<float>(inverse_z)};
    set(row.step, seen.ray_of_pixel[0]);
    set(row.eye, seen.eye);
    const deflect_rows::Source source{drawn.picture.data, drawn.picture.pitch, drawn.picture.width,
                                      drawn.picture.height};
    std::vector<float> u(static_cast<std::size_t>(std::max(out.width, 0)));
    std::vector<float> v(u.size());
    std::int64_t outside = 0;
    for (int y = 0; y < out.height; ++y) {
        set(row.ray, seen.ray_of_pixel * glm::dvec3(0, y, 1));
        outside += kernels.places(row, out.width, u.data(), v.data());
        (smooth ? kernels.bilinear : kernels.nearest)(source, u.data(), v.data(), out.width,
                                                      out.row(y));
    }
    return outside;
}

}  // namespace

glm::dmat3 plane_homography(const View& to, const View& from, double inverse_z) {
    const Seen seen = seen_from(to, from);
    const Projection& k = from.projection;
    // The ray d from e meets z = 1/w at e + s d, s = (1/w - e.z) / d.z; times w d.z that is
    // d (1 - w e.z) + e w d.z.
    const glm::dmat3 d = seen.ray_of_pixel * (1 - inverse_z * seen.eye.z);
    const glm::dvec3 row_z(seen.ray_of_pixel[0].z, seen.ray_of_pixel[1].z, seen.ray_of_pixel[2].z);
    const glm::dmat3 met = d + inverse_z * glm::outerProduct(seen.eye, row_z);
    const glm::dmat3 project(glm::dvec3(k.fx, 0, 0), glm::dvec3(0, k.fy, 0),
                             glm::dvec3(k.cx, k.cy, 1));
    return project * met;
}

View deflectable(const View& wanted, const View& drawn) {
    if (!all_finite(wanted)) return drawn;
    View view = wanted;
    const glm::dquat& a = drawn.world_from_view.rotation;
    const glm::dquat& b = wanted.world_from_view.rotation;
    const double angle = 2 * std::acos(std::clamp(std::abs(glm::dot(a, b)), 0.0, 1.0));
    if (angle > kMostTurnRad) {
        view.world_from_view.rotation =
            interpolate(drawn.world_from_view, wanted.world_from_view, kMostTurnRad / angle)
                .rotation;
    }
    return view;
}

glm::ivec2 pan_of(const View& shown, const View& drawn, double inverse_z) {
    const glm::dvec3 centre((shown.width - 1) / 2.0, (shown.height - 1) / 2.0, 1);
    const glm::dvec3 at = plane_homography(shown, drawn, inverse_z) * centre;
    const double w = std::max(at.z, 1e-4);
    const auto whole = [](double shift, int size) {
        return static_cast<int>(std::lround(std::clamp(shift, -2.0 * size, 2.0 * size)));
    };
    return {whole(at.x / w - centre.x, shown.width), whole(at.y / w - centre.y, shown.height)};
}

double invert_depths(const ImageView<const float>& view_z_m, double nearest_z_m,
                     Image<float>& inverse_z) {
    inverse_z.resize(view_z_m.width, view_z_m.height);
    const auto most = static_cast<float>(1 / nearest_z_m);
    double sum = 0;
    for (int y = 0; y < view_z_m.height; ++y) {
        const float* from = view_z_m.row(y);
        float* to = inverse_z.row(y);
        float row_sum = 0;
        for (int x = 0; x < view_z_m.width; ++x) {
            // 0 stands for nothing there, and what is no number is not there either.
            const float w = from[x] > 0 ? 1 / from[x] : 0;
            to[x] = w < most ? w : most;
            row_sum += to[x];
        }
        sum += row_sum;
    }
    const auto pixels = static_cast<double>(inverse_z.size());
    return pixels > 0 ? sum / pixels : 0;
}

std::int64_t deflect(const DrawnPicture& drawn, const View& shown, double inverse_z, bool smooth,
                     const ImageView<std::uint32_t>& out) {
    const bool wide = __builtin_cpu_supports("avx2") != 0;
    return deflect_by(wide ? deflect_rows::avx2() : deflect_rows::portable(), drawn, shown,
                      inverse_z, smooth, out);
}

std::int64_t deflect_portable(const DrawnPicture& drawn, const View& shown, double inverse_z,
                              bool smooth, const ImageView<std::uint32_t>& out) {
    return deflect_by(deflect_rows::portable(), drawn, shown, inverse_z, smooth, out);
}

}  // namespace kino
