#ifndef KINO_VIZ_LIGHT_SHARED_H
#define KINO_VIZ_LIGHT_SHARED_H
#include "viz/gpu/shared.h"

KINO_SHARED_BEGIN

// A light as shaders see it: four texels of a Binding::word_quads, or a scalar struct. What a
// plain point light needs is in the first two.
struct LightRecord {
    vec3 place;        // view space: where a point or spot light is, direction to a directional one
    uint kind;         // 0 directional, 1 point, 2 spot, 3 patch: falls off with the cosine
    vec3 color;        // linear
    float radius;      // metres, point and spot lights
    vec3 axis;         // spot: the way it travels, view space
    float cone_cos;    // spot: cosine of the outer half angle
    float cone_scale;  // spot: 1 / (cosine of the inner half angle - cone_cos)
    uint material_mask;  // bit i: lights material i
    uint casts_shadow;   // 1: its bit in the shadow masks counts
    uint scene_index;    // which of Scene::lights it is
};

// What culling needs to know of a local light: a sphere in view space that holds all it can reach,
// a little larger than that, so that rounding loses nothing.
struct LightVolume {
    vec3 center;
    float radius;
};

// What the depths of a tile allow.
struct TileBounds {
    float min_z;  // nearest and farthest depth, metres; min_z > max_z: nothing there
    float max_z;
    uint cells;  // bit i: some depth is in cell i of [min_z, max_z]
    uint reserved;
};

// Written by culling; the last three by add_light_statistics() alone.
struct LightListCounters {
    uint overflowing_tiles;  // lists longer than the capacity
    uint dropped;            // lights that found no room in their tile's list
    uint pool_dropped;       // and those for which the pool had no room
    uint listed;             // sum of all lists
    uint longest;
    uint lit_tiles;      // lists that are not empty
    uint histogram[65];  // tiles by length: 0, 1-8, 9-16, ..., 505 and more
};

struct CullParams {
    vec4 k;         // fx, fy, cx, cy of the view
    uvec2 size;     // of the view, px
    uvec2 tiles;    // in the grid
    uint macros_x;  // macro tiles in a row
    uint macros;
    uint locals;  // local lights, and the index of the first of them
    uint first_local;
    uint words;  // of 32 lights each
    uint capacity;
    uint pool;  // indices there is room for
    float near_m;
};

// One map of what a light shines on, on its way into lights.
struct SpawnParams {
    vec4 camera_from_light_x;  // rows of the rigid transform
    vec4 camera_from_light_y;
    vec4 camera_from_light_z;
    vec4 k;  // fx, fy, cx, cy of the map
    vec3 color;
    float radius;
    float cone_cos;
    float cone_scale;
    uint first_record;
    uint first_volume;
    uint grid;  // lights along a side
    uint artist;
    float gain;
    float cutoff;
};

struct ListShadeParams {
    vec4 k;
    vec3 ambient;
    uint globals;
    uint locals;
    uint tiles_x;
    vec2 tile_scale;  // pixel of this view to pixel of the lists' view, divided by the tile size
    uint row_px;      // pixels in a row of this view
};

// One way of scattering light of a flattened material; what the layers above let through and the
// lobe's weight are in both colours.
struct LobeRecord {
    vec3 color;    // ggx: at normal incidence
    uint kind;     // as LobeKind
    vec3 grazing;  // ggx: what is added at grazing incidence
    float roughness;
};

struct MaterialRecord {
    vec3 diffuse;     // all Lambertian lobes together; times the base colour
    uint first_lobe;  // of a toon material, which has none: its steps
    vec3 emission;
    uint lobes;    // others than Lambertian
    vec3 ambient;  // all diffuse lobes together; times the base colour
    float opacity;
};

struct LightParams {
    vec4 k;  // fx, fy, cx, cy of the view
    vec3 ambient;
    uint count;
    uint mixed;  // 1: captured light stays and virtual light adds; 0: relit
};

// What the point shader reads beside the surface's own push constants.
struct PointLightParams {
    vec3 ambient;
    uint count;
    uint mixed;
    float exposure;
};

struct FinalParams {
    float exposure;
    uint tone_map;  // 0: clip, so captured colours stay what they are; 1: roll off the highlights
};

KINO_SHARED_END

#ifdef __cplusplus
static_assert(sizeof(kino::shared::LightRecord) == 64);
static_assert(sizeof(kino::shared::LightVolume) == 16);
static_assert(sizeof(kino::shared::TileBounds) == 16);
static_assert(sizeof(kino::shared::LobeRecord) == 32);
static_assert(sizeof(kino::shared::MaterialRecord) == 48);
static_assert(sizeof(kino::shared::CullParams) <= 128);
static_assert(sizeof(kino::shared::SpawnParams) <= 128);
#endif
#endif
