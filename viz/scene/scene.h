#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <memory>
#include <optional>
#include <vector>

#include "base/body.h"
#include "base/image.h"
#include "base/pose.h"
#include "calibration/rig.h"
#include "viz/scene/material.h"
#include "viz/scene/mesh_asset.h"

namespace kino {

/// A depth frame ready to be drawn: immutable once published, shared by count.
struct DepthSurface {
    Image<float> depth_m;  ///< along the depth camera's axis, 0 = no reading
    Image<Rgba8> color;    ///< colour of each depth pixel, sRGB; alpha 0: not known. May be empty
    std::shared_ptr<const Image<RayXy>> rays;
    double focal_px = 0;        ///< fx of the depth camera, for footprints and the edge test
    std::uint64_t version = 0;  ///< differs from frame to frame: what tells the GPU to upload
};

enum class DepthStyle : std::uint8_t { cloud, mesh };

/// When two neighbouring depth pixels belong to one surface.
enum class EdgeRule : std::uint8_t {
    fixed,       ///< depths differ by less than 75 mm, as the chapter prints it
    range_aware  ///< T(z) = 3 * 0.00307 z^2 + tan(80 deg) z / f
};

/// How the live picture's colour comes about (docs/overview.md, Colour).
enum class ColorMode : std::uint8_t {
    captured,  ///< exactly what the camera saw
    mixed,     ///< captured light plus virtual light
    relit      ///< captured colour taken as albedo, virtual light only
};

struct LiveDepth {
    std::uint32_t id = 1;
    std::shared_ptr<const DepthSurface> surface;
    Pose world_from_depth;
    Pose previous_world_from_depth;  ///< one rendered frame ago
    DepthStyle style = DepthStyle::mesh;
    EdgeRule edge_rule = EdgeRule::range_aware;
    /// Largest splat, px; 1 draws every point as one pixel. Clouds only.
    int splat_cap_px = 1;
    bool fill_holes = true;      ///< one-pixel holes between splats take a neighbour's colour
    bool casts_shadows = false;  ///< from lights with ray-cast shadows, where the scene is staged
};

enum class LightKind : std::uint8_t { directional, point, spot };

enum class LightShadow : std::uint8_t {
    none,
    raycast  ///< hard shadows by rays; what asks for them brings the acceleration structure
};

struct Light {
    LightKind kind = LightKind::directional;
    glm::dvec3 position{0};             ///< world; point and spot lights
    glm::dvec3 direction{0, -1, 0};     ///< world, the way the light travels; not point lights
    glm::vec3 color{1};                 ///< linear; irradiance at 1 m (point, spot) or everywhere
    float radius_m = 5;                 ///< point and spot lights end here, smoothly
    float inner_rad = 0.3f;             ///< spot: full light within this half angle
    float outer_rad = 0.5f;             ///< spot: none beyond this one
    std::uint32_t material_mask = ~0u;  ///< bit i: lights surfaces of material i
    LightShadow shadow = LightShadow::none;
    bool indirect = false;  ///< one bounce of it is simulated (spot lights)
};

/// How a vertex moves that several joints hold.
enum class SkinBlend : std::uint8_t {
    linear,          ///< the mean of the joints' matrices: thin where a limb is twisted
    dual_quaternion  ///< Kavan et al. 2008: rigid motions only; the joints' scale is blended
                     ///< linearly
};

/// A mesh in the scene.
struct MeshNode {
    std::uint32_t id = 1;  ///< stable from frame to frame, 1 .. 65535; 0 is the live depth frame
    std::shared_ptr<const MeshAsset> mesh;
    glm::dmat4 world_from_object{1};           ///< may scale, also differently along the axes
    glm::dmat4 previous_world_from_object{1};  ///< one rendered frame ago
    std::uint32_t material = 0;                ///< index into Scene::materials, plus one
    /// Skinned meshes: object_from_bind of every joint; null draws the bind pose.
    std::shared_ptr<const std::vector<glm::mat4>> pose;
    SkinBlend skin = SkinBlend::linear;
};

struct BodyNode {
    std::uint32_t id = 0;
    Body body;  ///< joints in depth-camera space
    Pose world_from_depth;
};

/// What is to be drawn, as plain data. What is not in here costs nothing.
struct Scene {
    std::int64_t frame_index = 0;
    double dt_s = 0;
    std::optional<LiveDepth> live;
    std::vector<BodyNode> bodies;
    std::vector<MeshNode> meshes;
    std::vector<Material> materials;  ///< at most kMaxMaterials - 1
    std::vector<Light> lights;
    ColorMode color_mode = ColorMode::captured;
    glm::vec3 ambient{0.08f};  ///< linear; relit only
    float exposure = 1;
    glm::vec3 background_top{0.13f, 0.15f, 0.18f};      ///< sRGB
    glm::vec3 background_bottom{0.05f, 0.055f, 0.07f};  ///< sRGB
};

}  // namespace kino
