// One ray of a shadow; the includer has what viz/accel/bvh.glsl wants, and KINO_LIVE_BINDING: where
// the tree of the live depth frame is bound.
#include "viz/accel/bvh.glsl"
layout(set = 0, binding = KINO_LIVE_BINDING) uniform usamplerBuffer live_nodes;
layout(set = 0, binding = KINO_LIVE_BINDING + 1) uniform usamplerBuffer live_triangles;
layout(constant_id = 3) const uint kTrees = 1u;  // bit 0: meshes, bit 1: live frame

vec3 to_tree(vec3 v, float w) {
    precise float x = p.tree_from_view_x.x * v.x + p.tree_from_view_x.y * v.y +
                      p.tree_from_view_x.z * v.z + p.tree_from_view_x.w * w;
    precise float y = p.tree_from_view_y.x * v.x + p.tree_from_view_y.y * v.y +
                      p.tree_from_view_y.z * v.z + p.tree_from_view_y.w * w;
    precise float z = p.tree_from_view_z.x * v.x + p.tree_from_view_z.y * v.y +
                      p.tree_from_view_z.z * v.z + p.tree_from_view_z.w * w;
    return vec3(x, y, z);
}

// The ray leaves the surface by a share of the largest number that its place was made of, and ends
// as much before the light; where nothing is left between, the light is not hidden.
bool hidden(Place place, vec3 way, bool directional, bool traced) {
    vec3 at = to_tree(place.at, 1.0);
    vec3 n = to_tree(place.normal, 0.0);
    vec3 d = to_tree(way, 0.0);
    vec3 size = abs(at);
    precise float step = p.offset * max(max(size.x, size.y), max(size.z, place.at.z));
    precise vec3 origin = at + n * step;
    precise vec3 short_way = d - n * step;
    vec3 direction = directional ? d : short_way;
    precise float range = sqrt(dot(direction, direction));
    precise float left = 1.0 - step / range;
    float t_max = directional ? uintBitsToFloat(0x7F800000u) : left;
    // What wants no ray is over before it begins.
    bool wanted = traced && (directional || range > step);
    bool met = false;
    if ((kTrees & 1u) != 0u) {
        RayTest r = prepare_ray(origin, 0.0, direction, t_max);
        r.valid = r.valid && wanted;
        met = bvh_any(r, t_max);
    }
    if ((kTrees & 2u) != 0u) {
        // The live frame is in its tree more coarsely than it is drawn: its own surface does not
        // count where the ray begins.
        precise float begin = p.live_bias_m / range;
        RayTest r = prepare_ray(origin, begin, direction, t_max);
        r.valid = r.valid && wanted && !met;
        met = bvh_any_of(live_nodes, live_triangles, r, t_max) || met;
    }
    return met;
}
