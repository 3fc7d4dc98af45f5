#pragma once

#include <array>
#include <string_view>
#include <utility>

#include "viz/scene/scene_file.h"

namespace kino::scene_fields {

/// Every key of a scene file, once: readers, writers and the schema visit the same lines. A
/// visitor has, for a key and what it means,
///   number, integer, vector, span (least, most), color, flag, text (longest), choice (words),
///   number_or, integer_or (least, most, or a word; `by` is the first of its values for numbers),
///   one_of (whole numbers),
///   and for what holds more: object, optional, list (most), texts (most, longest), colors (most),
///   choices (words, most).

template <class Value>
using Word = std::pair<std::string_view, Value>;

inline constexpr std::array<Word<LobeKind>, 4> kLobeKinds{{{"lambert", LobeKind::lambert},
                                                           {"oren_nayar", LobeKind::oren_nayar},
                                                           {"ggx", LobeKind::ggx},
                                                           {"rim", LobeKind::rim}}};
inline constexpr std::array<Word<MaterialKind>, 3> kMaterialKinds{
    {{"layered", MaterialKind::layered},
     {"toon", MaterialKind::toon},
     {"unlit", MaterialKind::unlit}}};
inline constexpr std::array<Word<SceneShape>, 8> kShapes{{{"box", SceneShape::box},
                                                          {"sphere", SceneShape::sphere},
                                                          {"cylinder", SceneShape::cylinder},
                                                          {"plane", SceneShape::plane},
                                                          {"room", SceneShape::room},
                                                          {"column", SceneShape::column},
                                                          {"chair", SceneShape::chair},
                                                          {"gltf", SceneShape::gltf}}};
inline constexpr std::array<Word<LightKind>, 3> kLightKinds{
    {{"directional", LightKind::directional},
     {"point", LightKind::point},
     {"spot", LightKind::spot}}};
inline constexpr std::array<Word<SceneMovement>, 4> kMovements{{{"still", SceneMovement::still},
                                                                {"drift", SceneMovement::drift},
                                                                {"orbit", SceneMovement::orbit},
                                                                {"rise", SceneMovement::rise}}};
inline constexpr std::array<Word<SceneWhen>, 3> kWhens{
    {{"always", SceneWhen::always}, {"idle", SceneWhen::idle}, {"people", SceneWhen::people}}};
inline constexpr std::array<Word<SceneAim>, 3> kAims{
    {{"fixed", SceneAim::fixed}, {"limb", SceneAim::limb}, {"mirror", SceneAim::mirror}}};
inline constexpr std::array<Word<SceneShow>, 3> kShows{
    {{"all", SceneShow::all}, {"people", SceneShow::people}, {"none", SceneShow::none}}};
inline constexpr std::array<Word<DepthStyle>, 2> kStyles{
    {{"cloud", DepthStyle::cloud}, {"mesh", DepthStyle::mesh}}};
inline constexpr std::array<Word<SceneOrigin>, 2> kOrigins{
    {{"person", SceneOrigin::person}, {"world", SceneOrigin::world}}};
inline constexpr std::array<Word<SceneDeflect>, 4> kDeflects{
    {{"none", SceneDeflect::none},
     {"pan", SceneDeflect::pan},
     {"homography", SceneDeflect::homography},
     {"depth_warp", SceneDeflect::depth_warp}}};
inline constexpr std::array<Word<ColorMode>, 3> kColors{
    {{"captured", ColorMode::captured}, {"mixed", ColorMode::mixed}, {"relit", ColorMode::relit}}};

inline constexpr std::array<Word<SceneLodBy>, 1> kLodBy{{{"auto", SceneLodBy::budget}}};
inline constexpr std::array<Word<SceneZoomBy>, 3> kZoomBy{{{"reactive", SceneZoomBy::reactive},
                                                           {"predictive", SceneZoomBy::predictive},
                                                           {"head", SceneZoomBy::head}}};
inline constexpr std::array<int, 2> kSamples{1, 4};

inline std::array<Word<Joint>, kJointCount> joint_words() {
    std::array<Word<Joint>, kJointCount> words{};
    for (std::size_t i = 0; i < kJointCount; ++i) {
        words[i] = {joint_name(static_cast<Joint>(i)), static_cast<Joint>(i)};
    }
    return words;
}

constexpr int kLongestName = 64;
constexpr int kMostColors = 64;
constexpr double kFarthest = 100;  ///< m

template <class V>
void visit(V& v, SceneLobe& s) {
    v.choice("kind", s.kind, kLobeKinds, "way of scattering");
    v.color("color", s.color, "reflectance; for lambert and oren_nayar times the material's");
    v.number("weight", s.weight, 0, 100, "how much of it");
    v.number("roughness", s.roughness, 0.01, 2, "oren_nayar: slopes, rad; ggx; rim");
}

template <class V>
void visit(V& v, SceneLayer& s) {
    v.list("lobes", s.lobes, kMaxLobes, "what it scatters");
    v.color("transmission", s.transmission, "what it lets through of the layers below");
}

template <class V>
void visit(V& v, SceneMaterial& s) {
    v.text("name", s.name, kLongestName, "what meshes and lights call it");
    v.color("color", s.color, "base colour");
    v.number("glow", s.glow, 0, 100, "light of its own, in parts of its colour");
    v.number("opacity", s.opacity, 0, 1, "below 1 it is blended");
    v.choice("kind", s.kind, kMaterialKinds,
             "layered: by its layers; toon: light in steps, dark outlines; unlit: its colour");
    v.integer("steps", s.steps, 1, 16, "toon: from dark to white");
    v.list("layers", s.layers, kMaxLayers, "top first; none: matt");
}

template <class V>
void visit(V& v, SceneRepeat& s) {
    v.integer("count", s.count, 1, 512, "copies");
    v.vector("step_m", s.step_m, -kFarthest, kFarthest, "from one to the next");
}

template <class V>
void visit(V& v, SceneScatter& s) {
    v.integer("seed", s.seed, 0, 1 << 30, "of chance");
    v.vector("by_m", s.by_m, 0, kFarthest, "at most this far to either side");
    v.number("turn_deg", s.turn_deg, 0, 180, "about y, to either side");
}

template <class V>
void visit(V& v, SceneMesh& s) {
    v.choice("shape", s.shape, kShapes, "what it is; gltf needs a file");
    v.text("file", s.file, 256, "glTF, a path within the folder of the scene file");
    v.text("material", s.material, kLongestName, "none: the first, or the glTF file's own");
    v.vector("size_m", s.size_m, 0.001, kFarthest, "x, y, z");
    v.vector("at_m", s.at_m, -kFarthest, kFarthest, "where");
    v.vector("turn_deg", s.turn_deg, -360, 360, "about x, y and z");
    v.vector("scale", s.scale, 0.001, 1000, "along its own axes");
    v.list("repeat", s.repeat, 3, "rows, and rows of rows");
    v.optional("scatter", s.scatter, "copies that stand a little off");
}

template <class V>
void visit(V& v, SceneLight& s) {
    v.choice("kind", s.kind, kLightKinds, "");
    v.vector("at_m", s.at_m, -kFarthest, kFarthest, "where; of a role: off the joint");
    v.vector("direction", s.direction, -1000, 1000, "the way it shines; not points");
    v.color("color", s.color, "");
    v.number("intensity", s.intensity, 0, 10000, "irradiance at 1 m");
    v.number("radius_m", s.radius_m, 0.01, 1000, "where it ends; not directional");
    v.span("cone_deg", s.cone_deg, 0, 89, "spot: half angles of full light and of none");
    v.flag("shadow", s.shadow, "hard shadows, by rays");
    v.flag("indirect", s.indirect, "one bounce of it; spot");
    v.texts("only", s.only, kMaxMaterials, kLongestName,
            "materials it lights, \"live\" for people; none: all");
}

template <class V>
void visit(V& v, SceneSwarm& s) {
    v.integer("count", s.count, 1, kMaxStageLights, "lights");
    v.integer("seed", s.seed, 0, 1 << 30, "of chance");
    v.integer("fill_to", s.fill_to, 0, kMaxStageLights,
              "only as many as bring the scene's lights to this number; 0: all");
    v.choice("when", s.when, kWhens, "idle: while nobody is tracked");
    v.vector("center_m", s.center_m, -kFarthest, kFarthest, "of the box they live in");
    v.vector("size_m", s.size_m, 0, kFarthest, "of the box");
    v.choice("movement", s.movement, kMovements, "orbit: about the centre; rise: up, and again");
    v.number("speed_m_s", s.speed_m_s, 0, 20, "about how fast");
    v.colors("palette", s.palette, kMostColors, "in turn; none: white");
    v.span("intensity", s.intensity, 0, 10000, "from, to");
    v.span("radius_m", s.radius_m, 0.01, 1000, "from, to");
    v.number("bead_m", s.bead_m, 0, 1, "diameter of a glowing ball at each; 0: none");
    v.flag("shadow", s.shadow, "hard shadows, by rays");
}

template <class V>
void visit(V& v, SceneTrail& s) {
    v.integer("lights", s.lights, 1, 256, "at most");
    v.number("spacing_m", s.spacing_m, 0.005, 1, "from one to the next");
    v.number("life_s", s.life_s, 0.05, 600, "until one has faded");
    v.colors("palette", s.palette, 8, "along the way; none: white");
    v.number("palette_m", s.palette_m, 0.05, 1000, "way on which it goes round once");
    v.vector("off_m", s.off_m, -1, 1, "off the joint");
    v.number("intensity", s.intensity, 0, 10000, "of a fresh one");
    v.number("radius_m", s.radius_m, 0.01, 1000, "");
    v.number("stroke_m", s.stroke_m, 0, 0.5, "width of the glowing stroke; 0: none");
}

template <class V>
void visit(V& v, SceneProp& s) {
    v.choice("shape", s.shape, kShapes, "");
    v.text("file", s.file, 256, "glTF, as of a mesh");
    v.texts("materials", s.materials, kMaxMaterials, kLongestName, "in turn; none: the first");
    v.vector("size_m", s.size_m, 0.001, 10, "");
    v.vector("off_m", s.off_m, -10, 10, "off the joint");
    v.integer("copies", s.copies, 1, 64, "evenly on the circle");
    v.number("orbit_m", s.orbit_m, 0, 10, "radius of the circle");
    v.number("period_s", s.period_s, 0.1, 3600, "of one round");
}

template <class V>
void visit(V& v, SceneRole& s) {
    v.choices("joints", s.joints, joint_words(), kJointCount, "that lead; none: all");
    v.integer("people", s.people, 1, 6, "that have this role, at most");
    v.choice("aim", s.aim, kAims,
             "of a spot: its direction, along the limb, or that turned into the picture");
    v.number("fade_s", s.fade_s, 0, 60, "things of a lost joint go in this time");
    v.colors("palette", s.palette, kMostColors, "of lights, by person and joint");
    v.optional("light", s.light, "at each of the joints");
    v.optional("trail", s.trail, "that each of the joints leaves");
    v.optional("prop", s.prop, "objects at each of the joints");
}

template <class V>
void visit(V& v, SceneLive& s) {
    v.choice("show", s.show, kShows, "people: cut out of their room while there are any");
    v.choice("style", s.style, kStyles, "");
    v.integer("splat_px", s.splat_px, 1, 32, "largest point of a cloud");
    v.number("margin_m", s.margin_m, 0.02, 1, "that flesh stands off the bones");
    v.flag("casts_shadows", s.casts_shadows, "from lights with shadows");
    v.flag("smooth_outline", s.smooth_outline, "of people who are cut out");
}

template <class V>
void visit(V& v, SceneWindow& s) {
    v.number("width_m", s.size_m.x, 0.05, 20, "of the screen");
    v.number("height_m", s.size_m.y, 0.05, 20, "");
    v.vector("at_m", s.at_m, -kFarthest, kFarthest, "its centre, on the stage");
    v.number("turn_deg", s.turn_deg, -360, 360, "about y; 0: z towards the viewer");
    v.vector("sensor_m", s.sensor_m, -10, 10, "the sensor, from the screen's centre");
    v.number("sensor_tilt_deg", s.sensor_tilt_deg, -60, 60, "of the sensor, upwards");
    v.vector("eye_m", s.eye_m, -10, 10, "where the view is from while nobody is seen");
    v.choice("deflect", s.deflect, kDeflects, "how pictures follow the newest head");
    v.integer("most_zoom", s.most_zoom, 1, 8, "coarser pictures while the head is quick; 1: never");
}

template <class V>
void visit(V& v, SceneCamera& s) {
    v.vector("eye_m", s.eye_m, -kFarthest, kFarthest, "");
    v.vector("target_m", s.target_m, -kFarthest, kFarthest, "");
    v.optional("window", s.window, "the screen is a window that the nearest person looks through");
}

template <class V>
void visit(V& v, SceneEffects& s) {
    v.flag("skeleton", s.skeleton, "bones and joints over the picture");
}

template <class V>
void visit(V& v, SceneQuality& s) {
    v.number_or("lod", s.lod, s.lod_by, kLodBy, 1, 8,
                "light so many times coarser, or auto: light and picture as target_ms asks for");
    v.integer_or("zoom", s.zoom, s.zoom_by, kZoomBy, 1, 8,
                 "whole pictures so many times coarser, or who chooses that");
    v.integer("most_zoom", s.most_zoom, 1, 8, "of who chooses");
    v.number("target_ms", s.target_ms, 1, 1000, "time of a picture that who chooses is to hold");
    v.one_of("samples", s.samples, kSamples, "a pixel of meshes");
    v.number("fix", s.fix, 0, 0.5, "share of pixels shaded anew where light is coarse");
}

template <class V>
void visit(V& v, SceneFile& s) {
    v.required_integer("kinoscope_scene", s.version, 1, 1, "version of the format");
    v.text("name", s.name, kLongestName, "");
    v.text("about", s.about, 1000, "a sentence");
    v.choice("origin", s.origin, kOrigins, "where the stage stands: under the person, or fixed");
    v.choice("color", s.color, kColors, "what the camera's colours are taken for");
    v.color("ambient", s.ambient, "light from everywhere");
    v.number("exposure", s.exposure, 0.001, 1000, "");
    v.color("background_top", s.background_top, "");
    v.color("background_bottom", s.background_bottom, "");
    v.object("live", s.live, "the person, as the sensor sees it");
    v.object("camera", s.camera, "where the view begins");
    v.object("effects", s.effects, "");
    v.object("quality", s.quality, "how accurately it is drawn; a command line goes before it");
    v.list("materials", s.materials, kMaxMaterials - 1, "");
    v.list("meshes", s.meshes, 512, "what stands there");
    v.list("lights", s.lights, 1024, "that stay where they are");
    v.list("swarms", s.swarms, 16, "many lights by chance");
    v.list("roles", s.roles, 32, "what people lead");
}

}  // namespace kino::scene_fields
