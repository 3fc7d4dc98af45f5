#include "skeleton/synthetic/body_flesh.h"

#include <array>
#include <glm/geometric.hpp>

namespace kino {
namespace {

using glm::dmat3;
using glm::dvec3;

PartId part_of(Joint j) {
    return static_cast<PartId>(static_cast<int>(j) + 1);
}
Joint of_side(Joint left, int side) {
    return static_cast<Joint>(static_cast<int>(left) + 4 * side);
}

// Collects solids that are written down in the frame of one bone.
struct Builder {
    std::vector<Primitive>& out;
    dvec3 origin{0};
    dmat3 frame{1};
    Joint joint = Joint::head;

    [[nodiscard]] dvec3 at(const dvec3& local) const { return origin + frame * local; }
    void place(Joint j, const dvec3& o, const dmat3& f) {
        joint = j;
        origin = o;
        frame = f;
    }
    void ball(const dvec3& c, const dvec3& radii, Covering m) {
        out.push_back(ellipsoid(at(c), frame, radii, part_of(joint), m));
    }
    void cone(const dvec3& a, const dvec3& b, double ra, double rb, Covering m) {
        out.push_back(round_cone(at(a), at(b), ra, rb, part_of(joint), m));
    }
    void flat(const dvec3& a, const dvec3& b, double ra, double rb, double wide, double deep,
              Covering m) {
        out.push_back(flat_cone(at(a), at(b), ra, rb, frame[0], wide, deep, part_of(joint), m));
    }
    void bone(const dvec3& a, const dvec3& b, double ra, double rb, Covering m) {
        out.push_back(round_cone(a, b, ra, rb, part_of(joint), m));
    }
};

void append_head(const PosedBody& body, Builder& b) {
    b.place(Joint::head, body[Joint::head], body.head);
    b.ball({0, 0.030, -0.008}, {0.076, 0.098, 0.094}, Covering::skin);
    b.ball({0, -0.030, 0.016}, {0.061, 0.078, 0.070}, Covering::skin);
    b.ball({0, -0.078, 0.052}, {0.030, 0.024, 0.028}, Covering::skin);
    b.cone({0, 0.014, 0.084}, {0, -0.018, 0.097}, 0.010, 0.0135, Covering::skin);
    b.ball({0, -0.0500, 0.0805}, {0.021, 0.0068, 0.0105}, Covering::lips);
    for (const double s : {1.0, -1.0}) {
        b.ball({s * 0.030, 0.016, 0.0775}, {0.0150, 0.0085, 0.0095}, Covering::eye_white);
        b.ball({s * 0.030, 0.016, 0.0835}, {0.0072, 0.0074, 0.0050}, Covering::eye_iris);
        b.cone({s * 0.046, 0.0420, 0.0705}, {s * 0.018, 0.0430, 0.0825}, 0.0036, 0.0044,
               Covering::hair);
        b.ball({s * 0.076, 0.002, -0.008}, {0.010, 0.030, 0.018}, Covering::skin);
        b.ball({s * 0.058, 0.045, 0.006}, {0.026, 0.050, 0.050}, Covering::hair);
    }
    b.ball({0, 0.054, -0.016}, {0.084, 0.090, 0.096}, Covering::hair);
    b.ball({0, 0.005, -0.046}, {0.072, 0.078, 0.064}, Covering::hair);
    b.ball({0.022, 0.094, 0.048}, {0.052, 0.030, 0.042}, Covering::hair);
}

void append_torso(const PosedBody& body, Builder& b) {
    const dvec3& neck = body[Joint::shoulder_center];
    b.place(Joint::shoulder_center, neck, body.chest);
    b.bone(b.at({0, -0.03, -0.012}), body[Joint::head] + body.head * dvec3(0, -0.045, -0.018),
           0.056, 0.050, Covering::skin);
    // Collar, slope of the shoulders, and the yoke between them.
    b.flat({0, 0.004, -0.012}, {0, -0.03, -0.012}, 0.059, 0.076, 1.08, 1.0, Covering::shirt);
    for (int side = 0; side < 2; ++side) {
        const dvec3& shoulder = body[of_side(Joint::shoulder_left, side)];
        b.bone(b.at({0, 0.002, -0.024}), shoulder - body.chest[1] * 0.004, 0.052, 0.0505,
               Covering::shirt);
        b.bone(b.at({0, -0.10, 0.0}), shoulder - body.chest[1] * 0.020, 0.092, 0.054,
               Covering::shirt);
    }
    b.flat({0, -0.315, 0.006}, {0, -0.115, -0.002}, 0.1105, 0.114, 1.36, 0.99, Covering::shirt);
    for (const double s : {1.0, -1.0}) {
        b.ball({s * 0.058, -0.130, 0.050}, {0.092, 0.092, 0.0575}, Covering::shirt);
    }
    b.ball({0, -0.165, 0.1095}, {0.056, 0.052, 0.0145}, Covering::shirt_print);

    b.place(Joint::spine, body[Joint::spine], body.waist);
    b.flat({0, -0.055, 0.006}, {0, 0.045, 0.005}, 0.112, 0.1125, 1.32, 0.97, Covering::shirt);

    b.place(Joint::hip_center, body[Joint::hip_center], body.pelvis);
    b.flat({0, 0.015, 0.002}, {0, 0.115, 0.006}, 0.116, 0.110, 1.36, 1.0, Covering::shirt);
    b.flat({0, -0.052, 0}, {0, 0.0, 0}, 0.111, 0.113, 1.43, 1.0, Covering::trousers);
    for (const double s : {1.0, -1.0}) {
        b.ball({s * 0.074, -0.060, -0.040}, {0.088, 0.100, 0.090}, Covering::trousers);
    }
}

void append_hand(const PosedBody& body, int side, Builder& b) {
    b.place(of_side(Joint::hand_left, side), body[of_side(Joint::wrist_left, side)],
            body.hand[side]);
    b.flat({0, 0.012, 0}, {0, 0.074, 0}, 0.024, 0.030, 1.22, 0.58, Covering::skin);
    constexpr std::array<double, 4> kLength = {0.066, 0.074, 0.069, 0.054};
    for (std::size_t i = 0; i < 4; ++i) {
        const double x = 0.0285 - 0.0185 * static_cast<double>(i);
        b.cone({x, 0.088, 0}, {x * 1.22, 0.094 + kLength[i], -0.012}, 0.0100, 0.0078,
               Covering::skin);
    }
    b.cone({0.024, 0.022, -0.004}, {0.056, 0.086, -0.012}, 0.0150, 0.0095, Covering::skin);
}

void append_arm(const PosedBody& body, int side, Builder& b) {
    const dvec3& shoulder = body[of_side(Joint::shoulder_left, side)];
    const dvec3& elbow = body[of_side(Joint::elbow_left, side)];
    const dvec3& wrist = body[of_side(Joint::wrist_left, side)];
    b.joint = of_side(Joint::shoulder_left, side);
    b.bone(glm::mix(shoulder, elbow, 0.03), glm::mix(shoulder, elbow, 0.55), 0.0500, 0.0525,
           Covering::shirt);
    b.joint = of_side(Joint::elbow_left, side);
    b.bone(glm::mix(shoulder, elbow, 0.35), elbow, 0.044, 0.037, Covering::skin);
    b.bone(elbow, glm::mix(elbow, wrist, 0.38), 0.038, 0.041, Covering::skin);
    b.bone(glm::mix(elbow, wrist, 0.38), wrist, 0.041, 0.026, Covering::skin);
    b.joint = of_side(Joint::wrist_left, side);
    b.bone(wrist, body[of_side(Joint::hand_left, side)], 0.026, 0.020, Covering::skin);
    if (side == 0) {
        b.bone(glm::mix(elbow, wrist, 0.90), glm::mix(elbow, wrist, 0.97), 0.0315, 0.0310,
               Covering::watch);
    }
    append_hand(body, side, b);
}

void append_leg(const PosedBody& body, int side, Builder& b) {
    const dvec3& hip = body[of_side(Joint::hip_left, side)];
    const dvec3& knee = body[of_side(Joint::knee_left, side)];
    const dvec3& ankle = body[of_side(Joint::ankle_left, side)];
    const dmat3& foot = body.foot[side];
    b.joint = of_side(Joint::hip_left, side);
    b.bone(hip, glm::mix(hip, knee, 0.45), 0.094, 0.082, Covering::trousers);
    b.joint = of_side(Joint::knee_left, side);
    b.bone(glm::mix(hip, knee, 0.45), knee, 0.082, 0.060, Covering::trousers);
    const dvec3 calf = glm::mix(knee, ankle, 0.32) - foot[2] * 0.012;
    b.bone(knee, calf, 0.060, 0.061, Covering::trousers);
    b.joint = of_side(Joint::ankle_left, side);
    b.bone(calf, glm::mix(knee, ankle, 0.90), 0.061, 0.051, Covering::trousers);
    b.bone(glm::mix(knee, ankle, 0.8), ankle, 0.036, 0.036, Covering::sole);
    b.place(of_side(Joint::foot_left, side), ankle, foot);
    b.cone({0, -0.005, -0.012}, {0, -0.035, 0.030}, 0.043, 0.040, Covering::shoe);
    b.flat({0, -0.043, -0.032}, {0, -0.050, 0.070}, 0.036, 0.036, 1.0, 0.95, Covering::shoe);
    b.flat({0, -0.050, 0.060}, {0, -0.054, 0.150}, 0.036, 0.027, 1.32, 0.95, Covering::shoe);
    b.flat({0, -0.076, -0.036}, {0, -0.076, 0.152}, 0.034, 0.034, 1.25, 0.30, Covering::sole);
}

}  // namespace

void append_flesh(const PosedBody& body, std::vector<Primitive>& out) {
    Builder b{out};
    append_head(body, b);
    append_torso(body, b);
    for (int side = 0; side < 2; ++side) {
        append_arm(body, side, b);
        append_leg(body, side, b);
    }
}

}  // namespace kino
