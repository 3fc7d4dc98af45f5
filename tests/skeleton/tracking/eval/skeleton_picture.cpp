#include "tests/skeleton/tracking/eval/skeleton_picture.h"

#include <algorithm>
#include <cmath>

namespace kino::test {
namespace {

void dot(Image<Rgba8>& out, float x, float y, int radius, const Rgba8& color) {
    for (int dy = -radius; dy <= radius; ++dy) {
        for (int dx = -radius; dx <= radius; ++dx) {
            const int u = static_cast<int>(std::lround(x)) + dx;
            const int v = static_cast<int>(std::lround(y)) + dy;
            if (out.contains(u, v)) out.at(u, v) = color;
        }
    }
}

void draw(Image<Rgba8>& out, const Body& body, const PinholeFit& camera, float scale, bool truth) {
    const auto at = [&](std::size_t j) { return camera.pixel(body.joints[j].position_m) * scale; };
    for (std::size_t j = 0; j < kJointCount; ++j) {
        const JointPosition& joint = body.joints[j];
        const auto parent = static_cast<std::size_t>(kJointParent[j]);
        if (joint.state == JointState::lost || !(joint.position_m.z > 0.2f) ||
            body.joints[parent].state == JointState::lost ||
            !(body.joints[parent].position_m.z > 0.2f)) {
            continue;
        }
        const bool left = (j >= 4 && j < 8) || (j >= 12 && j < 16), middle = j < 4;
        Rgba8 color = truth    ? Rgba8{255, 255, 255, 255}
                      : middle ? Rgba8{255, 210, 40, 255}
                      : left   ? Rgba8{255, 60, 60, 255}
                               : Rgba8{60, 230, 90, 255};
        if (!truth && joint.state == JointState::inferred) {
            color = {static_cast<std::uint8_t>(color.r / 2), static_cast<std::uint8_t>(color.g / 2),
                     static_cast<std::uint8_t>(color.b / 2 + 60), 255};
        }
        const glm::vec2 a = at(parent), b = at(j);
        const int steps = std::clamp(static_cast<int>(std::hypot(b.x - a.x, b.y - a.y)), 1, 800);
        for (int i = 0; i <= steps; ++i) {
            const float t = static_cast<float>(i) / static_cast<float>(steps);
            dot(out, a.x + (b.x - a.x) * t, a.y + (b.y - a.y) * t, 0, color);
        }
        dot(out, b.x, b.y, truth ? 0 : 1, color);
    }
}

}  // namespace

Image<Rgba8> skeleton_picture(const Image<float>& depth_m, const Image<std::uint8_t>& part,
                              const BodyFrame& truth, const BodyFrame& found,
                              const PinholeFit& camera, int width) {
    const float scale = static_cast<float>(width) / static_cast<float>(depth_m.width());
    Image<Rgba8> out(width, static_cast<int>(static_cast<float>(depth_m.height()) * scale));
    for (int y = 0; y < out.height(); ++y) {
        for (int x = 0; x < out.width(); ++x) {
            const int u =
                std::min(static_cast<int>(static_cast<float>(x) / scale), depth_m.width() - 1);
            const int v =
                std::min(static_cast<int>(static_cast<float>(y) / scale), depth_m.height() - 1);
            const float z = depth_m.at(u, v);
            const float grey = z > 0 ? std::clamp(190 - 32 * z, 20.0f, 200.0f) : 0;
            Rgba8 p{static_cast<std::uint8_t>(grey), static_cast<std::uint8_t>(grey),
                    static_cast<std::uint8_t>(grey), 255};
            const std::uint8_t label = part.empty() ? 255 : part.at(u, v);
            if (label < 255) {
                p.r = static_cast<std::uint8_t>(p.r / 2 + (label * 53) % 70);
                p.g = static_cast<std::uint8_t>(p.g / 2 + (label * 97) % 70);
                p.b = static_cast<std::uint8_t>(p.b / 2 + (label * 31) % 90);
            }
            out.at(x, y) = p;
        }
    }
    for (const Body& body : truth.bodies) draw(out, body, camera, scale, true);
    for (const Body& body : found.bodies) draw(out, body, camera, scale, false);
    return out;
}

Image<Rgba8> skeleton_sheet(const std::vector<Image<Rgba8>>& pictures, int columns) {
    if (pictures.empty()) return {};
    const int w = pictures.front().width(), h = pictures.front().height();
    const int rows = (static_cast<int>(pictures.size()) + columns - 1) / columns;
    Image<Rgba8> sheet(columns * (w + 3), rows * (h + 3), Rgba8{70, 70, 70, 255});
    for (std::size_t i = 0; i < pictures.size(); ++i) {
        const int left = static_cast<int>(i) % columns * (w + 3);
        const int top = static_cast<int>(i) / columns * (h + 3);
        for (int y = 0; y < std::min(h, pictures[i].height()); ++y) {
            std::copy_n(pictures[i].row(y), std::min(w, pictures[i].width()),
                        sheet.row(top + y) + left);
        }
    }
    return sheet;
}

}  // namespace kino::test
