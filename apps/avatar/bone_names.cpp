#include "apps/avatar/bone_names.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <glm/geometric.hpp>
#include <optional>
#include <string_view>

namespace kino {
namespace {

enum class Side : std::uint8_t { middle, left, right };

struct PlainName {
    std::string text;  ///< small letters and digits
    Side side = Side::middle;
};

bool take_front(std::string& text, std::string_view front) {
    if (!text.starts_with(front)) return false;
    text.erase(0, front.size());
    return true;
}

/// "mixamorig:LeftForeArm", "forearm.L", "J_Bip_L_LowerArm", "DEF-forearm.L.001" and their like,
/// without prefix, side and punctuation.
PlainName plain_name(const std::string& name) {
    PlainName plain;
    std::vector<std::string> words;
    bool was_small = false;
    for (const char c : name) {
        const auto u = static_cast<unsigned char>(c);
        if (std::isalnum(u) == 0) {
            words.emplace_back();
            was_small = false;
            continue;
        }
        const bool capital = std::isupper(u) != 0;
        if (words.empty() || (capital && was_small)) words.emplace_back();
        was_small = std::islower(u) != 0;
        words.back() += static_cast<char>(std::tolower(u));
    }
    std::erase(words, "");
    for (std::string& word : words) {
        take_front(word, "mixamorig");
        // "lefthand", but not "leftover".
        if (word == "l" || word == "left") {
            plain.side = Side::left;
            continue;
        }
        if (word == "r" || word == "right") {
            plain.side = Side::right;
            continue;
        }
        for (const auto& [mark, side] :
             {std::pair{"left", Side::left}, std::pair{"right", Side::right}}) {
            if (word.starts_with(mark) && word.size() > std::string_view(mark).size()) {
                word.erase(0, std::string_view(mark).size());
                plain.side = side;
            }
        }
        if (word == "def" || word == "org" || word == "j" || word == "bip" || word == "c" ||
            word == "skeleton" || word == "armature" || word == "joint" || word == "bone" ||
            word == "b" || word == "jnt" || word == "bip001" || word == "bip01") {
            continue;
        }
        plain.text += word;
    }
    return plain;
}

struct Wanted {
    Joint joint;
    /// In the order of preference; digits behind a name count as its own.
    std::vector<std::string_view> names;
};

const std::vector<Wanted>& wanted_names() {
    // Of the limbs, the left joints; the right ones are called alike.
    static const std::vector<Wanted> kWanted = {
        {Joint::hip_center, {"hips", "hip", "pelvis", "torso1", "root", "hipscenter"}},
        {Joint::shoulder_center, {"neck", "neck1", "neck01", "spine004", "neckjoint1"}},
        {Joint::head, {"head", "neck2", "spine006", "head01"}},
        {Joint::shoulder_left,
         {"upperarm", "upperarm01", "uparm", "arm", "arm1", "arm4", "upperarm1", "shoulder"}},
        {Joint::elbow_left, {"forearm", "lowerarm", "lowerarm01", "elbow", "arm2", "arm5"}},
        {Joint::wrist_left, {"hand", "wrist", "arm3", "arm6", "palm2", "palm"}},
        {Joint::hand_left,
         {"handmiddle1", "middle1", "middle01", "middleproximal", "fmiddle01", "finger31",
          "metacarpal2", "handindex1", "index1", "index01", "hand1"}},
        {Joint::hip_left,
         {"upleg", "thigh", "upperleg", "upperleg01", "femur", "leg1", "hipjoint"}},
        {Joint::knee_left, {"lowerleg", "lowerleg01", "calf", "shin", "knee", "leg", "leg2"}},
        {Joint::ankle_left, {"foot", "ankle", "leg3"}},
        {Joint::foot_left, {"toebase", "toes", "toe", "ball", "toe0", "toe11", "leg5", "foot1"}}};
    return kWanted;
}

std::vector<int> depths_of(std::span<const FileBone> bones) {
    std::vector<int> depth(bones.size(), 0);
    for (std::size_t i = 0; i < bones.size(); ++i) {
        int steps = 0;
        for (int b = bones[i].parent; b >= 0 && steps <= static_cast<int>(bones.size());
             b = bones[static_cast<std::size_t>(b)].parent) {
            ++steps;
        }
        depth[i] = steps;
    }
    return depth;
}

/// From `bone` up to the root, itself first.
std::vector<int> way_up(std::span<const FileBone> bones, int bone) {
    std::vector<int> way;
    while (bone >= 0 && way.size() <= bones.size()) {
        way.push_back(bone);
        bone = bones[static_cast<std::size_t>(bone)].parent;
    }
    return way;
}

int common_ancestor(std::span<const FileBone> bones, int a, int b) {
    const std::vector<int> up = way_up(bones, a);
    for (const int bone : way_up(bones, b)) {
        if (std::find(up.begin(), up.end(), bone) != up.end()) return bone;
    }
    return -1;
}

using Map = std::array<int, kJointCount>;

int& of(Map& map, Joint left, int side = 0) {
    return map[static_cast<std::size_t>(left) + 4 * static_cast<std::size_t>(side)];
}

Map by_names(std::span<const FileBone> bones) {
    Map map;
    map.fill(-1);
    const std::vector<int> depth = depths_of(bones);
    std::vector<PlainName> plain;
    for (const FileBone& bone : bones) plain.push_back(plain_name(bone.name));
    for (const Wanted& wanted : wanted_names()) {
        const bool sided = wanted.joint >= Joint::shoulder_left;
        for (int side = 0; side < (sided ? 2 : 1); ++side) {
            const Side mark = !sided ? Side::middle : (side == 0 ? Side::left : Side::right);
            for (const std::string_view name : wanted.names) {
                int found = -1;
                for (std::size_t b = 0; b < bones.size(); ++b) {
                    if (plain[b].side != mark || plain[b].text != name) continue;
                    if (found < 0 || depth[b] < depth[static_cast<std::size_t>(found)]) {
                        found = static_cast<int>(b);
                    }
                }
                if (found < 0) continue;
                of(map, wanted.joint, side) = found;
                break;
            }
        }
    }
    return map;
}

/// Legs are the ways to the two lowest ends, arms those to the two widest, the head the highest.
std::optional<Map> by_shape(std::span<const FileBone> bones) {
    std::vector<char> parent(bones.size(), 0);
    for (const FileBone& bone : bones) {
        if (bone.parent >= 0) parent[static_cast<std::size_t>(bone.parent)] = 1;
    }
    std::vector<int> ends;
    for (std::size_t b = 0; b < bones.size(); ++b) {
        if (parent[b] == 0) ends.push_back(static_cast<int>(b));
    }
    if (ends.size() < 5) return std::nullopt;
    const auto at = [&](int b) { return bones[static_cast<std::size_t>(b)].at; };
    const auto take = [&](const auto& before) {
        const auto best = std::min_element(ends.begin(), ends.end(), before);
        const int bone = *best;
        ends.erase(best);
        return bone;
    };
    const int head = take([&](int a, int b) { return at(a).y > at(b).y; });
    const int foot_a = take([&](int a, int b) { return at(a).y < at(b).y; });
    const int foot_b = take([&](int a, int b) { return at(a).y < at(b).y; });
    // Whichever level axis the feet are apart along is the one the arms reach along.
    const glm::dvec3 apart = glm::abs(at(foot_a) - at(foot_b));
    const int axis = apart.x >= apart.z ? 0 : 2;
    const double middle = 0.5 * (at(foot_a)[axis] + at(foot_b)[axis]);
    const auto aside = [&](int b) { return at(b)[axis] - middle; };
    const int arm_a = take([&](int a, int b) { return aside(a) > aside(b); });
    const int arm_b = take([&](int a, int b) { return aside(a) < aside(b); });
    const int hips = common_ancestor(bones, foot_a, foot_b);
    const int chest = common_ancestor(bones, arm_a, arm_b);
    if (hips < 0 || chest < 0 || hips == chest) return std::nullopt;
    const std::vector<int> trunk = way_up(bones, chest);
    if (std::find(trunk.begin(), trunk.end(), hips) == trunk.end()) return std::nullopt;

    Map map;
    map.fill(-1);
    of(map, Joint::hip_center) = hips;
    const auto down = [&](int end, int from) {
        std::vector<int> way;
        for (const int b : way_up(bones, end)) {
            if (b == from) break;
            way.insert(way.begin(), b);
        }
        return way;
    };
    const std::vector<int> neck = down(head, chest);
    if (!neck.empty()) of(map, Joint::head) = neck.back();
    if (neck.size() > 1) of(map, Joint::shoulder_center) = neck.front();
    // glTF has y up; a rig faces +z mostly, so its left has the larger x; seen along x, the smaller
    // z.
    const bool a_left = (aside(foot_a) > aside(foot_b)) == (axis == 0);
    const bool arm_left = (aside(arm_a) > aside(arm_b)) == (axis == 0);
    for (int side = 0; side < 2; ++side) {
        const std::vector<int> leg = down((side == 0) == a_left ? foot_a : foot_b, hips);
        if (leg.size() < 3) return std::nullopt;
        for (std::size_t i = 0; i < 4 && i < leg.size(); ++i) {
            of(map, static_cast<Joint>(static_cast<std::size_t>(Joint::hip_left) + i), side) =
                leg[i];
        }
        std::vector<int> arm = down((side == 0) == arm_left ? arm_a : arm_b, chest);
        if (arm.size() < 3) return std::nullopt;
        // A short first bone is the collar's.
        if (arm.size() > 3 &&
            glm::length(at(arm[1]) - at(arm[0])) < 0.75 * glm::length(at(arm[2]) - at(arm[1]))) {
            arm.erase(arm.begin());
        }
        for (std::size_t i = 0; i < 3; ++i) {
            of(map, static_cast<Joint>(static_cast<std::size_t>(Joint::shoulder_left) + i), side) =
                arm[i];
        }
    }
    return map;
}

/// Of the bones between hips and neck, the one nearest to where a spine's joint is.
int find_spine(std::span<const FileBone> bones, Map& map) {
    const int hips = of(map, Joint::hip_center);
    int top = of(map, Joint::shoulder_center);
    const int chest =
        common_ancestor(bones, of(map, Joint::shoulder_left), of(map, Joint::shoulder_left, 1));
    if (top < 0) top = of(map, Joint::head);
    if (top < 0) top = chest;
    const auto at = [&](int b) { return bones[static_cast<std::size_t>(b)].at; };
    const double all = glm::length(at(top) - at(hips));
    int best = -1;
    double nearest = 1e300;
    const std::vector<int> up =
        way_up(bones, top == chest ? top : bones[static_cast<std::size_t>(top)].parent);
    if (std::find(up.begin(), up.end(), hips) == up.end()) {
        // The neck hangs elsewhere; take the way to the shoulders.
        const std::vector<int> other = way_up(bones, chest);
        if (std::find(other.begin(), other.end(), hips) == other.end()) return -1;
        return other.front() == hips ? -1 : other.front();
    }
    for (const int b : up) {
        if (b == hips) break;
        const double off = std::abs(glm::length(at(b) - at(hips)) - 0.28 * all);
        if (off < nearest) {
            nearest = off;
            best = b;
        }
    }
    return best;
}

std::string missing_in(Map& map) {
    if (of(map, Joint::hip_center) < 0) return "hips";
    for (int side = 0; side < 2; ++side) {
        const char* name = side == 0 ? "left" : "right";
        if (of(map, Joint::shoulder_left, side) < 0 || of(map, Joint::elbow_left, side) < 0) {
            return fmt::format("the {} arm", name);
        }
        if (of(map, Joint::hip_left, side) < 0 || of(map, Joint::knee_left, side) < 0) {
            return fmt::format("the {} leg", name);
        }
    }
    return {};
}

}  // namespace

Result<Map> recognize_bones(std::span<const FileBone> bones, const std::string& where,
                            std::vector<std::string>& notes) {
    Map map = by_names(bones);
    std::string missing = missing_in(map);
    if (!missing.empty()) {
        if (std::optional<Map> shaped = by_shape(bones)) {
            notes.push_back("bones are told by their places: their names say too little");
            map = *shaped;
            missing = missing_in(map);
        }
    }
    const char* hint = "name the bones as Mixamo, VRM, Blender or makehuman do";
    if (!missing.empty()) return fail("no bones for " + missing, where, hint);
    of(map, Joint::spine) = find_spine(bones, map);
    if (of(map, Joint::spine) < 0) return fail("no bone for the spine", where, hint);
    std::vector<int> sorted;
    for (std::size_t j = 0; j < kJointCount; ++j) {
        if (map[j] >= 0) {
            sorted.push_back(map[j]);
        } else {
            notes.push_back(fmt::format("no bone for {}: it moves with the one before",
                                        joint_name(static_cast<Joint>(j))));
        }
    }
    std::sort(sorted.begin(), sorted.end());
    if (std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end()) {
        return fail("one bone stands for two joints", where, hint);
    }
    return map;
}

}  // namespace kino
