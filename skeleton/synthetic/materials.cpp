#include "skeleton/synthetic/materials.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <iterator>

namespace kino {
namespace {

using glm::dvec3;
using glm::vec3;

const dvec3 kKey = glm::normalize(dvec3(-0.50, 0.85, 0.62));
const dvec3 kFill = glm::normalize(dvec3(0.80, 0.30, 0.55));
constexpr vec3 kKeyColor{0.60f, 0.56f, 0.50f}, kFillColor{0.15f, 0.17f, 0.20f};
constexpr vec3 kSky{0.46f, 0.47f, 0.49f}, kGround{0.25f, 0.21f, 0.17f};
constexpr dvec3 kLamp{1.72, 1.52, -4.02};

constexpr vec3 hex(unsigned rgb) {
    // Squared: the inverse of this camera's tone curve.
    const float r = static_cast<float>((rgb >> 16) & 255) / 255;
    const float g = static_cast<float>((rgb >> 8) & 255) / 255;
    const float b = static_cast<float>(rgb & 255) / 255;
    return {r * r, g * g, b * b};
}

constexpr vec3 kAlbedo[kMaterialCount] = {
    hex(0xE0AC8C),  // skin
    hex(0xB4645A),  // lips
    hex(0x3A281C),  // hair
    hex(0xF4F0EC),  // eye white
    hex(0x2A2A30),  // iris
    hex(0x3E78A8),  // shirt
    hex(0xF2C14E),  // print
    hex(0x4A4E5E),  // trousers
    hex(0x2A211C),  // belt
    hex(0xD8D4CC),  // shoe
    hex(0x4A4440),  // sole
    hex(0x202226),  // watch
    hex(0xBE8C5A),  // wood
    hex(0x7E5638),  // dark wood
    hex(0xECEAE4),  // white paint
    hex(0x8C8E92),  // metal
    hex(0x1C1C1E),  // black
    hex(0xC23B34),  // red
    hex(0xE8873A),  // orange
    hex(0xEBC24A),  // yellow
    hex(0x5E9A54),  // green
    hex(0x4A8A48),  // leaf
    hex(0x3A5E9E),  // blue
    hex(0x3C8C8A),  // teal
    hex(0x7A4E88),  // purple
    hex(0xE6DCC4),  // cream
    hex(0xBE6E4C),  // clay
    hex(0xFFE9BE),  // lamp shade
    hex(0xFFFFFF),  // picture
    hex(0xC49A6C),  // floor
    hex(0xD6D2C4),  // wall
    hex(0xE8E6E0),  // ceiling
};

float hash01(int x, int y, int z) {
    auto h = static_cast<unsigned>(x) * 0x8da6b343u + static_cast<unsigned>(y) * 0xd8163841u +
             static_cast<unsigned>(z) * 0xcb1ab31fu;
    h ^= h >> 15;
    h *= 0x2c1b3c6du;
    h ^= h >> 12;
    h *= 0x297a2d39u;
    h ^= h >> 15;
    return static_cast<float>(h >> 8) / 16777216.0f;
}

// Value noise in the plane, 0..1, smooth.
float noise(double x, double y, int seed) {
    const double fx = std::floor(x), fy = std::floor(y);
    const int ix = static_cast<int>(fx), iy = static_cast<int>(fy);
    auto u = static_cast<float>(x - fx), v = static_cast<float>(y - fy);
    u = u * u * (3 - 2 * u);
    v = v * v * (3 - 2 * v);
    const float low = glm::mix(hash01(ix, iy, seed), hash01(ix + 1, iy, seed), u);
    const float high = glm::mix(hash01(ix, iy + 1, seed), hash01(ix + 1, iy + 1, seed), u);
    return glm::mix(low, high, v);
}

float smooth(double from, double to, double x) {
    const double t = std::clamp((x - from) / (to - from), 0.0, 1.0);
    return static_cast<float>(t * t * (3 - 2 * t));
}

// Furniture that hides the ceiling's light from what is below it: x, z, half sizes, height.
struct Cover {
    double x, z, half_x, half_z, height;
    float strength;
};
constexpr Cover kCovers[] = {
    {1.00, -2.10, 0.47, 0.33, 0.70, 0.50f},    {-1.28, -3.15, 0.22, 0.22, 0.42, 0.50f},
    {-1.28, -4.25, 0.50, 0.22, 0.25, 0.60f},   {0.98, -4.05, 0.13, 0.13, 0.12, 0.60f},
    {-0.95, -2.25, 0.055, 0.055, 0.06, 0.60f}, {1.72, -4.02, 0.14, 0.14, 0.03, 0.45f},
};

float covered(const dvec3& p) {
    float open = 1;
    for (const Cover& c : kCovers) {
        const double below = c.height - p.y;
        if (below <= 0) continue;
        const double blur = 0.05 + 0.38 * below;
        const float sx = smooth(c.half_x + blur, c.half_x - blur, std::abs(p.x - c.x));
        const float sz = smooth(c.half_z + blur, c.half_z - blur, std::abs(p.z - c.z));
        open *= 1 - c.strength * sx * sz;
    }
    return open;
}

vec3 lit(const vec3& base, const dvec3& n, const dvec3& p, float open) {
    const auto key = static_cast<float>(std::max(0.0, (glm::dot(n, kKey) + 0.2) / 1.2));
    const auto fill = static_cast<float>(std::max(0.0, glm::dot(n, kFill)));
    const auto sky = static_cast<float>(0.5 + 0.5 * n.y);
    vec3 light = glm::mix(kGround, kSky, sky) + kFillColor * fill + kKeyColor * key;
    light *= open;
    const dvec3 to_lamp = kLamp - p;
    const double d2 = glm::dot(to_lamp, to_lamp);
    const auto near = static_cast<float>(
        std::max(0.0, glm::dot(n, to_lamp) / std::sqrt(d2) * 0.7 + 0.3) / (1 + 9 * d2));
    return base * (light + vec3(0.95f, 0.70f, 0.38f) * near);
}

vec3 wood(const vec3& base, double along, double across, int seed) {
    const float grain = noise(along * 3, across * 90, seed) * 0.6f +
                        noise(along * 9, across * 240, seed + 1) * 0.4f;
    const float rings =
        noise(along * 1.3, across * 22 + 3 * noise(along * 1.2, across * 4, seed), seed + 2);
    return base * (0.80f + 0.22f * grain + 0.18f * rings);
}

vec3 floor_albedo(const dvec3& p) {
    constexpr double kPlank = 0.125, kLength = 1.15;
    const double column = std::floor(p.x / kPlank);
    const int c = static_cast<int>(column);
    const double along = p.z / kLength + hash01(c, 3, 1);
    const int r = static_cast<int>(std::floor(along));
    const float tone = 0.80f + 0.30f * hash01(c, r, 2);
    vec3 base = wood(albedo(Covering::floor) * tone, p.z + 7 * hash01(c, r, 5), p.x, 11);
    const double in_x = (p.x / kPlank - column) * kPlank;
    const double in_z = (along - r) * kLength;
    const double gap = std::min({in_x, kPlank - in_x, in_z, kLength - in_z});
    return base * (0.62f + 0.38f * smooth(0.0, 0.0045, gap));
}

vec3 rug_albedo(double x, double z) {
    // x, z from the rug's middle, in half sizes.
    const double edge = std::max(std::abs(x), std::abs(z));
    const vec3 red = hex(0x8E3B3A), cream = hex(0xE2D3B4), blue = hex(0x2F4A6B);
    const vec3 ochre = hex(0xC9963F);
    const double u = x * 7, v = z * 5;
    const double diamond = std::abs(u - std::round(u)) + std::abs(v - std::round(v));
    vec3 color = red;
    if (diamond < 0.26) color = ochre;
    if (diamond < 0.13) color = cream;
    if (edge > 0.80) color = blue;
    if (edge > 0.80 && edge < 0.835) color = cream;
    if (edge > 0.94) color = cream;
    return color * (0.86f + 0.22f * noise(x * 240, z * 160, 31));
}

vec3 painting(double x, double y) {
    // x, y in -1..1: evening over hills.
    const float up = smooth(-0.6, 1.0, y);
    vec3 color = glm::mix(hex(0xF6C08A), hex(0x5D8FBF), up);
    const double sun = std::hypot((x - 0.35) * 1.4, y - 0.22);
    color = glm::mix(hex(0xFFF2C4), color, smooth(0.15, 0.20, sun));
    color += vec3(0.25f, 0.16f, 0.04f) * (1 - smooth(0.0, 0.7, sun));
    const vec3 hills[3] = {hex(0x7C86A8), hex(0x55708A), hex(0x2F5547)};
    for (int i = 0; i < 3; ++i) {
        const double ridge = 0.08 - 0.30 * i + 0.16 * std::sin(x * (2.3 + 0.8 * i) + 1.7 * i) +
                             0.06 * std::sin(x * 7.1 + 2.0 * i);
        if (y < ridge) color = hills[i] * (0.85f + 0.3f * noise(x * 9, y * 20, 50 + i));
    }
    return color;
}

}  // namespace

vec3 albedo(Covering material) {
    return kAlbedo[static_cast<std::size_t>(material)];
}

raycast::Paint paint_of(const Primitive& solid) {
    raycast::Paint paint;
    const vec3 base = albedo(solid.material);
    for (int c = 0; c < 3; ++c) paint.albedo[c] = base[c];
    const bool cloth = solid.material == Covering::shirt || solid.material == Covering::trousers;
    const bool hair = solid.material == Covering::hair;
    if (solid.material == Covering::skin) paint.wrap = 0.45f;
    if (cloth || hair) {
        paint.fold = hair ? 0.22f : 0.085f;
        const double per_m = hair ? 95 : 11;
        paint.fold_x = static_cast<float>(per_m * glm::length(solid.axes[0]));
        paint.fold_y = static_cast<float>((hair ? 30 : 7) * glm::length(solid.axes[1]));
    }
    return paint;
}

raycast::Lights lights_for(const Pose& view_from_world) {
    raycast::Lights out;
    const dvec3 key = view_from_world.rotation * kKey, fill = view_from_world.rotation * kFill;
    const dvec3 up = view_from_world.rotation * dvec3(0, 1, 0);
    for (int c = 0; c < 3; ++c) {
        out.key[c] = static_cast<float>(key[c]);
        out.fill[c] = static_cast<float>(fill[c]);
        out.up[c] = static_cast<float>(up[c]);
        out.key_color[c] = kKeyColor[c];
        out.fill_color[c] = kFillColor[c];
        out.sky_color[c] = kSky[c];
        out.ground_color[c] = kGround[c];
    }
    return out;
}

vec3 color_of_room(const RoomBox& room, int plane, const dvec3& p) {
    const int axis = plane / 2;
    dvec3 n(0);
    n[axis] = plane % 2 == 0 ? 1 : -1;
    float open = covered(p);
    for (int other = 0; other < 6; ++other) {
        if (other == plane) continue;
        const int a = other / 2;
        const double d = other % 2 == 0 ? p[a] - room.min_m[a] : room.max_m[a] - p[a];
        open *= 1 - 0.30f * static_cast<float>(std::exp(-std::max(d, 0.0) / 0.20));
    }
    vec3 base = albedo(Covering::wall);
    if (plane == 2) {
        base = floor_albedo(p);
        const double x = p.x / 1.15, z = (p.z + 2.72) / 0.72;
        if (std::abs(x) < 1 && std::abs(z) < 1) base = rug_albedo(x, z);
    } else if (plane == 3) {
        base = albedo(Covering::ceiling);
    } else {
        if (plane == 4) base = hex(0xA9BDB4);
        base *= 0.97f + 0.06f * noise(p.x * 40 + p.z * 40, p.y * 40, 77);
        if (p.y < 0.10) base = albedo(Covering::white_paint) * (p.y > 0.092 ? 0.7f : 1.0f);
    }
    return lit(base, n, p, open);
}

vec3 color_of_solid(const Primitive& solid, const dvec3& p) {
    const dvec3 local = glm::inverse(solid.axes) * (p - solid.origin_m);
    vec3 base = albedo(solid.material);
    dvec3 n;
    float open = 1;
    if (solid.kind == Primitive::Kind::box) {
        const dvec3 gap = solid.half - glm::abs(local);
        const int axis = gap.x < gap.y ? (gap.x < gap.z ? 0 : 2) : (gap.y < gap.z ? 1 : 2);
        dvec3 face(0);
        face[axis] = local[axis] < 0 ? -1 : 1;
        n = solid.axes * face;
        const int longest = solid.half.x > solid.half.y ? (solid.half.x > solid.half.z ? 0 : 2)
                                                        : (solid.half.y > solid.half.z ? 1 : 2);
        if (solid.material == Covering::wood || solid.material == Covering::dark_wood) {
            base =
                wood(base, local[longest], local[(longest + 1) % 3] + local[(longest + 2) % 3], 21);
        } else if (solid.material == Covering::picture && axis == 2) {
            base = painting(local.x / solid.half.x, local.y / solid.half.y);
        } else if (solid.part == kPartThing && axis != 0) {
            // Spines: a light band, so that books look like books.
            const double y = local.y / solid.half.y;
            if (std::abs(std::abs(y) - 0.62) < 0.05) base = glm::mix(base, vec3(0.9f), 0.5f);
        }
        const double rim = std::min(gap[(axis + 1) % 3], gap[(axis + 2) % 3]);
        base *= 0.88f + 0.12f * smooth(0, 0.006, rim);
    } else {
        const double s = solid.height > 0 ? (solid.radius_a - solid.radius_b) / solid.height : 0.0;
        const double center =
            std::clamp((local.y - s * solid.radius_a) / (1 - s * s), 0.0, solid.height);
        n = glm::normalize(glm::transpose(glm::inverse(solid.axes)) *
                           (local - dvec3(0, center, 0)));
        if (solid.material == Covering::leaf) base *= 0.75f + 0.5f * noise(p.x * 30, p.z * 30, 5);
        if (solid.material == Covering::shade_cloth) return base * 1.05f;
    }
    if (solid.part == kPartShelf || (solid.part == kPartThing && p.z < -4.0)) {
        // Deeper in the shelf and just below a board it is darker.
        open = 0.55f + 0.45f * smooth(-4.40, -4.07, p.z);
    }
    open *= solid.part == kPartTable && p.y < 0.70 ? 0.75f : 1.0f;
    if (solid.part == kPartChair && p.y < 0.40) open *= 0.8f;
    return lit(base, n, p, open);
}

std::uint32_t to_rgba8(const vec3& linear) {
    std::uint32_t out = 0xFF000000u;
    for (int c = 0; c < 3; ++c) {
        const float value = std::sqrt(std::clamp(linear[c], 0.0f, 1.0f)) * 255.0f + 0.5f;
        out |= static_cast<std::uint32_t>(value) << (8 * c);
    }
    return out;
}

}  // namespace kino
