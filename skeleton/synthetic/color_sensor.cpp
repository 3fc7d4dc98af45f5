#include "skeleton/synthetic/color_sensor.h"

#include <algorithm>
#include <array>
#include <cstring>

#include "base/check.h"
#include "calibration/projection.h"
#include "skeleton/synthetic/materials.h"

namespace kino {
namespace {

using glm::dvec3;

Pose color_from_world(const SyntheticScene& scene) {
    return scene.rig.color_from_depth * inverse(scene.world_from_depth);
}

glm::vec3 color_at(const SyntheticScene& scene, const Visibility& seen, const Pose& world_from_view,
                   int x, int y) {
    const std::int32_t id = seen.id().at(x, y);
    if (id < 0) return glm::vec3(0);
    const CastView& view = seen.view();
    const dvec3 point = world_from_view * (dvec3(view.ray_x().at(x, y), view.ray_y().at(x, y), 1) *
                                           static_cast<double>(seen.z_m().at(x, y)));
    const auto solids = static_cast<std::int32_t>(scene.furniture.size());
    return id < solids ? color_of_solid(scene.furniture[static_cast<std::size_t>(id)], point)
                       : color_of_room(scene.room, id - solids, point);
}

}  // namespace

ColorSensor::ColorSensor(const SyntheticScene& scene)
    : world_from_depth_(scene.world_from_depth),
      seen_(scene, CastView(*scene.rig.color, color_from_world(scene))),
      lights_(lights_for(color_from_world(scene))),
      still_(scene.rig.color->width, scene.rig.color->height),
      floor_x_(scene.rig.color->width, scene.rig.color->height, 1e9f),
      floor_z_(scene.rig.color->width, scene.rig.color->height, 1e9f) {
    paint_room(scene);
}

void ColorSensor::paint_room(const SyntheticScene& scene) {
    const int width = still_.width(), height = still_.height();
    const Pose view_from_world = color_from_world(scene),
               world_from_view = inverse(view_from_world);
    const Image<std::int32_t>& id = seen_.id();
    // Rotated grid: four samples that fall on four rows and four columns.
    constexpr std::array<std::array<double, 2>, 4> kOffsets = {
        {{-0.125, -0.375}, {0.375, -0.125}, {0.125, 0.375}, {-0.375, 0.125}}};
    std::vector<Visibility> samples;
    for (const auto& [dx, dy] : kOffsets) {
        samples.emplace_back(scene, seen_.view().shifted(dx, dy));
    }
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const std::int32_t here = id.at(x, y);
            const bool plain =
                std::all_of(samples.begin(), samples.end(),
                            [&](const Visibility& s) { return s.id().at(x, y) == here; });
            glm::vec3 sum(0);
            if (plain) {
                sum = color_at(scene, seen_, world_from_view, x, y);
            } else {
                for (const Visibility& s : samples) {
                    sum += color_at(scene, s, world_from_view, x, y) * 0.25f;
                }
            }
            still_.at(x, y) = to_rgba8(sum);
            if (seen_.part_of(here) != kPartFloor) continue;
            const CastView& view = seen_.view();
            const dvec3 point =
                world_from_view * (dvec3(view.ray_x().at(x, y), view.ray_y().at(x, y), 1) *
                                   static_cast<double>(seen_.z_m().at(x, y)));
            floor_x_.at(x, y) = static_cast<float>(point.x);
            floor_z_.at(x, y) = static_cast<float>(point.z);
        }
    }
}

void ColorSensor::draw(std::span<const Primitive> person, const Body* body,
                       std::span<std::uint32_t> rgba) {
    KINO_CHECK_EQ(rgba.size(), still_.size());
    seen_.draw(person);
    std::memcpy(rgba.data(), still_.data(), rgba.size_bytes());
    const raycast::Kernels& k = raycast::kernels();
    for (std::size_t i = 0; i < person.size(); ++i) {
        const raycast::Rect& rect = seen_.person_rects()[i];
        if (!any_pixel(rect)) continue;
        k.shade(seen_.person_solids()[i], paint_of(person[i]), lights_, rect, seen_.target(),
                rgba.data());
    }
    if (!body) return;

    // Spots below the feet, knees, hips and chest: wider and weaker the higher they hang.
    raycast::FloorSpots spots;
    raycast::Rect rect;
    for (const Joint joint :
         {Joint::foot_left, Joint::foot_right, Joint::ankle_left, Joint::ankle_right,
          Joint::knee_left, Joint::knee_right, Joint::hip_center, Joint::shoulder_center}) {
        const dvec3 p = world_from_depth_ * dvec3((*body)[joint].position_m);
        const double height = std::max(p.y, 0.0);
        const double radius = 0.13 + 0.55 * height;
        const double strength = 0.55 / (1 + 9 * height * height);
        const auto i = static_cast<std::size_t>(spots.count++);
        spots.x[i] = static_cast<float>(p.x);
        spots.z[i] = static_cast<float>(p.z);
        spots.inverse_radius2[i] = static_cast<float>(1 / (radius * radius));
        spots.strength[i] = static_cast<float>(strength);
        rect = join(rect, seen_.view().bounds(ellipsoid({p.x, 0, p.z}, glm::dmat3(1),
                                                        {radius, 0.002, radius}, kPartNone,
                                                        Covering::floor)));
    }
    if (any_pixel(rect)) {
        k.darken(spots, rect, seen_.target(), floor_x_.data(), floor_z_.data(),
                 seen_.first_person_id(), rgba.data());
    }
}

}  // namespace kino
