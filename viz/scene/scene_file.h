#pragma once

#include <cstdint>
#include <filesystem>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/body.h"
#include "base/error.h"
#include "viz/scene/scene.h"

namespace kino {

/// A scene file (docs/scenes.md): what stands on the stage, what lights it, and who of the people
/// leads what. Nothing is loaded or made yet. Stage space: y up, metres, the origin on the floor
/// under the person, z towards the sensor, x to its left as it looks (right in its picture).

/// sRGB, "#rrggbb" in the file.
struct SceneColor {
    std::uint8_t r = 255, g = 255, b = 255;
    friend bool operator==(const SceneColor&, const SceneColor&) = default;
};
[[nodiscard]] glm::vec3 to_linear(const SceneColor& color);

struct SceneLobe {
    LobeKind kind = LobeKind::lambert;
    SceneColor color;
    double weight = 1;
    double roughness = 0.5;
    friend bool operator==(const SceneLobe&, const SceneLobe&) = default;
};

struct SceneLayer {
    std::vector<SceneLobe> lobes;
    SceneColor transmission{0, 0, 0};
    friend bool operator==(const SceneLayer&, const SceneLayer&) = default;
};

struct SceneMaterial {
    std::string name;
    SceneColor color{204, 204, 204};
    double glow = 0;  ///< light it sends out by itself, in parts of its colour
    double opacity = 1;
    MaterialKind kind = MaterialKind::layered;
    int steps = 3;                   ///< of a toon material
    std::vector<SceneLayer> layers;  ///< top first
    friend bool operator==(const SceneMaterial&, const SceneMaterial&) = default;
};

enum class SceneShape : std::uint8_t {
    box,       ///< centred
    sphere,    ///< centred; size: diameters
    cylinder,  ///< centred, axis y; size: diameter, height, diameter
    plane,     ///< x by z, looking up
    room,      ///< a box seen from within, standing on the origin
    column,    ///< shaft with plinth and capital, standing on the origin
    chair,     ///< thin legs, standing on the origin, its front to +z
    gltf       ///< `file`; size is not used
};

struct SceneRepeat {
    int count = 1;
    glm::dvec3 step_m{1, 0, 0};
    friend bool operator==(const SceneRepeat&, const SceneRepeat&) = default;
};

/// Copies that stand a little off, each its own way.
struct SceneScatter {
    int seed = 1;
    glm::dvec3 by_m{0};   ///< at most this far to either side
    double turn_deg = 0;  ///< about y, to either side
    friend bool operator==(const SceneScatter&, const SceneScatter&) = default;
};

struct SceneMesh {
    SceneShape shape = SceneShape::box;
    std::string file;      ///< glTF, relative to the scene file and within its folder
    std::string material;  ///< empty: the first; of a glTF file: its own
    glm::dvec3 size_m{1};
    glm::dvec3 at_m{0};
    glm::dvec3 turn_deg{0};  ///< about x, y, z; y first, then x, then z of the turned object
    glm::dvec3 scale{1};
    std::vector<SceneRepeat> repeat;
    std::optional<SceneScatter> scatter;
    friend bool operator==(const SceneMesh&, const SceneMesh&) = default;
};

struct SceneLight {
    LightKind kind = LightKind::point;
    glm::dvec3 at_m{0};  ///< of a role: off the joint, in stage axes
    glm::dvec3 direction{0, -1, 0};
    SceneColor color;
    double intensity = 1;  ///< irradiance at 1 m
    double radius_m = 3;
    glm::dvec2 cone_deg{16, 28};  ///< half angles of full light, and of none
    bool shadow = false;
    bool indirect = false;
    std::vector<std::string> only;  ///< materials it lights, "live" for the person; empty: all
    friend bool operator==(const SceneLight&, const SceneLight&) = default;
};

enum class SceneMovement : std::uint8_t { still, drift, orbit, rise };
enum class SceneWhen : std::uint8_t { always, idle, people };

/// Many lights by chance, which move within a box.
struct SceneSwarm {
    int count = 100;
    int seed = 1;
    /// Only as many of them as bring the scene's local lights to this number; 0: all.
    int fill_to = 0;
    SceneWhen when = SceneWhen::always;
    glm::dvec3 center_m{0, 1.2, 0};
    glm::dvec3 size_m{4, 2, 4};
    SceneMovement movement = SceneMovement::drift;
    double speed_m_s = 0.2;
    std::vector<SceneColor> palette;
    glm::dvec2 intensity{0.05, 0.1};
    glm::dvec2 radius_m{0.5, 0.8};
    double bead_m = 0;  ///< diameter of a glowing ball at each; 0: none
    bool shadow = false;
    friend bool operator==(const SceneSwarm&, const SceneSwarm&) = default;
};

/// What a joint leaves behind: lights that fade, and a stroke of light between them.
struct SceneTrail {
    int lights = 256;
    double spacing_m = 0.03;
    double life_s = 8;
    std::vector<SceneColor> palette;
    double palette_m = 2;  ///< way on which the palette goes round once
    glm::dvec3 off_m{0};   ///< off the joint, in stage axes
    double intensity = 0.1;
    double radius_m = 0.6;
    double stroke_m = 0.012;  ///< width; 0: none
    friend bool operator==(const SceneTrail&, const SceneTrail&) = default;
};

/// Objects at a joint or on a circle around it.
struct SceneProp {
    SceneShape shape = SceneShape::sphere;
    std::string file;
    std::vector<std::string> materials;  ///< in turn; empty: the first
    glm::dvec3 size_m{0.1};
    glm::dvec3 off_m{0};
    int copies = 1;
    double orbit_m = 0;
    double period_s = 6;
    friend bool operator==(const SceneProp&, const SceneProp&) = default;
};

enum class SceneAim : std::uint8_t {
    fixed,  ///< as `direction` says, in stage axes
    limb,   ///< from the joint before it through the joint: where a forearm points
    mirror  ///< as limb, but into the picture: who points at the screen shines behind it
};

/// What people lead. At least one of light, trail and prop.
struct SceneRole {
    std::vector<Joint> joints;
    int people = 2;  ///< that have this role, at most
    SceneAim aim = SceneAim::fixed;
    double fade_s = 0.5;  ///< a joint that is lost takes its things with it in this time
    std::vector<SceneColor> palette;  ///< of lights, by person, then joint; empty: the light's
    std::optional<SceneLight> light;
    std::optional<SceneTrail> trail;
    std::optional<SceneProp> prop;
    friend bool operator==(const SceneRole&, const SceneRole&) = default;
};

enum class SceneShow : std::uint8_t { all, people, none };
struct SceneLive {
    SceneShow show = SceneShow::people;  ///< people: cut out of their room while any are tracked
    DepthStyle style = DepthStyle::mesh;
    int splat_px = 3;
    double margin_m = 0.16;  ///< that flesh and clothes stand off the bones
    bool casts_shadows = false;
    bool smooth_outline = true;  ///< of people who are cut out
    friend bool operator==(const SceneLive&, const SceneLive&) = default;
};

/// How pictures of a window are brought to the newest place of the head (viz/quality/zoom).
enum class SceneDeflect : std::uint8_t { none, pan, homography, depth_warp };

/// A screen that is looked through. Window space: origin in its centre, x to the viewer's right, y
/// up, z towards the viewer; axes of the stage, turned.
struct SceneWindow {
    glm::dvec2 size_m{0.52, 0.32};   ///< width, height
    glm::dvec3 at_m{0, 1.2, 0};      ///< its centre, on the stage
    double turn_deg = 0;             ///< about y
    glm::dvec3 sensor_m{0, 0.2, 0};  ///< window space; it looks at the viewer
    double sensor_tilt_deg = 0;      ///< upwards
    glm::dvec3 eye_m{0, 0, 0.6};     ///< window space; where nobody is seen
    SceneDeflect deflect = SceneDeflect::pan;
    int most_zoom = 1;  ///< while the head moves quickly, pictures are up to so much coarser
    friend bool operator==(const SceneWindow&, const SceneWindow&) = default;
};

struct SceneCamera {
    glm::dvec3 eye_m{0, 1.4, 3};
    glm::dvec3 target_m{0, 1.1, 0};
    std::optional<SceneWindow> window;  ///< set: the nearest person's head leads the view
    friend bool operator==(const SceneCamera&, const SceneCamera&) = default;
};

/// Effects that there are; what is not asked for costs nothing.
struct SceneEffects {
    bool skeleton = false;
    friend bool operator==(const SceneEffects&, const SceneEffects&) = default;
};

/// Who chooses how coarse light, and how coarse whole pictures are.
enum class SceneLodBy : std::uint8_t { fixed, budget };
enum class SceneZoomBy : std::uint8_t {
    fixed,
    reactive,    ///< the last frame's time
    predictive,  ///< counted work before the frame
    head         ///< how fast the viewer, or else the camera, moves
};

/// How accurately the scene asks to be drawn; a command line goes before it.
struct SceneQuality {
    SceneLodBy lod_by = SceneLodBy::fixed;
    double lod = 1;  ///< fixed: light on a picture so many times coarser
    SceneZoomBy zoom_by = SceneZoomBy::fixed;
    int zoom = 1;                    ///< fixed: whole pictures so many times coarser
    int most_zoom = 4;               ///< chosen: at most
    double target_ms = 1000.0 / 30;  ///< that budget, reactive and predictive hold
    int samples = 1;                 ///< a pixel; 1 or 4
    double fix = 0;  ///< with coarse light: at most this share of the pixels is shaded anew
    friend bool operator==(const SceneQuality&, const SceneQuality&) = default;
};

enum class SceneOrigin : std::uint8_t { person, world };

struct SceneFile {
    int version = 1;
    std::string name;
    std::string about;
    SceneOrigin origin = SceneOrigin::person;
    ColorMode color = ColorMode::relit;
    SceneColor ambient{8, 8, 10};
    double exposure = 1;
    SceneColor background_top{6, 7, 10};
    SceneColor background_bottom{2, 2, 4};
    SceneLive live;
    SceneCamera camera;
    SceneEffects effects;
    SceneQuality quality;
    std::vector<SceneMaterial> materials;
    std::vector<SceneMesh> meshes;
    std::vector<SceneLight> lights;
    std::vector<SceneSwarm> swarms;
    std::vector<SceneRole> roles;
    friend bool operator==(const SceneFile&, const SceneFile&) = default;
};

constexpr std::size_t kMaxSceneFileBytes = std::size_t{1} << 20;
constexpr int kMaxSceneFileDepth = 16;  ///< of brackets
constexpr int kMaxStageLights = 4096;   ///< all that may burn at once
constexpr int kMaxStageNodes = 8192;    ///< meshes that may be there at once

/// Local lights that may burn at once, and meshes that may be there.
struct SceneCount {
    int lights = 0;
    int nodes = 0;
};
[[nodiscard]] SceneCount largest_count(const SceneFile& file);
/// Copies of a mesh: the product of its repeats.
[[nodiscard]] int copies_of(const SceneMesh& mesh);

/// Any text is safe. Errors name their place as "where#/lights/3/radius_m" and what is allowed.
[[nodiscard]] Result<SceneFile> scene_file_from_json(std::string_view text,
                                                     const std::string& where);
/// With every key, so that nothing depends on defaults; reads back to the same value.
[[nodiscard]] std::string scene_file_to_json(const SceneFile& file);
[[nodiscard]] Result<SceneFile> read_scene_file(const std::filesystem::path& path);
/// The JSON Schema (draft 2020-12) of scene files: every key, its type, range and meaning.
[[nodiscard]] std::string scene_file_schema();

}  // namespace kino
