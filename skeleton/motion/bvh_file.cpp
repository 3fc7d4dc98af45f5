#include "skeleton/motion/bvh_file.h"

#include <fmt/format.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <iterator>

namespace kino::motion_export {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kCmPerM = 100;
constexpr double kPoleCosine = 1e-7;

double nearest_turn(double angle, double before) {
    return angle + 2 * kPi * std::round((before - angle) / (2 * kPi));
}

glm::dvec3 nearest_turns(const glm::dvec3& angles, const glm::dvec3& before) {
    return {nearest_turn(angles.x, before.x), nearest_turn(angles.y, before.y),
            nearest_turn(angles.z, before.z)};
}

void append_node(std::string& out, const SkeletalMotion& motion, int node, int depth) {
    const std::string indent(static_cast<std::size_t>(depth), '\t');
    const RestNode& rest = rest_nodes()[node];
    const bool root = rest.parent < 0;
    const glm::dvec3 offset = motion.offset_m[node] * kCmPerM;
    auto to = std::back_inserter(out);
    fmt::format_to(to, "{}{} {}\n{}{{\n", indent, root ? "ROOT" : "JOINT", rest.name, indent);
    fmt::format_to(to, "{}\tOFFSET {:.6f} {:.6f} {:.6f}\n", indent, offset.x, offset.y, offset.z);
    fmt::format_to(to, "{}\tCHANNELS {}Zrotation Xrotation Yrotation\n", indent,
                   root ? "6 Xposition Yposition Zposition " : "3 ");
    for (const int child : tree_order()) {
        if (rest_nodes()[child].parent == node) append_node(out, motion, child, depth + 1);
    }
    if (const double tip = tip_m(node); tip > 0) {
        const glm::dvec3 end = rest.direction * tip * kCmPerM;
        fmt::format_to(to, "{}\tEnd Site\n{}\t{{\n{}\t\tOFFSET {:.6f} {:.6f} {:.6f}\n{}\t}}\n",
                       indent, indent, indent, end.x, end.y, end.z, indent);
    }
    fmt::format_to(to, "{}}}\n", indent);
}

}  // namespace

glm::dvec3 euler_zxy(const glm::dquat& rotation, const glm::dvec3& before) {
    const glm::dmat3 m = glm::mat3_cast(rotation);  // m[column][row]
    const double sine = m[1][2];
    const double cosine = std::hypot(m[1][0], m[1][1]);
    if (cosine < kPoleCosine) {
        const double sign = sine < 0 ? -1 : 1;
        const double x = sign * kPi / 2;
        const double sum = std::atan2(m[0][1], m[0][0]);  // z + y at the upper pole, z - y below
        return nearest_turns({x, before.y, sum - sign * before.y}, before);
    }
    const glm::dvec3 one = nearest_turns(
        {std::atan2(sine, cosine), std::atan2(-m[0][2], m[2][2]), std::atan2(-m[1][0], m[1][1])},
        before);
    const glm::dvec3 other = nearest_turns({kPi - one.x, one.y + kPi, one.z + kPi}, before);
    const auto far = [&](const glm::dvec3& a) { return glm::dot(a - before, a - before); };
    return far(other) < far(one) ? other : one;
}

std::string bvh_text(const SkeletalMotion& motion) {
    std::string out = "HIERARCHY\n";
    append_node(out, motion, 0, 0);
    auto to = std::back_inserter(out);
    fmt::format_to(to, "MOTION\nFrames: {}\nFrame Time: {:.9f}\n", motion.poses.size(),
                   1 / motion.rate_hz);
    std::array<glm::dvec3, kNodeCount> angles{};
    for (const SkeletonPose& pose : motion.poses) {
        const glm::dvec3 root = pose.root_m * kCmPerM;
        fmt::format_to(to, "{:.6f} {:.6f} {:.6f}", root.x, root.y, root.z);
        for (const int n : tree_order()) {
            angles[n] = euler_zxy(pose.local[n], angles[n]);
            const glm::dvec3 degrees = angles[n] * (180 / kPi);
            fmt::format_to(to, " {:.6f} {:.6f} {:.6f}", degrees.z, degrees.x, degrees.y);
        }
        out += '\n';
    }
    return out;
}

}  // namespace kino::motion_export
