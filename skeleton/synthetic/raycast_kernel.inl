// The inner loops, written once on a few lanes. Included into an unnamed namespace by the portable
// and the AVX2 file; contraction is off in both and every operation is exactly rounded, so both
// give the same bits.

#if defined(__AVX2__)
constexpr int kLanes = 8;
#else
constexpr int kLanes = 4;  // what every x86-64 and ARMv8 has; wider values would fall to scalars
#endif
typedef float Floats __attribute__((vector_size(4 * kLanes)));
typedef std::int32_t Ints __attribute__((vector_size(4 * kLanes)));
typedef std::uint32_t Words __attribute__((vector_size(4 * kLanes)));
typedef std::uint16_t Halves __attribute__((vector_size(2 * kLanes)));
typedef float LooseFloats __attribute__((vector_size(4 * kLanes), aligned(4), may_alias));
typedef std::int32_t LooseInts __attribute__((vector_size(4 * kLanes), aligned(4), may_alias));
typedef std::uint32_t LooseWords __attribute__((vector_size(4 * kLanes), aligned(4), may_alias));
typedef std::uint16_t LooseHalves __attribute__((vector_size(2 * kLanes), aligned(2), may_alias));

#define KINO_LANES static inline __attribute__((always_inline))

KINO_LANES Floats load(const float* p) {
    return *reinterpret_cast<const LooseFloats*>(p);
}
KINO_LANES Ints load(const std::int32_t* p) {
    return *reinterpret_cast<const LooseInts*>(p);
}
KINO_LANES Words load(const std::uint32_t* p) {
    return *reinterpret_cast<const LooseWords*>(p);
}
KINO_LANES void store(float* p, Floats v) {
    *reinterpret_cast<LooseFloats*>(p) = v;
}
KINO_LANES void store(std::int32_t* p, Ints v) {
    *reinterpret_cast<LooseInts*>(p) = v;
}
KINO_LANES void store(std::uint32_t* p, Words v) {
    *reinterpret_cast<LooseWords*>(p) = v;
}
KINO_LANES Floats all(float v) {
    return Floats{} + v;
}
KINO_LANES Ints all(std::int32_t v) {
    return Ints{} + v;
}
KINO_LANES Words all(std::uint32_t v) {
    return Words{} + v;
}
KINO_LANES Floats vmin(Floats a, Floats b) {
    return a < b ? a : b;
}
KINO_LANES Floats vmax(Floats a, Floats b) {
    return a > b ? a : b;
}
KINO_LANES Floats vabs(Floats a) {
    return (Floats)((Ints)a & all(0x7FFFFFFF));
}
KINO_LANES Floats clamp01(Floats a) {
    return vmin(vmax(a, all(0.0f)), all(1.0f));
}

#if defined(__AVX2__)
KINO_LANES Floats vsqrt(Floats a) {
    return (Floats)_mm256_sqrt_ps((__m256)a);
}
KINO_LANES bool any(Ints mask) {
    return _mm256_movemask_ps((__m256)mask) != 0;
}
KINO_LANES Floats gather(const float* table, Ints index) {
    return (Floats)_mm256_i32gather_ps(table, (__m256i)index, 4);
}
#elif defined(__SSE2__)
KINO_LANES Floats vsqrt(Floats a) {
    return (Floats)_mm_sqrt_ps((__m128)a);
}
KINO_LANES bool any(Ints mask) {
    return _mm_movemask_ps((__m128)mask) != 0;
}
KINO_LANES Floats gather(const float* table, Ints index) {
    return Floats{table[index[0]], table[index[1]], table[index[2]], table[index[3]]};
}
#else
KINO_LANES Floats vsqrt(Floats a) {
    for (int i = 0; i < kLanes; ++i) a[i] = std::sqrt(a[i]);
    return a;
}
KINO_LANES bool any(Ints mask) {
    int bits = 0;
    for (int i = 0; i < kLanes; ++i) bits |= mask[i];
    return bits != 0;
}
KINO_LANES Floats gather(const float* table, Ints index) {
    Floats v = {};
    for (int i = 0; i < kLanes; ++i) v[i] = table[index[i]];
    return v;
}
#endif

constexpr float kFar = 1e30f;
constexpr float kNear = 1e-3f;

struct Ray {
    Floats qx, qy, qz;  // local place at depth t0
    Floats dx, dy, dz;  // local step per metre of depth
};

KINO_LANES Ray local_ray(const Solid& s, Floats x, Floats y) {
    const Floats px = all(s.wx) + all(s.t0) * x, py = all(s.wy) + all(s.t0) * y, pz = all(s.wz);
    const float* m = s.m;
    return {m[0] * px + m[1] * py + m[2] * pz, m[3] * px + m[4] * py + m[5] * pz,
            m[6] * px + m[7] * py + m[8] * pz, m[0] * x + m[1] * y + m[2],
            m[3] * x + m[4] * y + m[5],        m[6] * x + m[7] * y + m[8]};
}

// Depth beyond t0 at which the ray enters the ball (kFar if never). a = |d|^2.
KINO_LANES Floats enter_ball(Floats a, Floats b, Floats c) {
    const Floats disc = b * b - a * c;
    const Floats t = (-b - vsqrt(vmax(disc, all(0.0f)))) / a;
    return disc >= 0.0f ? t : all(kFar);
}

KINO_LANES Floats enter_ball(const Solid& s, const Ray& r) {
    return enter_ball(r.dx * r.dx + r.dy * r.dy + r.dz * r.dz,
                      r.qx * r.dx + r.qy * r.dy + r.qz * r.dz,
                      r.qx * r.qx + r.qy * r.qy + r.qz * r.qz - s.radius_a * s.radius_a);
}

// The hull is entered where the first of its parts is: both balls lie within it, and its side is
// the part of the cone cos^2 (x^2 + z^2) = (radius_a - slope y)^2 between the touching circles.
KINO_LANES Floats enter_cone(const Solid& s, const Ray& r) {
    const Floats dd = r.dx * r.dx + r.dz * r.dz, qd = r.qx * r.dx + r.qz * r.dz;
    const Floats qq = r.qx * r.qx + r.qz * r.qz, k = s.radius_a - s.slope * r.qy;
    const Floats a = s.cos2 * dd - (s.slope * s.slope) * r.dy * r.dy;
    const Floats b = s.cos2 * qd + s.slope * r.dy * k;
    const Floats c = s.cos2 * qq - k * k;
    const Floats disc = b * b - a * c;
    // Who misses the cone misses the balls that touch it from within.
    if (!any(disc >= 0.0f)) return all(kFar);
    const Floats root = vsqrt(vmax(disc, all(0.0f)));
    const Ints toward = b < 0.0f;
    const Floats t = (toward ? c : -b - root) / (toward ? root - b : a);
    const Floats y = r.qy + t * r.dy;
    const Ints on_side = (disc >= 0.0f) & (y >= s.side_lo) & (y <= s.side_hi);
    const Floats side = on_side ? t : all(kFar);
    const Floats length2 = dd + r.dy * r.dy;
    const Floats ball_a =
        enter_ball(length2, qd + r.qy * r.dy, qq + r.qy * r.qy - s.radius_a * s.radius_a);
    const Floats yb = r.qy - s.height;
    const Floats ball_b =
        enter_ball(length2, qd + yb * r.dy, qq + yb * yb - s.radius_b * s.radius_b);
    return vmin(side, vmin(ball_a, ball_b));
}

KINO_LANES Floats enter_box(const Solid& s, const Ray& r) {
    Floats enter = all(-kFar), leave = all(kFar);
    const Floats q[3] = {r.qx, r.qy, r.qz}, d[3] = {r.dx, r.dy, r.dz};
    for (int axis = 0; axis < 3; ++axis) {
        const Floats a = (-s.half[axis] - q[axis]) / d[axis],
                     b = (s.half[axis] - q[axis]) / d[axis];
        enter = vmax(vmin(a, b), enter);
        leave = vmin(vmax(a, b), leave);
    }
    return enter <= leave ? enter : all(kFar);
}

template <Solid::Kind kind>
KINO_LANES Floats enter(const Solid& s, Floats x, Floats y) {
    const Ray r = local_ray(s, x, y);
    if constexpr (kind == Solid::ball) return s.t0 + enter_ball(s, r);
    if constexpr (kind == Solid::cone) return s.t0 + enter_cone(s, r);
    return s.t0 + enter_box(s, r);
}

template <Solid::Kind kind>
void nearest_of(const Solid& s, const Rect& rect, const Target& target) {
    for (int row = rect.y0; row < rect.y1; ++row) {
        const std::ptrdiff_t start = std::ptrdiff_t{row} * target.pitch;
        for (std::ptrdiff_t i = start + (rect.x0 & ~7); i < start + rect.x1; i += kLanes) {
            const Floats t = enter<kind>(s, load(target.ray_x + i), load(target.ray_y + i));
            const Floats z = load(target.z + i);
            const Ints wins = (t < z) & (t > kNear);
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
        for (std::ptrdiff_t i = start + (rect.x0 & ~7); i < start + rect.x1; i += kLanes) {
            const Ints lit = load(target.lit + i);
            const Ints asked = lit & (load(target.id + i) >= first_id);
            if (!any(asked)) continue;
            const Floats z = load(target.z + i);
            const Floats x = load(target.ray_x + i) - emitter_x / z;
            const Floats t = enter<kind>(s, x, load(target.ray_y + i));
            const Ints hidden = asked & (t < z - margin) & (t > kNear);
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
KINO_LANES Floats wavelet(Floats x) {
    const Floats shifted = x + 1024.0f;
    const Floats part =
        shifted - __builtin_convertvector(__builtin_convertvector(shifted, Ints), Floats);
    const Floats p = part * 2.0f - 1.0f;
    return 4.0f * p * (1.0f - vabs(p));
}

struct Vector {
    Floats x, y, z;
};
KINO_LANES Floats dot(const Vector& v, const float* w) {
    return v.x * w[0] + v.y * w[1] + v.z * w[2];
}

KINO_LANES Vector normalized(const Vector& v) {
    const Floats length = vsqrt(v.x * v.x + v.y * v.y + v.z * v.z + 1e-20f);
    return {v.x / length, v.y / length, v.z / length};
}

KINO_LANES Words to_byte(Floats linear) {
    // Square root for the sRGB curve: this camera's own tone curve, close to it and cheap.
    return (Words) __builtin_convertvector(vsqrt(clamp01(linear)) * 255.0f + 0.5f, Ints);
}

void shade(const Solid& s, const Paint& paint, const Lights& lights, const Rect& rect,
           const Target& target, std::uint32_t* rgba) {
    for (int row = rect.y0; row < rect.y1; ++row) {
        const std::ptrdiff_t start = std::ptrdiff_t{row} * target.pitch;
        for (std::ptrdiff_t i = start + (rect.x0 & ~7); i < start + rect.x1; i += kLanes) {
            const Ints shown = load(target.id + i) == s.id;
            if (!any(shown)) continue;
            const Floats x = load(target.ray_x + i), y = load(target.ray_y + i);
            const Ray r = local_ray(s, x, y);
            const Floats t = load(target.z + i) - s.t0;
            const Floats lx = r.qx + t * r.dx, ly = r.qy + t * r.dy, lz = r.qz + t * r.dz;
            // The ball of the hull that touches it here gives the normal.
            Floats center = all(0.0f);
            if (s.kind == Solid::cone) {
                center = vmin(vmax((ly - s.slope * s.radius_a) / s.cos2, all(0.0f)), all(s.height));
            }
            const Floats nx = lx, ny = ly - center, nz = lz;
            const float* m = s.m;
            Vector n =
                normalized({m[0] * nx + m[3] * ny + m[6] * nz, m[1] * nx + m[4] * ny + m[7] * nz,
                            m[2] * nx + m[5] * ny + m[8] * nz});
            const Vector view = normalized({-x, -y, all(-1.0f)});
            Floats grain = all(1.0f);
            if (paint.fold > 0) {
                const Floats u =
                    wavelet(lx * paint.fold_x + 0.6f * wavelet(ly * paint.fold_y * 0.37f));
                const Floats v = wavelet(ly * paint.fold_y + lx * paint.fold_x * 0.6f);
                n = normalized(
                    {n.x + paint.fold * u, n.y + paint.fold * v, n.z + paint.fold * 0.3f * u * v});
                grain = 1.0f + paint.fold * 0.35f * u * v;
            }
            const Floats facing = vmax(n.x * view.x + n.y * view.y + n.z * view.z, all(0.0f));
            const Floats key =
                vmax((dot(n, lights.key) + paint.wrap) / (1 + paint.wrap), all(0.0f));
            const Floats fill = vmax(dot(n, lights.fill), all(0.0f));
            const Floats sky = 0.5f + 0.5f * dot(n, lights.up);
            // Grazing views look into folds and gaps, which are darker; a thin rim of light on top.
            const Floats open = (0.62f + 0.38f * facing) * grain;
            const Floats away = 1.0f - facing, rim = away * away * away * away * 0.10f * sky;
            Words out = all(0xFF000000u);
            for (int c = 0; c < 3; ++c) {
                const Floats light = lights.ground_color[c] +
                                     (lights.sky_color[c] - lights.ground_color[c]) * sky +
                                     lights.fill_color[c] * fill + lights.key_color[c] * key;
                out |= to_byte(paint.albedo[c] * light * open + rim) << all(8u * unsigned(c));
            }
            const Words old = load(rgba + i);
            store(rgba + i, (Words)(shown ? (Ints)out : (Ints)old));
        }
    }
}

void darken(const FloorSpots& spots, const Rect& rect, const Target& target, const float* floor_x,
            const float* floor_z, std::int32_t first_id, std::uint32_t* rgba) {
    for (int row = rect.y0; row < rect.y1; ++row) {
        const std::ptrdiff_t start = std::ptrdiff_t{row} * target.pitch;
        for (std::ptrdiff_t i = start + (rect.x0 & ~7); i < start + rect.x1; i += kLanes) {
            const Floats x = load(floor_x + i), z = load(floor_z + i);
            const Ints floor = (x < 1e6f) & (load(target.id + i) < first_id);
            if (!any(floor)) continue;
            Floats keep = all(1.0f);
            for (int k = 0; k < spots.count; ++k) {
                const Floats dx = x - spots.x[k], dz = z - spots.z[k];
                const Floats in =
                    vmax(1.0f - (dx * dx + dz * dz) * spots.inverse_radius2[k], all(0.0f));
                keep *= 1.0f - spots.strength[k] * in * in;
            }
            const Words old = load(rgba + i);
            Words out = all(0xFF000000u);
            for (unsigned c = 0; c < 3; ++c) {
                const Floats value =
                    __builtin_convertvector((Ints)((old >> all(8 * c)) & all(255u)), Floats);
                out |= (Words) __builtin_convertvector(value * keep + 0.5f, Ints) << all(8 * c);
            }
            store(rgba + i, (Words)(floor ? (Ints)out : (Ints)old));
        }
    }
}

void disparity(const Quantiser& q, const float* z, int count, float* raw) {
    for (int i = 0; i < count; i += kLanes) {
        store(raw + i, vmax(q.offset - q.factor / load(z + i), all(-1e6f)));
    }
}

KINO_LANES Words mix_bits(Words h) {
    h ^= h >> all(16u);
    h *= all(0x7feb352du);
    h ^= h >> all(15u);
    h *= all(0x846ca68bu);
    return h ^ (h >> all(16u));
}

KINO_LANES Floats jump_at(const float* const* rows, int i, int distance) {
    const Floats here = load(rows[2] + i);
    const Floats across =
        vmax(vabs(here - load(rows[2] + i - distance)), vabs(here - load(rows[2] + i + distance)));
    return vmax(across, vmax(vabs(here - load(rows[2 - distance] + i)),
                             vabs(here - load(rows[2 + distance] + i))));
}

void measure(const Quantiser& q, const float* const* rows, const std::int32_t* lit,
             std::uint32_t first_pixel, int count, std::uint16_t* out) {
    Words lane = {};
    for (int i = 0; i < kLanes; ++i) lane[i] = static_cast<std::uint32_t>(i);
    for (int i = 0; i < count; i += kLanes) {
        Floats value = load(rows[2] + i);
        Ints good = load(lit + i);
        if (q.sigma > 0) {
            const Words bits =
                mix_bits(mix_bits(lane + all(first_pixel + unsigned(i))) + all(q.seed));
            value += q.sigma * gather(q.normal_quantiles, (Ints)(bits & all(4095u)));
            const Ints chance = (Ints)(bits >> all(12u));
            const Ints next = jump_at(rows, i, 1) > q.jump, second = jump_at(rows, i, 2) > q.jump;
            const Ints limit = next ? all(std::int32_t(q.drop_next))
                                    : (second ? all(std::int32_t(q.drop_second)) : all(0));
            good &= chance >= limit;
        }
        const Ints raw = __builtin_convertvector(vmax(value + 0.5f, all(0.0f)), Ints);
        good &= (raw >= q.raw_min) & (raw <= q.raw_max);
        const Ints reading = good ? raw : all(2047);
        *reinterpret_cast<LooseHalves*>(out + i) = __builtin_convertvector(reading, Halves);
    }
}

constexpr Kernels kKernels = {nearest, block, shade, darken, disparity, measure};
