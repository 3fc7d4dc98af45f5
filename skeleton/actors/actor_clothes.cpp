#include "skeleton/actors/actor_clothes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>

namespace kino {
namespace {

using glm::dvec3;

// Where a vertex of the base mesh lies on the limbs; computed once.
struct Place {
    double arm = 0, leg = 0, trunk = 0, head = 0, neck = 0, foot = 0;  // shares of the bones
    double along_arm = 0, along_leg = 0;  // 0 shoulder or hip, 1 elbow or knee, 2 wrist or ankle
};

double along(const BaseMesh& mesh, int a, const dvec3& p) {
    const dvec3 &from = mesh.joint_m[static_cast<std::size_t>(a)],
                &to = mesh.joint_m[static_cast<std::size_t>(a) + 1];
    return glm::dot(p - from, to - from) / glm::dot(to - from, to - from);
}

// Along the two bones that start at a joint: the far bone counts where the near one has ended.
double along_limb(const BaseMesh& mesh, Joint root, int side, const dvec3& p) {
    const int a = static_cast<int>(root) + 4 * side;
    const double near = along(mesh, a, p);
    return near < 1 ? near : std::max(1.0, 1 + along(mesh, a + 1, p));
}

std::vector<Place> find_places() {
    const BaseMesh& mesh = base_mesh();
    std::vector<Place> places(mesh.vertex_m.size());
    for (std::size_t i = 0; i < places.size(); ++i) {
        Place& place = places[i];
        for (std::size_t k = 0; k < 4; ++k) {
            const std::size_t b = mesh.weights[i].bone[k];
            const double w = mesh.weights[i].weight[k];
            const auto left =
                static_cast<ActorBone>(b < 5 + kActorBonesOfSide ? b : b - kActorBonesOfSide);
            if (left <= ActorBone::chest || left == ActorBone::clavicle) place.trunk += w;
            if (left == ActorBone::neck) place.neck += w;
            if (left == ActorBone::head) place.head += w;
            if (left >= ActorBone::upper_arm_high && left <= ActorBone::forearm_low) place.arm += w;
            if (left >= ActorBone::thigh_high && left <= ActorBone::shin_low) place.leg += w;
            if (left >= ActorBone::foot) place.foot += w;
        }
        const int side = mesh.vertex_m[i].x >= 0 ? 0 : 1;
        place.along_arm = along_limb(mesh, Joint::shoulder_left, side, mesh.vertex_m[i]);
        place.along_leg = along_limb(mesh, Joint::hip_left, side, mesh.vertex_m[i]);
    }
    return places;
}

// 1 on the covered side of a hem that lies at `end`.
double covered(double end, double along) {
    return smooth_step(-0.03, 0.03, end - along);
}

double hair_cover(const dvec3& base) {
    const double back = smooth_step(0.0, 0.05, 0.045 - base.z) * smooth_step(1.53, 1.56, base.y);
    return std::max(back, smooth_step(1.635, 1.66, base.y));
}

}  // namespace

ClothesOffset clothes_offset(const ActorLook& look) {
    static const std::vector<Place> places = find_places();
    const BaseMesh& mesh = base_mesh();
    ClothesOffset offset;
    offset.out_m.assign(places.size(), 0);
    offset.down_m.assign(places.size(), 0);
    for (std::size_t i = 0; i < places.size(); ++i) {
        const Place& p = places[i];
        const dvec3& base = mesh.vertex_m[i];
        const double waist = (base.y - 1.10) / 0.085;
        double out = p.trunk * (look.shirt_m + look.drape_m * std::exp(-waist * waist / 2));
        out = std::max(out, p.arm * look.sleeve_m * covered(look.sleeve_end, p.along_arm));
        const double slack = std::clamp(p.along_leg / 2, 0.0, 1.0);
        out = std::max(out, (p.leg + 0.5 * p.foot) * covered(look.trousers_end, p.along_leg) *
                                (look.trousers_m + look.trousers_flare_m * slack * slack));
        if (look.jacket_m > 0) {
            out = std::max(out, look.jacket_m * (p.trunk + p.arm * covered(2, p.along_arm) +
                                                 p.leg * covered(look.jacket_end, p.along_leg)));
        }
        out += p.foot * look.shoe_m;
        const double scalp = p.head * hair_cover(base);
        out +=
            std::max(scalp * look.hair_m, p.head * smooth_step(1.635, 1.645, base.y) * look.cap_m);
        if (look.hood_m > 0) {
            const double back = smooth_step(-0.02, 0.06, 0.05 - base.z);
            out += look.hood_m * std::max(p.neck * back, p.head * back);
        }
        offset.out_m[i] = out;
        offset.down_m[i] = look.sole_m * p.foot * smooth_step(0.10, 0.02, base.y);
    }
    return offset;
}

namespace {

// Largest first, as skin() wants them.
BoneWeights sorted(BoneWeights w) {
    for (std::size_t i = 1; i < 4; ++i) {
        for (std::size_t k = i; k > 0 && w.weight[k] > w.weight[k - 1]; --k) {
            std::swap(w.weight[k], w.weight[k - 1]);
            std::swap(w.bone[k], w.bone[k - 1]);
        }
    }
    return w;
}

// A surface of rings, each with the same number of points, closed round.
template <class Point, class Part>
void add_rings(ActorBody& body, int rings, int points, const Point& point, const Part& part) {
    const auto first = static_cast<std::uint32_t>(body.vertex_m.size());
    for (int r = 0; r < rings; ++r) {
        for (int k = 0; k < points; ++k) {
            const auto [p, w] = point(double(r) / (rings - 1), 2 * M_PI * k / points);
            body.vertex_m.emplace_back(p);
            body.weights.push_back(sorted(w));
        }
    }
    for (int r = 0; r + 1 < rings; ++r) {
        for (int k = 0; k < points; ++k) {
            const auto at = [&](int ring, int turn) {
                return first + static_cast<std::uint32_t>(ring * points + turn % points);
            };
            const BodyPart label = part((r + 0.5) / (rings - 1), 2 * M_PI * (k + 0.5) / points);
            body.triangles.push_back({at(r, k), at(r + 1, k), at(r + 1, k + 1)});
            body.triangles.push_back({at(r, k), at(r + 1, k + 1), at(r, k + 1)});
            body.part.insert(body.part.end(), 2, label);
        }
    }
}

BodyPart sided(BodyPart left, double x) {
    return x >= 0 ? left : mirrored(left);
}

}  // namespace

void add_skirt(const ActorLook& look, const ActorShape& shape, ActorBody& body) {
    if (look.skirt_end <= 0) return;
    const auto joint = [&](Joint j) { return shape.joint_m[static_cast<std::size_t>(j)]; };
    const double hip = joint(Joint::hip_left).y, knee = joint(Joint::knee_left).y,
                 ankle = joint(Joint::ankle_left).y;
    const double top = hip + 0.09 * look.stature_m / 1.7;
    // Round the hips as they are.
    double wide = 0, front = 0, back = 0;
    for (std::size_t i = 0; i < shape.vertex_m.size(); ++i) {
        const dvec3& p = shape.vertex_m[i];
        if (std::abs(p.y - hip) > 0.06 || std::abs(p.x) > 0.30) continue;
        wide = std::max(wide, std::abs(p.x));
        front = std::max(front, p.z);
        back = std::min(back, p.z);
    }
    const double bottom = look.skirt_end < 1 ? glm::mix(hip, knee, look.skirt_end)
                                             : glm::mix(knee, ankle, look.skirt_end - 1);
    const double z = (front + back) / 2, rx = wide + 0.012, rz = (front - back) / 2 + 0.012;
    const auto place = [&](double s, double turn) {
        const double y = glm::mix(top, bottom, s);
        const double snug = 0.90 + 0.10 * std::min(1.0, s / 0.25);
        const double out = look.skirt_flare_m * s;
        return dvec3(std::cos(turn) * (rx * snug + out), y, z + std::sin(turn) * (rz * snug + out));
    };
    const auto leg_at = [&](double y) {  // 0 hip, 1 knee, 2 ankle
        return y > knee ? (hip - y) / (hip - knee) : 1 + (knee - y) / (knee - ankle);
    };
    add_rings(
        body, 14, 36,
        [&](double s, double turn) {
            const dvec3 p = place(s, turn);
            const double leg = leg_at(p.y), free = smooth_step(-0.25, 0.5, leg);
            const double shin = 0.7 * smooth_step(0.9, 1.5, leg);
            const double left = smooth_step(-0.8, 0.8, p.x / rx);
            BoneWeights w;
            if (shin > 0) {
                w.bone = {bone_index(ActorBone::thigh_low, 0), bone_index(ActorBone::thigh_low, 1),
                          bone_index(ActorBone::shin_high, 0), bone_index(ActorBone::shin_high, 1)};
                w.weight = {float(left * (1 - shin)), float((1 - left) * (1 - shin)),
                            float(left * shin), float((1 - left) * shin)};
            } else {
                w.bone = {bone_index(ActorBone::pelvis), bone_index(ActorBone::thigh_low, 0),
                          bone_index(ActorBone::thigh_low, 1), 0};
                w.weight = {float(1 - free), float(free * left), float(free * (1 - left)), 0};
            }
            return std::pair(p, w);
        },
        [&](double s, double turn) {
            const dvec3 p = place(s, turn);
            const double leg = leg_at(p.y);
            return sided(leg < 0.1   ? BodyPart::belly_left
                         : leg < 0.5 ? BodyPart::thigh_left_high
                         : leg < 1   ? BodyPart::thigh_left_low
                         : leg < 1.5 ? BodyPart::shin_left_high
                                     : BodyPart::shin_left_low,
                         p.x);
        });
}

void add_long_hair(const ActorLook& look, const ActorShape& shape, ActorBody& body) {
    if (look.long_hair_m <= 0) return;
    const auto joint = [&](Joint j) { return shape.joint_m[static_cast<std::size_t>(j)]; };
    const dvec3 skull = joint(Joint::head), neck = joint(Joint::shoulder_center);
    const double size = look.head * look.stature_m / 1.7;
    const double top = skull.y + 0.05 * size, bottom = skull.y - 0.07 * size - look.long_hair_m;
    const auto place = [&](double s, double turn) {
        const double y = glm::mix(top, bottom, s);
        const double thick = std::sqrt(std::max(0.0, 1 - (2 * s - 1) * (2 * s - 1))) * 0.75 + 0.2;
        return dvec3(std::cos(turn) * 0.088 * size * thick, y,
                     skull.z - 0.075 * size + std::sin(turn) * 0.050 * size * thick);
    };
    add_rings(
        body, 10, 20,
        [&](double s, double turn) {
            const dvec3 p = place(s, turn);
            const double down = smooth_step(skull.y - 0.05, neck.y - 0.05, p.y);
            BoneWeights w;
            w.bone = {bone_index(ActorBone::head), bone_index(ActorBone::chest), 0, 0};
            w.weight = {float(1 - 0.8 * down), float(0.8 * down), 0, 0};
            return std::pair(p, w);
        },
        [&](double s, double turn) {
            const dvec3 p = place(s, turn);
            return p.y > skull.y - 0.09 * size ? BodyPart::head
                   : p.y > neck.y              ? BodyPart::neck
                                               : sided(BodyPart::chest_left, p.x);
        });
}

}  // namespace kino
