#include "skeleton/synthetic/room.h"

#include <array>
#include <cmath>
#include <glm/gtc/quaternion.hpp>

namespace kino {
namespace {

using glm::dmat3;
using glm::dvec3;

dmat3 yawed(double rad) {
    return glm::mat3_cast(glm::angleAxis(rad, dvec3(0, 1, 0)));
}

// A piece of furniture stands at `origin`, turned about y.
struct Piece {
    std::vector<Primitive>& out;
    dvec3 origin;
    double yaw_rad;
    PartId part;

    [[nodiscard]] dvec3 at(const dvec3& p) const { return origin + yawed(yaw_rad) * p; }
    void block(const dvec3& c, const dvec3& half, Covering m, double turn = 0) {
        out.push_back(box(at(c), half, part, m, yawed(yaw_rad + turn)));
    }
    void cone(const dvec3& a, const dvec3& b, double ra, double rb, Covering m) {
        out.push_back(round_cone(at(a), at(b), ra, rb, part, m));
    }
    void ball(const dvec3& c, const dvec3& r, Covering m) {
        out.push_back(ellipsoid(at(c), yawed(yaw_rad), r, part, m));
    }
};

void add_table(std::vector<Primitive>& out) {
    Piece t{out, {1.00, 0, -2.10}, -0.12, kPartTable};
    t.block({0, 0.715, 0}, {0.46, 0.018, 0.31}, Covering::wood);
    t.block({0, 0.668, 0}, {0.41, 0.030, 0.26}, Covering::dark_wood);
    for (const double x : {-0.40, 0.40}) {
        for (const double z : {-0.25, 0.25}) {
            t.block({x, 0.350, z}, {0.026, 0.350, 0.026}, Covering::dark_wood);
        }
    }
    t.part = kPartThing;
    t.block({-0.22, 0.755, -0.02}, {0.115, 0.020, 0.085}, Covering::blue, 0.3);
    t.block({-0.22, 0.790, -0.02}, {0.100, 0.015, 0.075}, Covering::orange, 0.05);
    t.block({-0.23, 0.818, -0.02}, {0.092, 0.013, 0.068}, Covering::cream, 0.5);
    t.cone({0.06, 0.760, 0.13}, {0.06, 0.812, 0.13}, 0.038, 0.038, Covering::red);
    t.cone({0.104, 0.775, 0.13}, {0.110, 0.805, 0.13}, 0.009, 0.009, Covering::red);
    t.ball({0.22, 0.778, -0.05}, {0.048, 0.045, 0.048}, Covering::green);
    t.ball({0.31, 0.773, 0.01}, {0.042, 0.040, 0.042}, Covering::red);
    t.ball({0.24, 0.772, 0.06}, {0.040, 0.039, 0.040}, Covering::yellow);
}

void add_chair(std::vector<Primitive>& out) {
    Piece c{out, {-1.28, 0, -3.15}, 0.75, kPartChair};
    c.block({0, 0.440, 0}, {0.215, 0.022, 0.21}, Covering::teal);
    c.block({0, 0.405, 0}, {0.205, 0.015, 0.20}, Covering::dark_wood);
    for (const double x : {-0.185, 0.185}) {
        c.block({x, 0.20, 0.18}, {0.020, 0.20, 0.020}, Covering::dark_wood);
        c.block({x, 0.44, -0.19}, {0.020, 0.44, 0.020}, Covering::dark_wood);
    }
    c.block({0, 0.80, -0.19}, {0.165, 0.055, 0.012}, Covering::wood);
    c.block({0, 0.64, -0.19}, {0.165, 0.035, 0.012}, Covering::wood);
    c.ball({0, 0.52, -0.09}, {0.17, 0.145, 0.075}, Covering::yellow);
}

void add_shelf(std::vector<Primitive>& out) {
    Piece s{out, {-1.28, 0, -4.22}, 0, kPartShelf};
    constexpr double kWidth = 0.50, kDepth = 0.16, kHeight = 1.78;
    for (const double x : {-kWidth, kWidth}) {
        s.block({x, kHeight / 2, 0}, {0.015, kHeight / 2, kDepth}, Covering::wood);
    }
    constexpr std::array<double, 5> kBoards = {0.06, 0.48, 0.90, 1.32, 1.765};
    for (const double y : kBoards) {
        s.block({0, y, 0}, {kWidth - 0.015, 0.014, kDepth}, Covering::wood);
    }
    s.block({0, kHeight / 2, -kDepth + 0.006}, {kWidth, kHeight / 2, 0.006}, Covering::dark_wood);
    s.part = kPartThing;
    constexpr std::array<Covering, 7> kCovers = {
        Covering::red,    Covering::blue,   Covering::cream, Covering::green,
        Covering::orange, Covering::purple, Covering::teal};
    // Books: widths and heights from a small integer recurrence, the same on every machine.
    unsigned seed = 7;
    const auto next = [&seed](unsigned n) {
        seed = seed * 1664525u + 1013904223u;
        return static_cast<double>((seed >> 16) % n) / static_cast<double>(n);
    };
    constexpr std::array<double, 3> kFill = {0.86, 0.50, 0.62};
    for (std::size_t row = 0; row < kFill.size(); ++row) {
        double x = row == 1 ? -0.10 : -0.46;
        const double end = x + kFill[row];
        for (std::size_t book = 0; x < end; ++book) {
            const double half_x = 0.019 + 0.018 * next(64), half_y = 0.115 + 0.055 * next(64);
            s.block({x + half_x, kBoards[row + 1] + 0.014 + half_y, 0.00},
                    {half_x - 0.001, half_y, 0.095 + 0.02 * next(64)},
                    kCovers[(book + 3 * row) % kCovers.size()]);
            x += 2 * half_x;
        }
    }
    s.block({-0.24, 0.20, 0.0}, {0.20, 0.125, 0.13}, Covering::cream);
    s.block({0.24, 0.19, 0.0}, {0.19, 0.115, 0.13}, Covering::teal);
    s.cone({0.31, 1.40, 0.02}, {0.31, 1.47, 0.02}, 0.060, 0.045, Covering::clay);
    s.cone({-0.30, 0.985, 0.03}, {-0.30, 1.09, 0.03}, 0.075, 0.028, Covering::blue);
    s.cone({0.1, 1.85, 0}, {0.1, 1.86, 0}, 0.075, 0.075, Covering::metal);
}

void add_lamp(std::vector<Primitive>& out) {
    Piece l{out, {1.72, 0, -4.02}, 0, kPartLamp};
    l.cone({0, 0.004, 0}, {0, 0.018, 0}, 0.020, 0.020, Covering::metal);
    l.block({0, 0.012, 0}, {0.13, 0.012, 0.13}, Covering::metal);
    l.cone({0, 0.02, 0}, {0, 1.40, 0}, 0.012, 0.012, Covering::metal);
    l.out.push_back(flat_cone(l.at({0, 1.40, 0}), l.at({0, 1.62, 0}), 0.19, 0.11, {1, 0, 0}, 1, 1,
                              kPartLamp, Covering::shade_cloth));
}

void add_plant(std::vector<Primitive>& out) {
    Piece p{out, {0.98, 0, -4.05}, 0, kPartPlant};
    p.cone({0, 0.10, 0}, {0, 0.27, 0}, 0.105, 0.150, Covering::clay);
    constexpr int kLeaves = 11;
    for (int i = 0; i < kLeaves; ++i) {
        const double a = 2.399963 * i, up = 0.78 + 0.055 * i;
        const double reach = 0.30 - 0.016 * i;
        const dvec3 tip(reach * std::cos(a), up, reach * std::sin(a) * 0.8);
        p.cone({0, 0.34, 0}, tip * dvec3(0.75, 0.92, 0.75), 0.010, 0.006, Covering::leaf);
        out.push_back(flat_cone(p.at(tip * dvec3(0.55, 0.86, 0.55)), p.at(tip), 0.030, 0.014,
                                dvec3(-std::sin(a), 0, std::cos(a)), 2.1, 0.40, kPartPlant,
                                Covering::leaf));
    }
}

void add_picture(std::vector<Primitive>& out) {
    Piece p{out, {0.62, 1.62, -4.38}, 0, kPartPicture};
    p.block({0, 0, 0}, {0.41, 0.30, 0.018}, Covering::dark_wood);
    p.block({0, 0, 0.012}, {0.375, 0.265, 0.010}, Covering::picture);
}

}  // namespace

std::vector<Primitive> make_furniture() {
    std::vector<Primitive> out;
    add_table(out);
    add_chair(out);
    add_shelf(out);
    add_lamp(out);
    add_plant(out);
    add_picture(out);
    Piece ball{out, {-0.95, 0, -2.25}, 0, kPartThing};
    ball.ball({0, 0.11, 0}, {0.11, 0.11, 0.11}, Covering::orange);
    return out;
}

}  // namespace kino
