// Draws the avatars in several poses: draw-avatars OUT.png [RIG_OR_FILE...]
#include <fmt/format.h>

#include <algorithm>
#include <glm/gtc/matrix_transform.hpp>
#include <iostream>

#include "people.h"
#include "sensor/png_io.h"
#include "viz/frame/renderer.h"
#include "viz/surface/mesh_shapes.h"

namespace kino {
namespace {

struct Picture {
    Motion motion;
    double t_s;
    bool mirror = false;
};

constexpr int kWidth = 240, kHeight = 300;

Result<Image<Rgba8>> draw(Renderer& renderer, const std::shared_ptr<const AvatarRig>& rig,
                          const Picture& what, SkinBlend skin, double yaw) {
    AvatarTroupe troupe(rig, {.mirror = what.mirror, .skin = skin});
    BodyPose pose = pose_at(what.motion, what.t_s);
    pose.place_m = glm::dvec3(0);
    pose.yaw_rad = 0;
    BodyFrame frame;
    frame.bodies = {test::body_of(pose_body(pose))};
    AvatarMoment moment = test::moment_of(frame, 0.1);
    moment.floor_y_m = 0;
    for (int i = 0; i < 12; ++i) troupe.step(moment);
    Scene scene;
    scene.color_mode = ColorMode::relit;
    scene.ambient = glm::vec3(0.25f);
    scene.materials = {{.base_color = glm::vec3(0.35f)}};
    MeshNode floor;
    floor.id = 1;
    floor.mesh = make_box({3, 0.02f, 3});
    floor.material = 1;
    floor.world_from_object = glm::translate(glm::dmat4(1), {0, -0.01, 0});
    scene.meshes = {floor};
    scene.lights = {{.kind = LightKind::directional,
                     .direction = glm::normalize(glm::dvec3(-0.5, -1, -0.8)),
                     .color = glm::vec3(2.2f)},
                    {.kind = LightKind::directional,
                     .direction = glm::normalize(glm::dvec3(1, -0.2, 0.3)),
                     .color = glm::vec3(0.5f, 0.6f, 0.8f)}};
    troupe.fill(scene, 10);
    const glm::dvec3 eye(3.4 * std::sin(yaw), 1.35, 3.4 * std::cos(yaw));
    const View view{.width = kWidth,
                    .height = kHeight,
                    .projection = perspective(0.62, kWidth, kHeight),
                    .world_from_view = look_at(eye, {0, 0.95, 0})};
    KINO_ASSIGN(const FrameResult result,
                renderer.render_to_image(scene, view, {.read_picture = true}));
    return result.picture;
}

Result<void> draw_all(const std::string& out, const std::vector<std::string>& names) {
    KINO_ASSIGN(auto device, gpu::Device::create({}));
    Renderer renderer(*device);
    const std::vector<Picture> pictures = {
        {Motion::idle, 1},  {Motion::tpose, 4}, {Motion::wave, 3.4},       {Motion::squat, 2.5},
        {Motion::raise, 3}, {Motion::dance, 3}, {Motion::wave, 3.4, true}, {Motion::walk, 2.2}};
    Image<Rgba8> sheet(kWidth * static_cast<int>(pictures.size()),
                       kHeight * static_cast<int>(names.size()));
    for (std::size_t row = 0; row < names.size(); ++row) {
        KINO_ASSIGN(const auto rig, open_avatar(names[row]));
        std::size_t triangles = 0;
        for (const AvatarPart& part : rig->parts) triangles += part.mesh->indices.size() / 3;
        fmt::print("{}: {} joints, {} parts, {} triangles\n", rig->name, rig->joints.size(),
                   rig->parts.size(), triangles);
        for (const std::string& note : rig->notes) fmt::print("  {}\n", note);
        for (std::size_t column = 0; column < pictures.size(); ++column) {
            KINO_ASSIGN(const Image<Rgba8> picture,
                        draw(renderer, rig, pictures[column], SkinBlend::dual_quaternion,
                             column % 4 == 3 ? 0.9 : 0.25));
            for (int y = 0; y < kHeight; ++y) {
                for (int x = 0; x < kWidth; ++x) {
                    sheet.at(static_cast<int>(column) * kWidth + x,
                             static_cast<int>(row) * kHeight + y) = picture.at(x, y);
                }
            }
        }
    }
    return write_png_rgba8(out, sheet);
}

}  // namespace
}  // namespace kino

int main(int count, char** words) {
    if (count < 2) {
        std::cerr << "draw-avatars OUT.png [RIG_OR_FILE...]\n";
        return 2;
    }
    std::vector<std::string> names(words + 2, words + count);
    if (names.empty()) names = {"mannequin", "robot"};
    const auto drawn = kino::draw_all(words[1], names);
    if (!drawn) std::cerr << drawn.error().to_string() << "\n";
    return drawn ? 0 : 1;
}
