#include "skeleton/actors/mesh_raster.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "skeleton/synthetic/view.h"

namespace kino {
namespace {

struct Projected {
    float x, y, inverse_z;
};

struct Triangle {
    Projected a, b, c;
    std::int32_t id;
};

void fill(const Triangle& t, const raycast::Rect& clip, const raycast::Target& target) {
    const int x0 = std::max(clip.x0, static_cast<int>(std::ceil(std::min({t.a.x, t.b.x, t.c.x}))));
    const int x1 =
        std::min(clip.x1, static_cast<int>(std::floor(std::max({t.a.x, t.b.x, t.c.x}))) + 1);
    const int y0 = std::max(clip.y0, static_cast<int>(std::ceil(std::min({t.a.y, t.b.y, t.c.y}))));
    const int y1 =
        std::min(clip.y1, static_cast<int>(std::floor(std::max({t.a.y, t.b.y, t.c.y}))) + 1);
    if (x0 >= x1 || y0 >= y1) return;
    // Relative to the first pixel: small triangles keep their digits.
    const float left = static_cast<float>(x0), top = static_cast<float>(y0);
    const float ax = t.a.x - left, ay = t.a.y - top, bx = t.b.x - left, by = t.b.y - top,
                cx = t.c.x - left, cy = t.c.y - top;
    const float area = (bx - ax) * (cy - ay) - (cx - ax) * (by - ay);
    const float scale = 1.0f / area;
    const float slope_b = (t.b.inverse_z - t.a.inverse_z) * scale;
    const float slope_c = (t.c.inverse_z - t.a.inverse_z) * scale;
    // Neighbours share their edges: a hair over covers what rounding would leave open.
    constexpr float kHair = -1e-5f;
    for (int y = 0; y < y1 - y0; ++y) {
        const float py = static_cast<float>(y);
        const std::ptrdiff_t row = std::ptrdiff_t{y + y0} * target.pitch + x0;
        for (int x = 0; x < x1 - x0; ++x) {
            const float px = static_cast<float>(x);
            const float wa = (bx - px) * (cy - py) - (cx - px) * (by - py);
            const float wb = (cx - px) * (ay - py) - (ax - px) * (cy - py);
            const float wc = (ax - px) * (by - py) - (bx - px) * (ay - py);
            if (wa < kHair || wb < kHair || wc < kHair) continue;
            const float inverse_z = t.a.inverse_z + wb * slope_b + wc * slope_c;
            const float z = 1.0f / inverse_z;
            if (z >= target.z[row + x]) continue;
            target.z[row + x] = z;
            target.id[row + x] = t.id;
        }
    }
}

}  // namespace

raycast::Rect mesh_bounds(std::span<const glm::vec3> view_m, const CameraModel& camera) {
    float x0 = 1e9f, x1 = -1e9f, y0 = 1e9f, y1 = -1e9f;
    for (const glm::vec3& p : view_m) {
        if (p.z < kMeshNearM) continue;
        const float x = p.x / p.z, y = p.y / p.z;
        x0 = std::min(x0, x);
        x1 = std::max(x1, x);
        y0 = std::min(y0, y);
        y1 = std::max(y1, y);
    }
    if (x0 > x1) return {};
    const auto pixel = [](double focal, double center, float ray, int size) {
        return static_cast<int>(std::clamp(std::floor(focal * ray + center), 0.0, double(size)));
    };
    const raycast::Rect rect{
        pixel(camera.fx, camera.cx, x0, camera.width),
        pixel(camera.fy, camera.cy, y0, camera.height),
        std::min(pixel(camera.fx, camera.cx, x1, camera.width) + 2, camera.width),
        std::min(pixel(camera.fy, camera.cy, y1, camera.height) + 2, camera.height)};
    return any_pixel(rect) ? rect : raycast::Rect{};
}

raycast::Rect draw_mesh(const ActorBody& body, std::span<const glm::vec3> view_m,
                        const CameraModel& camera, const raycast::Rect& clip, std::int32_t first_id,
                        const raycast::Target& target) {
    const raycast::Rect rect = intersect(mesh_bounds(view_m, camera), clip);
    if (!any_pixel(rect)) return {};
    thread_local std::vector<Projected> seen;
    seen.resize(view_m.size());
    const auto fx = static_cast<float>(camera.fx), fy = static_cast<float>(camera.fy),
               cx = static_cast<float>(camera.cx), cy = static_cast<float>(camera.cy);
    for (std::size_t i = 0; i < view_m.size(); ++i) {
        const glm::vec3& p = view_m[i];
        const float inverse_z = p.z < kMeshNearM ? -1.0f : 1.0f / p.z;
        seen[i] = {fx * p.x * inverse_z + cx, fy * p.y * inverse_z + cy, inverse_z};
    }
    for (std::size_t i = 0; i < body.triangles.size(); ++i) {
        const auto& corner = body.triangles[i];
        Triangle t{seen[corner[0]], seen[corner[1]], seen[corner[2]],
                   first_id + static_cast<std::int32_t>(body.part[i])};
        if (t.a.inverse_z < 0 || t.b.inverse_z < 0 || t.c.inverse_z < 0) continue;
        // Anticlockwise to the eye is clockwise where y runs down.
        const float area = (t.b.x - t.a.x) * (t.c.y - t.a.y) - (t.c.x - t.a.x) * (t.b.y - t.a.y);
        if (area == 0 || (area > 0 && i < body.first_two_sided)) continue;
        if (area < 0) std::swap(t.b, t.c);
        fill(t, rect, target);
    }
    return rect;
}

}  // namespace kino
