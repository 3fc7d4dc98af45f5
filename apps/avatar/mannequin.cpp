#include "apps/avatar/mannequin.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include "apps/avatar/implicit_surface.h"
#include "apps/avatar/turns.h"
#include "viz/surface/mesh_shapes.h"

namespace kino {
namespace {

using glm::dvec3;

/// A round cone, its section scaled: half as deep (z) for 0.5.
struct Limb {
    dvec3 a, b;
    double radius_a, radius_b;
    double deep = 1;
    double wide = 1;
};

/// About the distance to a limb: exact for unscaled ones of equal radii.
double limb_distance(const Limb& limb, const dvec3& p) {
    const dvec3 stretch(1 / limb.wide, 1, 1 / limb.deep);
    const dvec3 bone = (limb.b - limb.a) * stretch;
    const dvec3 q = (p - limb.a) * stretch;
    const double t =
        std::clamp(glm::dot(q, bone) / std::max(glm::dot(bone, bone), 1e-12), 0.0, 1.0);
    const double d = glm::length(q - bone * t) - glm::mix(limb.radius_a, limb.radius_b, t);
    return d * std::min({1.0, limb.deep, limb.wide});
}

/// Union with a fillet of about `k` metres (polynomial smooth minimum).
double blend_distance(double a, double b, double k) {
    const double h = std::max(k - std::abs(a - b), 0.0) / k;
    return std::min(a, b) - h * h * k * 0.25;
}

/// The mannequin's joints, left side.
/// How far joints reach into the flesh of their neighbours.
constexpr double kSoftM = 0.03;

struct Places {
    dvec3 hips{0, 0.955, 0}, spine{0, 1.085, 0}, chest{0, 1.235, -0.005}, neck{0, 1.425, -0.012};
    dvec3 head{0, 1.60, 0.012};
    dvec3 collar{0.03, 1.40, -0.008}, shoulder{0.178, 1.388, -0.015};
    dvec3 elbow, wrist, hand;
    dvec3 hip{0.092, 0.905, 0}, knee{0.105, 0.482, 0.012}, ankle{0.112, 0.078, -0.012};
    dvec3 toes{0.122, 0.026, 0.112};

    Places() {
        // Arms half way between hanging and level: every way to bend is near.
        const dvec3 arm = glm::normalize(dvec3(0.76, -0.65, -0.02));
        const dvec3 fore = glm::normalize(dvec3(0.73, -0.67, 0.12));
        elbow = shoulder + 0.285 * arm;
        wrist = elbow + 0.250 * fore;
        hand = wrist + 0.085 * fore;
    }
};

dvec3 mirrored(const dvec3& p, int side) {
    return {side == 0 ? p.x : -p.x, p.y, p.z};
}

/// A bone and about how much flesh it has: what a vertex is near to.
struct SkinBone {
    int joint = 0;
    Limb flesh;
};

class Builder {
  public:
    AvatarRig build();

  private:
    int add_joint(const std::string& name, int parent, const dvec3& at, const dvec3& tip,
                  double radius_m, double wide = 1);
    void add_joints();
    void add_side(int side);
    void skin(MeshAsset& mesh, const std::function<bool(int)>& allowed) const;
    void add_part(const char* name, MeshAsset mesh, std::uint32_t material,
                  const std::function<bool(int)>& allowed);
    std::vector<Limb> body_limbs() const;

    Places at_;
    AvatarRig rig_;
    std::vector<dvec3> joint_m_;
    std::vector<SkinBone> bones_;
    int neck_ = 0, head_ = 0, spine_ = 0, chest_ = 0, hips_ = 0;
    std::array<int, 2> hand_{}, foot_{};
};

int Builder::add_joint(const std::string& name, int parent, const dvec3& at, const dvec3& tip,
                       double radius_m, double wide) {
    MeshJoint joint;
    joint.name = name;
    joint.parent = parent;
    const dvec3 from = parent < 0 ? dvec3(0) : joint_m_[static_cast<std::size_t>(parent)];
    joint.parent_from_joint = glm::translate(glm::mat4(1), glm::vec3(at - from));
    joint.joint_from_bind = glm::translate(glm::mat4(1), glm::vec3(-at));
    const int index = static_cast<int>(rig_.joints.size());
    rig_.joints.push_back(joint);
    joint_m_.push_back(at);
    bones_.push_back({index, {at, tip, radius_m, radius_m, 1, wide}});
    return index;
}

void Builder::add_side(int side) {
    const auto s = static_cast<std::size_t>(side);
    const std::string end = side == 0 ? ".L" : ".R";
    const auto at = [&](const dvec3& p) { return mirrored(p, side); };
    const auto map = [&](Joint left, int joint) {
        rig_.of_joint[static_cast<std::size_t>(left) + 4 * s] = joint;
    };
    const auto part = [](const dvec3& a, const dvec3& b) { return glm::mix(a, b, 0.5); };
    const int collar = add_joint("collar" + end, chest_, at(at_.collar), at(at_.shoulder), 0.05);
    const int arm = add_joint("upper_arm" + end, collar, at(at_.shoulder),
                              at(part(at_.shoulder, at_.elbow)), 0.05);
    const int arm_twist = add_joint("upper_arm_twist" + end, arm, at(part(at_.shoulder, at_.elbow)),
                                    at(at_.elbow), 0.043);
    const int fore = add_joint("forearm" + end, arm_twist, at(at_.elbow), at(at_.wrist), 0.036);
    const int wrist = add_joint("wrist" + end, fore, at(at_.wrist), at(at_.hand), 0.030);
    hand_[s] = add_joint("hand" + end, wrist, at(at_.hand),
                         at(at_.hand + 0.09 * glm::normalize(at_.hand - at_.wrist)), 0.030);
    const int thigh =
        add_joint("thigh" + end, hips_, at(at_.hip), at(part(at_.hip, at_.knee)), 0.082);
    const int thigh_twist =
        add_joint("thigh_twist" + end, thigh, at(part(at_.hip, at_.knee)), at(at_.knee), 0.064);
    const int shin = add_joint("shin" + end, thigh_twist, at(at_.knee), at(at_.ankle), 0.052);
    const int ankle = add_joint("ankle" + end, shin, at(at_.ankle), at(at_.toes), 0.036);
    foot_[s] =
        add_joint("foot" + end, ankle, at(at_.toes), at(at_.toes + dvec3(0, 0, 0.05)), 0.032);
    map(Joint::shoulder_left, arm);
    map(Joint::elbow_left, fore);
    map(Joint::wrist_left, wrist);
    map(Joint::hand_left, hand_[s]);
    map(Joint::hip_left, thigh);
    map(Joint::knee_left, shin);
    map(Joint::ankle_left, ankle);
    map(Joint::foot_left, foot_[s]);
}

void Builder::add_joints() {
    rig_.of_joint.fill(-1);
    const auto map = [&](Joint joint, int index) {
        rig_.of_joint[static_cast<std::size_t>(joint)] = index;
    };
    hips_ = add_joint("hips", -1, at_.hips, at_.spine, 0.108, 1.34);
    spine_ = add_joint("spine", hips_, at_.spine, at_.chest, 0.100, 1.28);
    chest_ = add_joint("chest", spine_, at_.chest, glm::mix(at_.chest, at_.neck, 0.6), 0.104, 1.40);
    neck_ = add_joint("neck", chest_, at_.neck, glm::mix(at_.neck, at_.head, 0.45), 0.050);
    head_ = add_joint("head", neck_, at_.head, at_.head + dvec3(0, 0.06, 0), 0.082);
    map(Joint::hip_center, hips_);
    map(Joint::spine, spine_);
    map(Joint::shoulder_center, neck_);
    map(Joint::head, head_);
    for (int side = 0; side < 2; ++side) add_side(side);
}

/// Up to four bones a vertex by how near their flesh is: weights fall as a power of the distance,
/// so that the middle of a bone is rigid and joints are soft.
void Builder::skin(MeshAsset& mesh, const std::function<bool(int)>& allowed) const {
    for (const glm::vec3& position : mesh.positions) {
        const dvec3 p(position);
        std::vector<std::pair<double, int>> near;
        for (const SkinBone& bone : bones_) {
            if (!allowed(bone.joint)) continue;
            // A limb holds nothing across the middle.
            const double x = 0.5 * (bone.flesh.a.x + bone.flesh.b.x);
            if (x * p.x < 0 && std::abs(x) > 0.01) continue;
            near.emplace_back(limb_distance(bone.flesh, p), bone.joint);
        }
        std::sort(near.begin(), near.end());
        near.resize(std::min<std::size_t>(near.size(), 4));
        std::array<std::uint16_t, 4> joints{};
        glm::dvec4 weights(0);
        // The last one comes in at weight 0, so that nothing jumps where it changes.
        const double floor = near.size() == 4 ? near.back().first : 1e9;
        for (std::size_t k = 0; k < near.size(); ++k) {
            joints[k] = static_cast<std::uint16_t>(near[k].second);
            const double ratio = kSoftM / (near[k].first - near[0].first + kSoftM);
            const double least = kSoftM / (floor - near[0].first + kSoftM);
            weights[static_cast<int>(k)] = std::max(std::pow(ratio, 4) - std::pow(least, 4), 0.0);
        }
        if (!(weights.x > 0)) weights = {1, 0, 0, 0};
        weights /= weights.x + weights.y + weights.z + weights.w;
        mesh.joints.push_back(joints);
        mesh.weights.emplace_back(weights);
    }
}

void Builder::add_part(const char* name, MeshAsset mesh, std::uint32_t material,
                       const std::function<bool(int)>& allowed) {
    mesh.name = name;
    mesh.uvs.clear();
    skin(mesh, allowed);
    rig_.parts.push_back({std::make_shared<const MeshAsset>(std::move(mesh)), material});
}

std::vector<Limb> Builder::body_limbs() const {
    std::vector<Limb> limbs = {{{0, 0.925, -0.004}, {0, 1.00, -0.002}, 0.110, 0.106, 0.92, 1.34},
                               {{0, 1.02, 0.0}, {0, 1.12, 0.004}, 0.098, 0.100, 0.92, 1.28},
                               {{0, 1.18, -0.002}, {0, 1.30, -0.006}, 0.108, 0.104, 0.96, 1.42},
                               {{0, 1.36, -0.014}, {0, 1.51, 0.0}, 0.056, 0.047},
                               {{0, 1.575, 0.010}, {0, 1.655, 0.002}, 0.070, 0.086, 1.10, 0.92},
                               {{0, 1.555, 0.036}, {0, 1.60, 0.036}, 0.046, 0.060, 1.0, 0.95}};
    for (int side = 0; side < 2; ++side) {
        const auto add = [&](const dvec3& a, const dvec3& b, double ra, double rb, double deep = 1,
                             double wide = 1) {
            limbs.push_back({mirrored(a, side), mirrored(b, side), ra, rb, deep, wide});
        };
        const dvec3 fore = at_.wrist - at_.elbow;
        add({0.03, 1.395, -0.014}, at_.shoulder, 0.062, 0.056);
        add({0.075, 1.27, 0.030}, {0.085, 1.32, 0.020}, 0.070, 0.062, 0.8);
        add(at_.shoulder, glm::mix(at_.shoulder, at_.elbow, 0.45), 0.057, 0.049);
        add(glm::mix(at_.shoulder, at_.elbow, 0.45), at_.elbow, 0.049, 0.038);
        add(at_.elbow, at_.elbow + 0.32 * fore, 0.038, 0.043);
        add(at_.elbow + 0.32 * fore, at_.wrist, 0.043, 0.026);
        add(at_.wrist, at_.hand, 0.016, 0.012);
        add({0.080, 0.93, -0.030}, {0.088, 0.88, -0.024}, 0.090, 0.088);
        add(at_.hip, glm::mix(at_.hip, at_.knee, 0.4), 0.088, 0.080);
        add(glm::mix(at_.hip, at_.knee, 0.4), at_.knee, 0.080, 0.054);
        add(at_.knee, glm::mix(at_.knee, at_.ankle, 0.3) - dvec3(0, 0, 0.014), 0.054, 0.058);
        add(glm::mix(at_.knee, at_.ankle, 0.3) - dvec3(0, 0, 0.014), at_.ankle, 0.058, 0.037);
        add(at_.ankle, {0.115, 0.045, 0.02}, 0.036, 0.036);
    }
    return limbs;
}

AvatarRig Builder::build() {
    rig_.name = "mannequin";
    add_joints();
    const auto layer = [](const glm::vec3& reflectance, float roughness) {
        return std::vector<MaterialLayer>{
            {.lobes = {{.kind = LobeKind::ggx, .color = reflectance, .roughness = roughness}},
             .transmission = glm::vec3(0.95f)},
            {.lobes = {{.kind = LobeKind::lambert}}}};
    };
    rig_.materials = {{.name = "skin",
                       .base_color = {0.26f, 0.29f, 0.33f},
                       .layers = layer(glm::vec3(0.04f), 0.45f)},
                      {.name = "shoes",
                       .base_color = {0.60f, 0.16f, 0.03f},
                       .layers = layer(glm::vec3(0.04f), 0.35f)},
                      {.name = "visor",
                       .base_color = {0.02f, 0.022f, 0.03f},
                       .layers = layer(glm::vec3(0.08f), 0.15f)}};

    const std::vector<Limb> limbs = body_limbs();
    const auto body = [&](const dvec3& p) {
        double d = 1e9;
        for (const Limb& limb : limbs) {
            const double one = limb_distance(limb, p);
            // Far ones change nothing.
            d = one < d + 0.06 ? blend_distance(d, one, 0.045) : d;
        }
        return d;
    };
    add_part("body", polygonize(body, {-0.72, 0.0, -0.20}, {0.72, 1.80, 0.20}, 0.031), 1,
             [&](int joint) { return joint != foot_[0] && joint != foot_[1]; });

    const auto both = [](const std::vector<Limb>& left) {
        return [left](dvec3 p) {
            p.x = std::abs(p.x);
            double d = 1e9;
            for (const Limb& limb : left) d = blend_distance(d, limb_distance(limb, p), 0.02);
            return d;
        };
    };
    const std::vector<Limb> shoe = {
        {{0.113, 0.075, -0.014}, {0.114, 0.05, 0.0}, 0.046, 0.044},
        {{0.112, 0.036, -0.040}, {0.116, 0.036, 0.04}, 0.036, 0.036, 1.0, 1.1},
        {{0.116, 0.034, 0.04}, {0.124, 0.026, 0.125}, 0.038, 0.028, 1.0, 1.25}};
    const auto sole = both(shoe);
    add_part("shoes",
             polygonize([&](const dvec3& p) { return std::max(sole(p), -p.y); },
                        {-0.20, -0.02, -0.12}, {0.20, 0.15, 0.18}, 0.022),
             2, [&](int joint) {
                 const std::string& name = rig_.joints[static_cast<std::size_t>(joint)].name;
                 return name.starts_with("ankle") || name.starts_with("foot") ||
                        name.starts_with("shin");
             });

    // Mittens: the palm flat, the thumb forward.
    const dvec3 fore = glm::normalize(at_.hand - at_.wrist);
    const std::vector<Limb> glove = {
        {at_.wrist - 0.018 * fore, at_.wrist + 0.03 * fore, 0.038, 0.036},
        {at_.wrist + 0.035 * fore, at_.hand, 0.033, 0.036},
        {at_.hand, at_.hand + 0.085 * fore, 0.033, 0.020},
        {at_.wrist + 0.03 * fore + dvec3(0, 0, 0.02), at_.hand + 0.018 * fore + dvec3(0, 0, 0.052),
         0.018, 0.012}};
    add_part("gloves", polygonize(both(glove), {-0.76, 0.84, -0.12}, {0.76, 1.12, 0.16}, 0.0185), 2,
             [&](int joint) {
                 const std::string& name = rig_.joints[static_cast<std::size_t>(joint)].name;
                 return name.starts_with("wrist") || name.starts_with("hand") ||
                        name.starts_with("forearm");
             });

    // Goggles round the front of the head.
    const std::vector<Limb> visor = {{{0, 1.634, 0.094}, {0.046, 1.634, 0.080}, 0.023, 0.022},
                                     {{0.046, 1.634, 0.080}, {0.077, 1.634, 0.022}, 0.022, 0.016}};
    add_part("visor", polygonize(both(visor), {-0.12, 1.58, -0.02}, {0.12, 1.69, 0.13}, 0.013), 3,
             [&](int joint) { return joint == head_; });
    return rig_;
}

}  // namespace

AvatarRig make_mannequin() {
    return Builder().build();
}

}  // namespace kino
