#pragma once

#include <array>
#include <cstdint>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "base/image.h"
#include "base/time.h"

namespace kino {

constexpr int kPersonSlots = 6;

/// The floor in depth-camera space: dot(up, P) + height_m = 0 for points P on it, so that the left
/// side is a point's height above the floor and height_m the camera's.
struct FloorPlane {
    glm::vec3 up{0, -1, 0};  ///< unit; where no floor is known: against gravity, else (0, -1, 0)
    float height_m = 0;      ///< 0 where no floor is known
    float confidence = 0;    ///< 0 (no floor was seen) .. 1
    [[nodiscard]] bool known() const { return confidence > 0; }
};

/// Rotation from depth-camera axes to upright axes: x to the right, y up, z towards the
/// camera, level. Rows are the axes. The first argument is a unit vector in depth-camera space.
[[nodiscard]] glm::mat3 upright_from_camera(const glm::vec3& up);

/// Whole pixels, [x0, x1) x [y0, y1).
struct PixelBox {
    int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
    friend bool operator==(const PixelBox&, const PixelBox&) = default;
};

/// One person, as found in one depth frame.
struct Person {
    std::uint32_t id = 0;   ///< never given twice by one finder
    std::uint8_t slot = 0;  ///< 1..6, the value in the label image
    std::int32_t pixels = 0;
    PixelBox box;
    glm::vec3 centroid_m{0};               ///< of the visible surface, depth-camera space
    glm::vec3 velocity_m_s{0};             ///< of the centroid, smoothed, depth-camera space
    glm::vec3 box_min_m{0}, box_max_m{0};  ///< upright axes, y above the floor if that is known
    float area_m2 = 0;                     ///< of the surface seen, as if it faced the camera
    float confidence = 0;                  ///< 0..1
    bool touches_border = false;           ///< cut off by the edge of the picture
    bool merged = false;  ///< touches another person: the border between them is a guess
};

/// Somebody whose place is remembered while nothing of him is seen.
struct LostPerson {
    std::uint32_t id = 0;
    std::uint8_t slot = 0;
    glm::vec3 expected_m{0};  ///< depth-camera space
    TimeNs last_seen = 0;
};

struct PeopleFrame {
    TimeNs time = 0;
    Image<std::uint8_t> labels;  ///< size of the depth image: 0 nobody, 1..6 the person's slot
    std::vector<Person> people;  ///< by slot
    std::vector<LostPerson> lost;
    FloorPlane floor;
    float background_known = 0;  ///< share of the picture with a learned background
};

}  // namespace kino
