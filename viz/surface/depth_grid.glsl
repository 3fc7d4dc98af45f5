// The depth image as points and triangles, shared by all passes that read it.
#ifndef KINO_DEPTH_GRID_GLSL
#define KINO_DEPTH_GRID_GLSL

// Cameras without distortion need no table of rays, and a load is what a lane pays most for.
layout(constant_id = 9) const uint kPinhole = 0u;

#define KINO_RAY(at, index) \
    (kPinhole != 0u ? (vec2(at) - p.depth_k.zw) * p.depth_k.xy : ray_at(index))

vec3 depth_point(float z, vec2 ray) { return vec3(ray * z, z); }

vec3 to_view(SurfaceParams p, vec3 depth_space) {
    vec4 h = vec4(depth_space, 1.0);
    return vec3(dot(p.view_from_depth_x, h), dot(p.view_from_depth_y, h),
                dot(p.view_from_depth_z, h));
}

// Largest depth difference between neighbours of one surface, metres: three quantisation steps
// (0.00307 z^2 each) plus a surface seen at 80 degrees.
float edge_limit(SurfaceParams p, float z) {
    return p.fixed_edge_m > 0.0 ? p.fixed_edge_m
                                : 3.0 * 0.00307 * z * z + 5.6712818 * z / p.depth_focal_px;
}

bool keep_triangle(SurfaceParams p, float a, float b, float c) {
    float nearest = min(a, min(b, c));
    float farthest = max(a, max(b, c));
    return nearest > 0.1 && farthest - nearest < edge_limit(p, nearest);
}

// Triangle t of cell c: t = 0 is (00, 10, 01), t = 1 is (10, 11, 01). Corner indices into the grid.
uvec3 triangle_corners(SurfaceParams p, uint triangle) {
    uint cells_x = p.grid.x - 1u;
    uint cell = triangle >> 1u;
    uint base = (cell / cells_x) * p.grid.x + cell % cells_x;
    return (triangle & 1u) == 0u ? uvec3(base, base + 1u, base + p.grid.x)
                                 : uvec3(base + 1u, base + p.grid.x + 1u, base + p.grid.x);
}
#endif
