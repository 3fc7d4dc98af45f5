#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "viz/scene/scene.h"

namespace kino {

/// Corners in the soup's space: world axes, metres, from the soup's center.
struct Triangle {
    glm::vec3 a, b, c;
};

enum class TriangleFault : std::uint8_t {
    none,
    not_finite,  ///< or farther than 1e9 m off, where squares of lengths lose their meaning
    zero_area    ///< exactly, in double: slivers are good triangles
};
[[nodiscard]] TriangleFault fault_of(const Triangle& triangle);

/// The triangles that rays may meet, without connections between them.
struct TriangleSoup {
    /// Where a triangle comes from.
    struct Source {
        std::uint32_t node = 0;  ///< MeshNode::id; 0: the live depth frame
        std::uint32_t face = 0;  ///< triangle of the mesh, or of the depth grid (2 * cell + half)
        friend bool operator==(const Source&, const Source&) = default;
    };
    glm::dvec3 center{0};  ///< world; where the soup's space has its origin
    std::vector<Triangle> triangles;
    std::vector<Source> sources;   ///< as long as triangles
    std::uint32_t not_finite = 0;  ///< left out
    std::uint32_t zero_area = 0;

    /// Takes the triangle unless it is faulty, which is counted.
    void add(const Triangle& triangle, Source source);
};

struct GatherOptions {
    bool meshes = true;
    bool live = false;    ///< the depth frame, too, by its own edge rule
    int live_stride = 1;  ///< every so many depth pixels
};

/// The live frame's alone, every `stride`-th depth pixel, relative to `center`.
[[nodiscard]] TriangleSoup gather_live_triangles(const LiveDepth& live, int stride,
                                                 const glm::dvec3& center);

/// The scene's meshes, posed, relative to a center among them.
[[nodiscard]] TriangleSoup gather_triangles(const Scene& scene, const GatherOptions& options = {});

}  // namespace kino
