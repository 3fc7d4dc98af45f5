// The inner loops, written once on eight lanes. Included into an unnamed namespace by the portable
// and the AVX2 file; contraction is off in both and every
// operation is exactly rounded, so both give the same bits.

typedef float F8 __attribute__((vector_size(32)));
typedef std::int32_t I8 __attribute__((vector_size(32)));
typedef std::uint32_t U8 __attribute__((vector_size(32)));
typedef std::uint16_t H8 __attribute__((vector_size(16)));
typedef float LooseF8 __attribute__((vector_size(32), aligned(4), may_alias));
typedef std::int32_t LooseI8 __attribute__((vector_size(32), aligned(4), may_alias));
typedef std::uint32_t LooseU8 __attribute__((vector_size(32), aligned(4), may_alias));
typedef std::uint16_t LooseH8 __attribute__((vector_size(16), aligned(2), may_alias));

#define KINO_LANES static inline __attribute__((always_inline))

KINO_LANES F8 load(const float* p) {
    return *reinterpret_cast<const LooseF8*>(p);
}
KINO_LANES I8 load(const std::int32_t* p) {
    return *reinterpret_cast<const LooseI8*>(p);
}
KINO_LANES U8 load(const std::uint32_t* p) {
    return *reinterpret_cast<const LooseU8*>(p);
}
KINO_LANES void store(float* p, F8 v) {
    *reinterpret_cast<LooseF8*>(p) = v;
}
KINO_LANES void store(std::int32_t* p, I8 v) {
    *reinterpret_cast<LooseI8*>(p) = v;
}
KINO_LANES void store(std::uint32_t* p, U8 v) {
    *reinterpret_cast<LooseU8*>(p) = v;
}
KINO_LANES F8 all(float v) {
    return F8{v, v, v, v, v, v, v, v};
}
KINO_LANES I8 all(std::int32_t v) {
    return I8{v, v, v, v, v, v, v, v};
}
KINO_LANES U8 all(std::uint32_t v) {
    return U8{v, v, v, v, v, v, v, v};
}
KINO_LANES F8 vmin(F8 a, F8 b) {
    return a < b ? a : b;
}
KINO_LANES F8 vmax(F8 a, F8 b) {
    return a > b ? a : b;
}
KINO_LANES F8 vabs(F8 a) {
    return (F8)((I8)a & all(0x7FFFFFFF));
}
KINO_LANES F8 clamp01(F8 a) {
    return vmin(vmax(a, all(0.0f)), all(1.0f));
}

#if defined(__AVX2__)
KINO_LANES F8 vsqrt(F8 a) {
    return (F8)_mm256_sqrt_ps((__m256)a);
}
KINO_LANES bool any(I8 mask) {
    return _mm256_movemask_ps((__m256)mask) != 0;
}
KINO_LANES F8 gather(const float* table, I8 index) {
    return (F8)_mm256_i32gather_ps(table, (__m256i)index, 4);
}
#else
KINO_LANES F8 vsqrt(F8 a) {
    for (int i = 0; i < 8; ++i) a[i] = std::sqrt(a[i]);
    return a;
}
KINO_LANES bool any(I8 mask) {
    int bits = 0;
    for (int i = 0; i < 8; ++i) bits |= mask[i];
    return bits != 0;
}
KINO_LANES F8 gather(const float* table, I8 index) {
    F8 v = {};
    for (int i = 0; i < 8; ++i) v[i] = table[index[i]];
    return v;
}
#endif

constexpr float kFar = 1e30f;
constexpr float kNear = 1e-3f;

struct Ray {
    F8 qx, qy, qz;  // local place at depth t0
    F8 dx, dy, dz;  // local step per metre of depth
};

KINO_LANES Ray local_ray(const Solid& s, F8 x, F8 y) {
    const F8 px = all(s.wx) + all(s.t0) * x, py = all(s.wy) + all(s.t0) * y, pz = all(s.wz);
    const float* m = s.m;
    return {m[0] * px + m[1] * py + m[2] * pz, m[3] * px + m[4] * py + m[5] * pz,
            m[6] * px + m[7] * py + m[8] * pz, m[0] * x + m[1] * y + m[2],
            m[3] * x + m[4] * y + m[5],        m[6] * x + m[7] * y + m[8]};
}

// Depth beyond t0 at which the ray enters the ball (kFar if never). a = |d|^2.
KINO_LANES F8 enter_ball(F8 a, F8 b, F8 c) {
    const F8 disc = b * b - a * c;
    const F8 t = (-b - vsqrt(vmax(disc, all(0.0f)))) / a;
    return disc >= 0.0f ? t : all(kFar);
}

KINO_LANES F8 enter_ball(const Solid& s, const Ray& r) {
    return enter_ball(r.dx * r.dx + r.dy * r.dy + r.dz * r.dz,
                      r.qx * r.dx + r.qy * r.dy + r.qz * r.dz,
                      r.qx * r.qx + r.qy * r.qy + r.qz * r.qz - s.radius_a * s.radius_a);
}

// The hull is entered where the first of its parts is: both balls lie within it, and its side is
// the part of the cone cos^2 (x^2 + z^2) = (radius_a - slope y)^2 between the touching circles.
KINO_LANES F8 enter_cone(const Solid& s, const Ray& r) {
    const F8 dd = r.dx * r.dx + r.dz * r.dz, qd = r.qx * r.dx + r.qz * r.dz;
    const F8 qq = r.qx * r.qx + r.qz * r.qz, k = s.radius_a - s.slope * r.qy;
    const F8 a = s.cos2 * dd - (s.slope * s.slope) * r.dy * r.dy;
    const F8 b = s.cos2 * qd + s.slope * r.dy * k;
    const F8 c = s.cos2 * qq - k * k;
    const F8 disc = b * b - a * c;
    // Who misses the cone misses the balls that touch it from within.
    if (!any(disc >= 0.0f)) return all(kFar);
    const F8 root = vsqrt(vmax(disc, all(0.0f)));
    const I8 toward = b < 0.0f;
    const F8 t = (toward ? c : -b - root) / (toward ? root - b : a);
    const F8 y = r.qy + t * r.dy;
    const I8 on_side = (disc >= 0.0f) & (y >= s.side_lo) & (y <= s.side_hi);
    const F8 side = on_side ? t : all(kFar);
    const F8 length2 = dd + r.dy * r.dy;
    const F8 ball_a =
        enter_ball(length2, qd + r.qy * r.dy, qq + r.qy * r.qy - s.radius_a * s.radius_a);
    const F8 yb = r.qy - s.height;
    const F8 ball_b = enter_ball(length2, qd + yb * r.dy, qq + yb * yb - s.radius_b * s.radius_b);
    return vmin(side, vmin(ball_a, ball_b));
}

KINO_LANES F8 enter_box(const Solid& s, const Ray& r) {
    F8 enter = all(-kFar), leave = all(kFar);
    const F8 q[3] = {r.qx, r.qy, r.qz}, d[3] = {r.dx, r.dy, r.dz};
    for (int axis = 0; axis < 3; ++axis) {
        const F8 a = (-s.half[axis] - q[axis]) / d[axis], b = (s.half[axis] - q[axis]) / d[axis];
        enter = vmax(vmin(a, b), enter);
        leave = vmin(vmax(a, b), leave);
    }
    return enter <= leave ? enter : all(kFar);
}

template <Solid::Kind kind>
KINO_LANES F8 enter(const Solid& s, F8 x, F8 y) {
    const Ray r = local_ray(s, x, y);
    if constexpr (kind == Solid::ball) return s.t0 + enter_ball(s, r);
    if constexpr (kind == Solid::cone) return s.t0 + enter_cone(s, r);
    return s.t0 + enter_box(s, r);
}

template <Solid::Kind kind>
void nearest_of(const Solid& s, const Rect& rect, const Target& target) {
    for (int row = rect.y0; row < rect.y1; ++row) {
        const std::ptrdiff_t start = std::ptrdiff_t{row} * target.pitch;
        for (std::ptrdiff_t i = start + (rect.x0 & ~7); i < start + rect.x1; i += 8) {
            const F8 t = enter<kind>(s, load(target.ray_x + i), load(target.ray_y + i));
            const F8 z = load(target.z + i);
            const I8 wins = (t < z) & (t > kNear);
            if (!any(wins)) continue;
            store(target.z + i, wins ? t : z);
            store(target.id + i, wins ? all(s.id) : load(target.id + i));
            if (target.lit) store(target.lit + i, load(target.lit + i) | wins);
        }
    }
}

template <Solid::Kind kind>
void block_of(const Solid& s, const Rect& rect, const Target& target, float emitter_x, float margin,
              std::int32_t first_id) {
    for (int row = rect.y0; row < rect.y1; ++row) {
        const std::ptrdiff_t start = std::ptrdiff_t{row} * target.pitch;
        for (std::ptrdiff_t i = start + (rect.x0 & ~7); i < start + rect.x1; i += 8) {
            const I8 lit = load(target.lit + i);
            const I8 asked = lit & (load(target.id + i) >= first_id);
            if (!any(asked)) continue;
            const F8 z = load(target.z + i);
            const F8 x = load(target.ray_x + i) - emitter_x / z;
            const F8 t = enter<kind>(s, x, load(target.ray_y + i));
            const I8 hidden = asked & (t < z - margin) & (t > kNear);
            store(target.lit + i, lit & ~hidden);
        }
    }
}

void nearest(const Solid& s, const Rect& rect, const Target& target) {
    if (s.kind == Solid::ball) nearest_of<Solid::ball>(s, rect, target);
    if (s.kind == Solid::cone) nearest_of<Solid::cone>(s, rect, target);
    if (s.kind == Solid::box) nearest_of<Solid::box>(s, rect, target);
}

void block(const Solid& s, const Rect& rect, const Target& target, float emitter_x, float margin,
           std::int32_t first_id) {
    if (s.kind == Solid::ball) block_of<Solid::ball>(s, rect, target, emitter_x, margin, first_id);
    if (s.kind == Solid::cone) block_of<Solid::cone>(s, rect, target, emitter_x, margin, first_id);
    if (s.kind == Solid::box) block_of<Solid::box>(s, rect, target, emitter_x, margin, first_id);
}

// A smooth wave of period 1 and height 1 without a sine: x(1-|x|) pieces.
KINO_LANES F8 wavelet(F8 x) {
    const F8 shifted = x + 1024.0f;
    const F8 part = shifted - __builtin_convertvector(__builtin_convertvector(shifted, I8), F8);
    const F8 p = part * 2.0f - 1.0f;
    return 4.0f * p * (1.0f - vabs(p));
}

struct Vector {
    F8 x, y, z;
};
KINO_LANES F8 dot(const Vector& v, const float* w) {
    return v.x * w[0] + v.y * w[1] + v.z * w[2];
}

KINO_LANES Vector normalized(const Vector& v) {
    const F8 length = vsqrt(v.x * v.x + v.y * v.y + v.z * v.z + 1e-20f);
    return {v.x / length, v.y / length, v.z / length};
}

KINO_LANES U8 to_byte(F8 linear) {
    // Square root for the sRGB curve: this camera's own tone curve, close to it and cheap.
    return (U8) __builtin_convertvector(vsqrt(clamp01(linear)) * 255.0f + 0.5f, I8);
}

void shade(const Solid& s, const Paint& paint, const Lights& lights, const Rect& rect,
           const Target& target, std::uint32_t* rgba) {
    for (int row = rect.y0; row < rect.y1; ++row) {
        const std::ptrdiff_t start = std::ptrdiff_t{row} * target.pitch;
        for (std::ptrdiff_t i = start + (rect.x0 & ~7); i < start + rect.x1; i += 8) {
            const I8 shown = load(target.id + i) == s.id;
            if (!any(shown)) continue;
            const F8 x = load(target.ray_x + i), y = load(target.ray_y + i);
            const Ray r = local_ray(s, x, y);
            const F8 t = load(target.z + i) - s.t0;
            const F8 lx = r.qx + t * r.dx, ly = r.qy + t * r.dy, lz = r.qz + t * r.dz;
            // The ball of the hull that touches it here gives the normal.
            F8 center = all(0.0f);
            if (s.kind == Solid::cone) {
                center = vmin(vmax((ly - s.slope * s.radius_a) / s.cos2, all(0.0f)), all(s.height));
            }
            const F8 nx = lx, ny = ly - center, nz = lz;
            const float* m = s.m;
            Vector n =
                normalized({m[0] * nx + m[3] * ny + m[6] * nz, m[1] * nx + m[4] * ny + m[7] * nz,
                            m[2] * nx + m[5] * ny + m[8] * nz});
            const Vector view = normalized({-x, -y, all(-1.0f)});
            F8 grain = all(1.0f);
            if (paint.fold > 0) {
                const F8 u = wavelet(lx * paint.fold_x + 0.6f * wavelet(ly * paint.fold_y * 0.37f));
                const F8 v = wavelet(ly * paint.fold_y + lx * paint.fold_x * 0.6f);
                n = normalized(
                    {n.x + paint.fold * u, n.y + paint.fold * v, n.z + paint.fold * 0.3f * u * v});
                grain = 1.0f + paint.fold * 0.35f * u * v;
            }
            const F8 facing = vmax(n.x * view.x + n.y * view.y + n.z * view.z, all(0.0f));
            const F8 key = vmax((dot(n, lights.key) + paint.wrap) / (1 + paint.wrap), all(0.0f));
            const F8 fill = vmax(dot(n, lights.fill), all(0.0f));
            const F8 sky = 0.5f + 0.5f * dot(n, lights.up);
            // Grazing views look into folds and gaps, which are darker; a thin rim of light on top.
            const F8 open = (0.62f + 0.38f * facing) * grain;
            const F8 away = 1.0f - facing, rim = away * away * away * away * 0.10f * sky;
            U8 out = all(0xFF000000u);
            for (int c = 0; c < 3; ++c) {
                const F8 light = lights.ground_color[c] +
                                 (lights.sky_color[c] - lights.ground_color[c]) * sky +
                                 lights.fill_color[c] * fill + lights.key_color[c] * key;
                out |= to_byte(paint.albedo[c] * light * open + rim) << all(8u * unsigned(c));
            }
            const U8 old = load(rgba + i);
            store(rgba + i, (U8)(shown ? (I8)out : (I8)old));
        }
    }
}

void darken(const FloorSpots& spots, const Rect& rect, const Target& target, const float* floor_x,
            const float* floor_z, std::int32_t first_id, std::uint32_t* rgba) {
    for (int row = rect.y0; row < rect.y1; ++row) {
        const std::ptrdiff_t start = std::ptrdiff_t{row} * target.pitch;
        for (std::ptrdiff_t i = start + (rect.x0 & ~7); i < start + rect.x1; i += 8) {
            const F8 x = load(floor_x + i), z = load(floor_z + i);
            const I8 floor = (x < 1e6f) & (load(target.id + i) < first_id);
            if (!any(floor)) continue;
            F8 keep = all(1.0f);
            for (int k = 0; k < spots.count; ++k) {
                const F8 dx = x - spots.x[k], dz = z - spots.z[k];
                const F8 in =
                    vmax(1.0f - (dx * dx + dz * dz) * spots.inverse_radius2[k], all(0.0f));
                keep *= 1.0f - spots.strength[k] * in * in;
            }
            const U8 old = load(rgba + i);
            U8 out = all(0xFF000000u);
            for (unsigned c = 0; c < 3; ++c) {
                const F8 value = __builtin_convertvector((I8)((old >> all(8 * c)) & all(255u)), F8);
                out |= (U8) __builtin_convertvector(value * keep + 0.5f, I8) << all(8 * c);
            }
            store(rgba + i, (U8)(floor ? (I8)out : (I8)old));
        }
    }
}

void disparity(const Quantiser& q, const float* z, int count, float* raw) {
    for (int i = 0; i < count; i += 8) {
        store(raw + i, vmax(q.offset - q.factor / load(z + i), all(-1e6f)));
    }
}

KINO_LANES U8 mix_bits(U8 h) {
    h ^= h >> all(16u);
    h *= all(0x7feb352du);
    h ^= h >> all(15u);
    h *= all(0x846ca68bu);
    return h ^ (h >> all(16u));
}

KINO_LANES F8 jump_at(const float* const* rows, int i, int distance) {
    const F8 here = load(rows[2] + i);
    const F8 across =
        vmax(vabs(here - load(rows[2] + i - distance)), vabs(here - load(rows[2] + i + distance)));
    return vmax(across, vmax(vabs(here - load(rows[2 - distance] + i)),
                             vabs(here - load(rows[2 + distance] + i))));
}

void measure(const Quantiser& q, const float* const* rows, const std::int32_t* lit,
             std::uint32_t first_pixel, int count, std::uint16_t* out) {
    const U8 lane = {0, 1, 2, 3, 4, 5, 6, 7};
    for (int i = 0; i < count; i += 8) {
        F8 value = load(rows[2] + i);
        I8 good = load(lit + i);
        if (q.sigma > 0) {
            const U8 bits = mix_bits(mix_bits(lane + all(first_pixel + unsigned(i))) + all(q.seed));
            value += q.sigma * gather(q.normal_quantiles, (I8)(bits & all(4095u)));
            const I8 chance = (I8)(bits >> all(12u));
            const I8 next = jump_at(rows, i, 1) > q.jump, second = jump_at(rows, i, 2) > q.jump;
            const I8 limit = next ? all(std::int32_t(q.drop_next))
                                  : (second ? all(std::int32_t(q.drop_second)) : all(0));
            good &= chance >= limit;
        }
        const I8 raw = __builtin_convertvector(vmax(value + 0.5f, all(0.0f)), I8);
        good &= (raw >= q.raw_min) & (raw <= q.raw_max);
        const I8 reading = good ? raw : all(2047);
        *reinterpret_cast<LooseH8*>(out + i) = __builtin_convertvector(reading, H8);
    }
}

constexpr Kernels kKernels = {nearest, block, shade, darken, disparity, measure};
