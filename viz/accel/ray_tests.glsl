// Tests of one ray with a box and with a triangle: the operations of viz/accel/ray_tests.h in the
// same order, so both find the same hits. Nothing may be contracted.
struct RayTest {
    vec3 origin;
    float t_min;
    vec3 inverse;     // of the direction; infinite where a component is 0
    vec3 shear;
    bvec3 negative;   // components with the sign
    uint kz;          // axis along which the ray mostly runs
    bool swapped;     // it runs against it
    bool valid;
};

// Components in the order that makes kz the last one.
vec3 renamed(RayTest r, vec3 v) {
    vec3 turned = r.kz == 0u ? v.yzx : (r.kz == 1u ? v.zxy : v.xyz);
    return r.swapped ? turned.yxz : turned;
}

RayTest prepare_ray(vec3 origin, float t_min, vec3 d, float t_max) {
    RayTest r;
    vec3 size = abs(d);
    r.origin = origin;
    r.t_min = t_min;
    r.kz = size.x > size.y ? (size.x > size.z ? 0u : 2u) : (size.y > size.z ? 1u : 2u);
    float along = r.kz == 0u ? d.x : (r.kz == 1u ? d.y : d.z);
    r.swapped = along < 0.0;
    vec3 turned = renamed(r, d);
    precise float inverse_z = 1.0 / along;
    precise vec2 sheared = turned.xy * inverse_z;
    r.shear = vec3(sheared, inverse_z);
    precise vec3 inverse = 1.0 / d;
    r.inverse = inverse;
    r.negative = notEqual(floatBitsToUint(d) >> 31u, uvec3(0u));
    float sum = d.x + d.y + d.z + origin.x + origin.y + origin.z;
    r.valid = abs(sum) < 3e38 && abs(along) > 0.0 && abs(inverse_z) < 3e38 && t_min <= t_max;
    return r;
}

// Comparisons that NaN fails: it comes from a ray within a slab's plane.
bool meets_box(RayTest r, vec3 lo, vec3 hi, float best) {
    const float kWider = 1.00000036;  // three units in the last place: the rounding, twice over
    precise vec3 near = (mix(lo, hi, r.negative) - r.origin) * r.inverse;
    precise vec3 far = ((mix(hi, lo, r.negative) - r.origin) * r.inverse) * kWider;
    float enter = near.x > r.t_min ? near.x : r.t_min;
    enter = near.y > enter ? near.y : enter;
    enter = near.z > enter ? near.z : enter;
    precise float farthest = best * 1.000002;
    float leave = far.x < farthest ? far.x : farthest;
    leave = far.y < leave ? far.y : leave;
    leave = far.z < leave ? far.z : leave;
    return enter <= leave;
}

// What p * q lost in rounding (Dekker 1971).
float product_error(float p, float q, float product) {
    precise float ps = 4097.0 * p;
    precise float p_high = ps - (ps - p);
    precise float p_low = p - p_high;
    precise float qs = 4097.0 * q;
    precise float q_high = qs - (qs - q);
    precise float q_low = q - q_high;
    precise float error =
        (((p_high * q_high - product) + p_high * q_low) + p_low * q_high) + p_low * q_low;
    return error;
}

// p q - r s where the rounded products are equal.
float exact_difference(float p, float q, float r, float s) {
    precise float product = p * q;
    precise float difference = product_error(p, q, product) - product_error(r, s, product);
    return difference;
}

// Watertight test of Woop, Benthin and Wald (2013). True where the triangle is met within
// [t_min, best]; then t and the weights of corners b and c are set.
bool meets_triangle(RayTest r, vec3 pa, vec3 pb, vec3 pc, float best, out float t, out vec2 weights) {
    precise vec3 a = renamed(r, pa - r.origin);
    precise vec3 b = renamed(r, pb - r.origin);
    precise vec3 c = renamed(r, pc - r.origin);
    precise vec2 a2 = a.xy - r.shear.xy * a.z;
    precise vec2 b2 = b.xy - r.shear.xy * b.z;
    precise vec2 c2 = c.xy - r.shear.xy * c.z;
    precise float u = c2.x * b2.y - c2.y * b2.x;
    precise float v = a2.x * c2.y - a2.y * c2.x;
    precise float w = b2.x * a2.y - b2.y * a2.x;
    // A loop, because it is skipped where a branch would not be.
    for (uint k = u == 0.0 || v == 0.0 || w == 0.0 ? 1u : 0u; k > 0u; --k) {
        if (u == 0.0) u = exact_difference(c2.x, b2.y, c2.y, b2.x);
        if (v == 0.0) v = exact_difference(a2.x, c2.y, a2.y, c2.x);
        if (w == 0.0) w = exact_difference(b2.x, a2.y, b2.y, a2.x);
    }
    bool outside = (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0);
    precise float det = u + v + w;
    precise float scale = 1.0 / det;
    precise float az = r.shear.z * a.z;
    precise float bz = r.shear.z * b.z;
    precise float cz = r.shear.z * c.z;
    precise float at = (u * az + v * bz + w * cz) * scale;
    precise vec2 weight = vec2(v, w) * scale;
    t = at;
    weights = weight;
    return !outside && det != 0.0 && at >= r.t_min && at <= best;
}
