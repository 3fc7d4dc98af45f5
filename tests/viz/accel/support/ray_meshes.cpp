#include "tests/viz/accel/support/ray_meshes.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <glm/geometric.hpp>
#include <numbers>
#include <sstream>

#include "base/check.h"

namespace kino::test {
namespace {

glm::vec3 random_vec(Random& random, double from, double to) {
    return {static_cast<float>(random.real(from, to)), static_cast<float>(random.real(from, to)),
            static_cast<float>(random.real(from, to))};
}

void append(std::vector<Triangle>& to, const std::vector<Triangle>& from) {
    to.insert(to.end(), from.begin(), from.end());
}

std::vector<Triangle> box_mesh(const glm::vec3& lo, const glm::vec3& hi) {
    std::vector<Triangle> triangles;
    const auto corner = [&](int bits) {
        return glm::vec3((bits & 1) != 0 ? hi.x : lo.x, (bits & 2) != 0 ? hi.y : lo.y,
                         (bits & 4) != 0 ? hi.z : lo.z);
    };
    for (int axis = 0; axis < 3; ++axis) {
        const int u = 1 << ((axis + 1) % 3);
        const int v = 1 << ((axis + 2) % 3);
        for (const int side : {0, 1 << axis}) {
            triangles.push_back({corner(side), corner(side | u), corner(side | v)});
            triangles.push_back({corner(side | u), corner(side | u | v), corner(side | v)});
        }
    }
    return triangles;
}

std::vector<Triangle> without_faults(std::vector<Triangle> triangles) {
    std::erase_if(triangles, [](const Triangle& t) { return fault_of(t) != TriangleFault::none; });
    return triangles;
}

}  // namespace

Result<std::vector<Triangle>> load_obj(const std::string& path) {
    std::ifstream file(path);
    if (!file) return fail("cannot be opened", path);
    std::vector<glm::vec3> places;
    std::vector<Triangle> triangles;
    std::string line;
    while (std::getline(file, line)) {
        std::istringstream words(line);
        std::string kind;
        words >> kind;
        if (kind == "v") {
            glm::vec3 p(0);
            words >> p.x >> p.y >> p.z;
            places.push_back(p);
        } else if (kind == "f") {
            std::vector<glm::vec3> corners;
            std::string corner;
            while (words >> corner) {
                const long index = std::strtol(corner.c_str(), nullptr, 10);
                if (index < 1 || std::size_t(index) > places.size()) {
                    return fail("a face has a corner that is not there", path);
                }
                corners.push_back(places[static_cast<std::size_t>(index - 1)]);
            }
            for (std::size_t i = 2; i < corners.size(); ++i) {
                triangles.push_back({corners[0], corners[i - 1], corners[i]});
            }
        }
    }
    return triangles;
}

std::vector<Triangle> sphere_mesh(const glm::vec3& center, float radius, int rings, int sectors) {
    const auto place = [&](int ring, int sector) {
        if (ring == 0) return center + glm::vec3(0, radius, 0);
        if (ring == rings) return center - glm::vec3(0, radius, 0);
        const double polar = std::numbers::pi * ring / rings;
        const double angle = 2 * std::numbers::pi * (sector % sectors) / sectors;
        return center + radius * glm::vec3(std::sin(polar) * std::cos(angle), std::cos(polar),
                                           std::sin(polar) * std::sin(angle));
    };
    std::vector<Triangle> triangles;
    for (int ring = 0; ring < rings; ++ring) {
        for (int sector = 0; sector < sectors; ++sector) {
            const glm::vec3 a = place(ring, sector);
            const glm::vec3 b = place(ring, sector + 1);
            const glm::vec3 c = place(ring + 1, sector);
            const glm::vec3 d = place(ring + 1, sector + 1);
            if (ring > 0) triangles.push_back({a, b, c});
            if (ring + 1 < rings) triangles.push_back({b, d, c});
        }
    }
    return triangles;
}

std::vector<Triangle> noisy_wall(int columns, int rows, std::uint64_t seed) {
    Random random(seed);
    std::vector<glm::vec3> places;
    for (int y = 0; y <= rows; ++y) {
        for (int x = 0; x <= columns; ++x) {
            places.emplace_back(3.4 * x / columns, 2.5 * y / rows, random.real(0, 0.03));
        }
    }
    std::vector<Triangle> triangles;
    for (int y = 0; y < rows; ++y) {
        for (int x = 0; x < columns; ++x) {
            const auto i = static_cast<std::size_t>(y * (columns + 1) + x);
            const std::size_t below = i + static_cast<std::size_t>(columns) + 1;
            triangles.push_back({places[i], places[i + 1], places[below]});
            triangles.push_back({places[i + 1], places[below + 1], places[below]});
        }
    }
    return triangles;
}

std::vector<Triangle> room_mesh(int balls, int rings, std::uint64_t seed) {
    Random random(seed);
    std::vector<Triangle> triangles = box_mesh({-3, 0, -2.5}, {3, 3, 2.5});
    for (int i = 0; i < balls; ++i) {
        const auto radius = static_cast<float>(random.real(0.1, 0.4));
        const glm::vec3 center(random.real(-2.4, 2.4), radius, random.real(-2, 2));
        append(triangles, sphere_mesh(center, radius, rings, 2 * rings));
    }
    return triangles;
}

std::vector<Triangle> awkward_mesh(int count, std::uint64_t seed) {
    Random random(seed);
    std::vector<Triangle> triangles;
    for (int i = 0; i < count; ++i) {
        const glm::vec3 at = random.chance(0.2) ? glm::vec3(0.25f) : random_vec(random, -1, 1);
        const double size = std::pow(10.0, random.real(-6, 0.3));
        Triangle t{at, at + random_vec(random, -size, size), at + random_vec(random, -size, size)};
        if (random.chance(0.2)) t.c = t.a + (t.b - t.a) * 0.5f + random_vec(random, -1e-7, 1e-7);
        if (random.chance(0.1)) t.b.z = t.c.z = t.a.z;
        if (random.chance(0.1) && !triangles.empty()) {
            t = triangles[static_cast<std::size_t>(random.integer(0, int(triangles.size()) - 1))];
        }
        triangles.push_back(t);
    }
    return without_faults(std::move(triangles));
}

static std::vector<NamedMesh> make_test_meshes() {
    std::vector<NamedMesh> meshes;
    auto spot = load_obj("tests/data/accel/spot.obj");
    KINO_CHECK(spot.has_value());
    meshes.push_back({"spot", *spot});
    meshes.push_back({"sphere", sphere_mesh({0.1f, -0.2f, 0.3f}, 0.8f, 24, 48)});
    meshes.push_back({"room", room_mesh(8, 8, 5)});
    meshes.push_back({"wall", noisy_wall(40, 30, 6)});
    auto flat = noisy_wall(30, 20, 7);
    for (Triangle& t : flat) t.a.z = t.b.z = t.c.z = 0.5f;
    meshes.push_back({"flat wall", flat});
    meshes.push_back({"one triangle", {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0.5f}}}});
    meshes.push_back(
        {"equal triangles", std::vector<Triangle>(2000, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0.5f}})});
    meshes.push_back({"awkward", awkward_mesh(2000, 8)});
    auto far = sphere_mesh({0, 0, 0}, 50.0f, 16, 32);
    for (Triangle& t : far) {
        for (glm::vec3* p : {&t.a, &t.b, &t.c}) *p += glm::vec3(1e6f, -1e6f, 1e6f);
    }
    meshes.push_back({"1e6 m off", without_faults(far)});
    return meshes;
}

const std::vector<NamedMesh>& test_meshes() {
    static const std::vector<NamedMesh> made = make_test_meshes();
    return made;
}

Ray random_ray(Random& random, const std::vector<Triangle>& triangles) {
    glm::vec3 lo(3e38f);
    glm::vec3 hi(-3e38f);
    // A few corners are enough to know about where the mesh is.
    for (std::size_t i = 0; i < triangles.size(); i += 1 + triangles.size() / 64) {
        lo = glm::min(lo, glm::min(triangles[i].a, glm::min(triangles[i].b, triangles[i].c)));
        hi = glm::max(hi, glm::max(triangles[i].a, glm::max(triangles[i].b, triangles[i].c)));
    }
    const glm::vec3 middle = 0.5f * (lo + hi);
    const float reach = std::max(0.8f * glm::length(hi - lo), 0.1f);
    const auto place = [&](float scale) {
        return middle + scale * reach * random_vec(random, -1, 1);
    };
    Ray ray;
    ray.origin = place(1);
    ray.direction = place(0.5f) - ray.origin;
    if (random.chance(0.1)) {
        // Along an axis, from a corner: on planes of boxes, through vertices and edges.
        const auto i = static_cast<std::size_t>(random.integer(0, int(triangles.size()) - 1));
        const int axis = random.integer(0, 2);
        ray.direction = glm::vec3(0);
        ray.direction[axis] = random.chance(0.5) ? reach : -reach;
        ray.origin = triangles[i].b;
        ray.origin[axis] = middle[axis] - 3 * ray.direction[axis];
        for (int k = 0; k < 3; ++k) {
            if (k != axis && random.chance(0.5)) ray.direction[k] = -0.0f;
        }
    }
    if (random.chance(0.1)) {
        ray.t_min = static_cast<float>(random.real(0, 1));
        ray.t_max = ray.t_min + static_cast<float>(random.real(0, 1));
    }
    return ray;
}

std::vector<reference::RayTriangle> in_double(const std::vector<Triangle>& triangles) {
    std::vector<reference::RayTriangle> wide;
    wide.reserve(triangles.size());
    for (const Triangle& t : triangles) wide.push_back({t.a, t.b, t.c});
    return wide;
}

}  // namespace kino::test
