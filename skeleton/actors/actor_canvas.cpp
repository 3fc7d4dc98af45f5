#include "skeleton/actors/actor_canvas.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>

#include "base/check.h"
#include "skeleton/actors/mesh_raster.h"
#include "skeleton/synthetic/normal_quantile.h"

namespace kino {
namespace {

constexpr int kMargin = 8;
constexpr int kQuantiles = 4096;

const std::vector<float>& normal_quantiles() {
    static const std::vector<float> quantiles = [] {
        std::vector<float> q;
        for (int i = 0; i < kQuantiles; ++i) {
            q.push_back(static_cast<float>(normal_quantile((i + 0.5) / kQuantiles)));
        }
        return q;
    }();
    return quantiles;
}

std::uint32_t mixed(std::uint32_t h) {
    h ^= h >> 16;
    h *= 0x7feb352du;
    h ^= h >> 15;
    h *= 0x846ca68bu;
    return h ^ (h >> 16);
}

raycast::Rect groups_of_eight(const raycast::Rect& r, int width) {
    return {r.x0 & ~7, r.y0, std::min((r.x1 + 7) & ~7, width), r.y1};
}

}  // namespace

ActorCanvas::ActorCanvas(const RigParameters& rig)
    : rig_(rig),
      disparity_(rig.disparity, rig.min_depth_m, rig.max_depth_m),
      view_(rig.depth, Pose{}),
      z_(rig.depth.width, rig.depth.height, 0),
      id_(rig.depth.width, rig.depth.height, 0),
      lit_(rig.depth.width, rig.depth.height, 0),
      new_id_(rig.depth.width, rig.depth.height, 0) {
    KINO_CHECK(!rig.depth.has_distortion() && rig.depth.width % 8 == 0);
    const double near = std::max(rig.min_depth_m, 0.3), far = std::min(rig.max_depth_m, 10.0);
    const auto raw_near = disparity_.raw_exact(near), raw_far = disparity_.raw_exact(far);
    KINO_CHECK(raw_near && raw_far);
    const double factor = (*raw_far - *raw_near) / (1 / near - 1 / far);
    quantiser_.factor = static_cast<float>(factor);
    quantiser_.offset = static_cast<float>(*raw_near + factor / near);
    const auto& table = disparity_.table();
    int first = 0, last = Disparity::kLevels - 1;
    while (first < last && !(table[static_cast<std::size_t>(first)] > 0)) ++first;
    while (last > first && !(table[static_cast<std::size_t>(last)] > 0)) --last;
    quantiser_.raw_min = first;
    quantiser_.raw_max = last;
    quantiser_.normal_quantiles = normal_quantiles().data();
    rect_ = whole();
}

void ActorCanvas::clear(const raycast::Rect& rect, float wall_m) {
    rect_ = groups_of_eight(intersect(rect, whole()), z_.width());
    for (int y = rect_.y0; y < rect_.y1; ++y) {
        std::fill(z_.row(y) + rect_.x0, z_.row(y) + rect_.x1, wall_m);
        std::fill(id_.row(y) + rect_.x0, id_.row(y) + rect_.x1, kSceneId);
    }
}

void ActorCanvas::copy(const ActorCanvas& from) {
    KINO_CHECK(from.z_.size() == z_.size());
    z_ = from.z_;
    id_ = from.id_;
    rect_ = whole();
}

void ActorCanvas::draw(std::span<const Primitive> solids, std::int32_t id) {
    const raycast::Target target{
        view_.ray_x().data(), view_.ray_y().data(), z_.data(), id_.data(), nullptr, z_.width()};
    for (const Primitive& solid : solids) {
        const raycast::Rect bounds = intersect(view_.bounds(solid), rect_);
        if (any_pixel(bounds)) raycast::kernels().nearest(view_.prepare(solid, id), bounds, target);
    }
}

void ActorCanvas::draw(const ActorBody& body, std::span<const glm::vec3> view_m, int actor) {
    const raycast::Target target{nullptr, nullptr, z_.data(), id_.data(), nullptr, z_.width()};
    draw_mesh(body, view_m, rig_.depth, rect_, kActorId * actor, target);
}

// The projector stands to the camera's right on the same rows. Seen from there a surface of
// disparity d lies d pixels to the left of where the camera has it; the nearest wins.
void ActorCanvas::cast_shadow() {
    const float base_px =
        static_cast<float>(rig_.depth.fx * rig_.disparity.emitter_distance_cm / 100);
    const int width = z_.width();
    const int reach = static_cast<int>(base_px / 0.25f) + 2;  // nearer than any reading
    constexpr float kTolerance = 0.75f;                       // px of disparity
    for (int y = rect_.y0; y < rect_.y1; ++y) {
        shadow_.assign(static_cast<std::size_t>(width + reach + 2), 0.0f);
        const float* z = z_.row(y);
        std::int32_t* lit = lit_.row(y);
        const auto place = [&](int x, float d) {
            return static_cast<float>(x + reach) - std::min(d, static_cast<float>(reach - 1));
        };
        for (int x = rect_.x0; x < rect_.x1; ++x) {
            const float d = base_px / z[x], at = place(x, d);
            const auto i = static_cast<std::size_t>(at);
            shadow_[i] = std::max(shadow_[i], d);
            shadow_[i + 1] = std::max(shadow_[i + 1], d);
        }
        for (int x = rect_.x0; x < rect_.x1; ++x) {
            const float d = base_px / z[x], at = place(x, d);
            const auto i = static_cast<std::size_t>(at + 0.5f);
            lit[x] = d + kTolerance >= shadow_[i] ? -1 : 0;
        }
    }
}

// Edges of a Kinect's picture wander by a pixel: there, some pixels show a neighbour.
void ActorCanvas::roughen(const CanvasNoise& noise, std::uint32_t seed) {
    const auto chance = static_cast<std::uint32_t>(noise.ragged * (1 << 20));
    const auto jump = static_cast<float>(noise.edge_jump_steps);
    const int pitch = z_.width() + 2 * kMargin;
    rough_ = exact_;
    new_id_ = id_;
    for (int y = rect_.y0 + 1; y < rect_.y1 - 1; ++y) {
        const float* row = exact_.data() + std::ptrdiff_t{y} * pitch + kMargin;
        for (int x = rect_.x0 + 1; x < rect_.x1 - 1; ++x) {
            const float here = row[x];
            if (std::abs(row[x - 1] - here) <= jump && std::abs(row[x + 1] - here) <= jump &&
                std::abs(row[x - pitch] - here) <= jump &&
                std::abs(row[x + pitch] - here) <= jump) {
                continue;
            }
            const std::uint32_t bits =
                mixed(static_cast<std::uint32_t>(y * z_.width() + x) ^ mixed(seed + 77u));
            if ((bits >> 12) >= chance) continue;
            constexpr int kStep[4][2] = {{-1, 0}, {1, 0}, {0, -1}, {0, 1}};
            const auto& step = kStep[bits & 3u];
            rough_[static_cast<std::size_t>(row + x - exact_.data())] =
                row[x + step[0] + step[1] * pitch];
            new_id_.at(x, y) = id_.at(x + step[0], y + step[1]);
            lit_.at(x, y) = lit_.at(x + step[0], y + step[1]);
        }
    }
    exact_.swap(rough_);
    std::swap(id_, new_id_);
}

void ActorCanvas::measure(const CanvasNoise* noise, std::uint32_t seed, Image<float>& depth_m) {
    const int width = z_.width(), height = z_.height(), pitch = width + 2 * kMargin;
    KINO_CHECK(depth_m.width() == width && depth_m.height() == height);
    exact_.resize(static_cast<std::size_t>(pitch) * static_cast<std::size_t>(height));
    raw_.resize(static_cast<std::size_t>(width));
    const raycast::Kernels& k = raycast::kernels();
    const auto row_of = [&](int y) {
        return exact_.data() + std::ptrdiff_t{std::clamp(y, rect_.y0, rect_.y1 - 1)} * pitch +
               kMargin;
    };
    cast_shadow();
    const int count = rect_.x1 - rect_.x0;
    for (int y = rect_.y0; y < rect_.y1; ++y) {
        k.disparity(quantiser_, z_.row(y) + rect_.x0, count, row_of(y) + rect_.x0);
    }
    raycast::Quantiser q = quantiser_;
    if (noise) {
        roughen(*noise, seed);
        q.sigma = static_cast<float>(noise->sigma_steps);
        q.jump = static_cast<float>(noise->edge_jump_steps);
        q.drop_next = static_cast<std::uint32_t>(noise->drop_next * (1 << 20));
        q.drop_second = static_cast<std::uint32_t>(noise->drop_second * (1 << 20));
        q.seed = mixed(seed * 0x9E3779B9u + 0x7F4A7C15u);
    }
    for (int y = rect_.y0; y < rect_.y1; ++y) {
        float* row = row_of(y);
        std::fill(row + rect_.x0 - kMargin, row + rect_.x0, row[rect_.x0]);  // no edge
        std::fill(row + rect_.x1, row + rect_.x1 + kMargin, row[rect_.x1 - 1]);
    }
    const auto& table = disparity_.table();
    for (int y = rect_.y0; y < rect_.y1; ++y) {
        const float* rows[5];
        for (int i = 0; i < 5; ++i) rows[i] = row_of(y + i - 2) + rect_.x0;
        k.measure(q, rows, lit_.row(y) + rect_.x0, static_cast<std::uint32_t>(y * width + rect_.x0),
                  count, raw_.data());
        float* out = depth_m.row(y) + rect_.x0;
        for (int x = 0; x < count; ++x) out[x] = table[raw_[static_cast<std::size_t>(x)]];
    }
}

Primitive moved(const Primitive& solid, const Pose& to_from_solid) {
    Primitive out = solid;
    out.origin_m = to_from_solid * solid.origin_m;
    out.axes = glm::mat3_cast(to_from_solid.rotation) * solid.axes;
    return out;
}

}  // namespace kino
