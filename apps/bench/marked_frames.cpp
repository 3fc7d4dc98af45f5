#include "apps/bench/marked_frames.h"

#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "sensor/png_io.h"

namespace kino {
namespace {

using enum CoarsePart;

struct Meaning {
    Joint joint;
    CoarsePartSet right;
};

CoarsePartSet set_of(std::initializer_list<CoarsePart> parts) {
    CoarsePartSet set = 0;
    for (const CoarsePart p : parts) set = static_cast<CoarsePartSet>(set | coarse_set(p));
    return set;
}

// The person faces the sensor and the picture is not mirrored: the picture's left is their right.
const std::map<std::string, Meaning>& meanings() {
    static const std::map<std::string, Meaning> all = {
        {"head", {Joint::head, set_of({head})}},
        {"neck", {Joint::shoulder_center, set_of({head, torso})}},
        {"torso", {Joint::spine, set_of({torso})}},
        {"il_shoulder", {Joint::shoulder_right, set_of({upper_arm_right, torso})}},
        {"ir_shoulder", {Joint::shoulder_left, set_of({upper_arm_left, torso})}},
        {"il_elbow", {Joint::elbow_right, set_of({upper_arm_right, lower_arm_right})}},
        {"ir_elbow", {Joint::elbow_left, set_of({upper_arm_left, lower_arm_left})}},
        {"il_hand", {Joint::hand_right, set_of({lower_arm_right, hand_right})}},
        {"ir_hand", {Joint::hand_left, set_of({lower_arm_left, hand_left})}},
    };
    return all;
}

std::optional<int> depth_near(const Image<std::uint16_t>& depth, double x, double y) {
    std::vector<int> found;
    for (int dy = -4; dy <= 4; ++dy)
        for (int dx = -4; dx <= 4; ++dx) {
            const int px = static_cast<int>(x) + dx, py = static_cast<int>(y) + dy;
            if (px < 0 || py < 0 || px >= depth.width() || py >= depth.height()) continue;
            if (depth.at(px, py) > 0) found.push_back(depth.at(px, py));
        }
    if (found.empty()) return std::nullopt;
    std::nth_element(found.begin(), found.begin() + static_cast<std::ptrdiff_t>(found.size() / 2),
                     found.end());
    return found[found.size() / 2];
}

void find_body(MarkedFrame& frame) {
    frame.body.resize(frame.depth_mm.width(), frame.depth_mm.height());
    frame.body.fill(0);
    std::vector<int> depths;
    for (const MarkedJoint& j : frame.joints)
        if (j.name == "torso" || j.name == "neck" || j.name == "head")
            if (const auto z = depth_near(frame.depth_mm, j.x, j.y)) depths.push_back(*z);
    if (depths.empty()) return;
    std::sort(depths.begin(), depths.end());
    const int torso = depths[depths.size() / 2];
    const auto fits = [&](int x, int y) {
        const int z = frame.depth_mm.at(x, y);
        return z > 0 && z > torso - 900 && z < torso + 400;
    };
    std::vector<std::pair<int, int>> queue;
    const auto reach = [&](int x, int y) {
        if (x < 0 || y < 0 || x >= frame.body.width() || y >= frame.body.height()) return;
        if (frame.body.at(x, y) != 0 || !fits(x, y)) return;
        frame.body.at(x, y) = 1;
        queue.emplace_back(x, y);
    };
    for (const MarkedJoint& j : frame.joints) reach(static_cast<int>(j.x), static_cast<int>(j.y));
    while (!queue.empty()) {
        const auto [x, y] = queue.back();
        queue.pop_back();
        const int z = frame.depth_mm.at(x, y);
        constexpr std::array<std::pair<int, int>, 4> kBeside = {{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}};
        for (const auto& [dx, dy] : kBeside) {
            const int nx = x + dx, ny = y + dy;
            if (nx < 0 || ny < 0 || nx >= frame.body.width() || ny >= frame.body.height()) continue;
            if (std::abs(frame.depth_mm.at(nx, ny) - z) <= 60) reach(nx, ny);
        }
    }
}

}  // namespace

Result<std::vector<MarkedFrame>> read_marked_frames(const std::filesystem::path& folder) {
    const std::filesystem::path list = folder / "joints2d.json";
    std::ifstream stream(list);
    if (!stream) return fail("cannot be read", list.string());
    const auto json = nlohmann::json::parse(stream, nullptr, false);
    if (!json.is_object()) return fail("is not a JSON object", list.string());
    std::vector<MarkedFrame> frames;
    for (const auto& [name, people] : json.items()) {
        if (name.starts_with('_') || !people.is_array() || people.empty()) continue;
        MarkedFrame frame;
        frame.name = folder.filename().string() + "/" + name;
        std::filesystem::path picture = folder / name;
        if (!std::filesystem::exists(picture)) picture = folder / "depth_mm" / name;
        KINO_ASSIGN(frame.depth_mm, read_png_gray16(picture));
        for (const auto& [joint, at] : people[0].items()) {
            const auto meaning = meanings().find(joint);
            if (meaning == meanings().end() || !at.is_array() || at.size() != 2) continue;
            frame.joints.push_back({joint, meaning->second.joint, at[0].get<double>(),
                                    at[1].get<double>(), meaning->second.right});
        }
        find_body(frame);
        frames.push_back(std::move(frame));
    }
    if (frames.empty()) return fail("names no frames", list.string());
    return frames;
}

}  // namespace kino
