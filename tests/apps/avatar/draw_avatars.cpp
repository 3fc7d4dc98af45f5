// Draws the avatars in several poses: draw-avatars OUT.png [RIG_OR_FILE...]
#include <fmt/format.h>

#include <algorithm>
#include <glm/gtc/matrix_transform.hpp>
#include <iostream>

#include "apps/avatar/rest_body.h"
#include "people.h"
#include "sensor/png_io.h"
#include "viz/frame/renderer.h"
#include "viz/surface/mesh_shapes.h"

namespace kino {
namespace {

constexpr int kWidth = 250, kHeight = 250;

/// What one picture shows.
struct Picture {
    std::string rig;
    BodyPose pose;
    bool mirror = false;
    SkinBlend skin = SkinBlend::dual_quaternion;
    double twist_rad = 0;  ///< of the left forearm, besides what the person does
    double yaw_rad = 0.25;
    double distance_m = 3.6;
    glm::dvec3 at_m{0, 0.98, 0};
};

BodyPose moving(Motion motion, double t_s) {
    BodyPose pose = pose_at(motion, t_s);
    pose.place_m = glm::dvec3(0);
    pose.yaw_rad = 0;
    return pose;
}

/// Turns everything from the left elbow on about the forearm, as no person could.
void twist(const AvatarRig& rig, double angle_rad, MeshNode& node) {
    const std::vector<glm::dvec3> at = rest_positions(rig);
    const auto elbow = static_cast<std::size_t>(rig.of_joint[index_of(Joint::elbow_left)]);
    const auto wrist = static_cast<std::size_t>(rig.of_joint[index_of(Joint::wrist_left)]);
    const glm::dmat4 turn =
        glm::translate(glm::dmat4(1), at[elbow]) *
        glm::rotate(glm::dmat4(1), angle_rad, glm::normalize(at[wrist] - at[elbow])) *
        glm::translate(glm::dmat4(1), -at[elbow]);
    std::vector<glm::mat4> pose = *node.pose;
    for (std::size_t r = elbow; r < pose.size(); ++r) {
        int above = static_cast<int>(r);
        while (above > static_cast<int>(elbow)) {
            above = rig.joints[static_cast<std::size_t>(above)].parent;
        }
        if (above == static_cast<int>(elbow)) pose[r] = glm::mat4(glm::dmat4(pose[r]) * turn);
    }
    node.pose = std::make_shared<const std::vector<glm::mat4>>(std::move(pose));
}

Result<Image<Rgba8>> draw(Renderer& renderer, const Picture& what) {
    KINO_ASSIGN(const auto rig, open_avatar(what.rig));
    AvatarTroupe troupe(rig, {.mirror = what.mirror, .skin = what.skin});
    BodyFrame frame;
    frame.bodies = {test::body_of(pose_body(what.pose))};
    AvatarMoment moment = test::moment_of(frame, 0.1);
    moment.floor_y_m = 0;
    for (int i = 0; i < 12; ++i) troupe.step(moment);
    Scene scene;
    scene.color_mode = ColorMode::relit;
    scene.ambient = glm::vec3(0.14f, 0.15f, 0.17f);
    scene.materials = {{.base_color = glm::vec3(0.10f, 0.11f, 0.12f)}};
    MeshNode floor;
    floor.id = 1;
    floor.mesh = make_box({30, 0.02f, 30});
    floor.material = 1;
    floor.world_from_object = glm::translate(glm::dmat4(1), {0, -0.01, 0});
    scene.meshes = {floor};
    scene.lights = {{.kind = LightKind::directional,
                     .direction = glm::normalize(glm::dvec3(-0.6, -1, -0.8)),
                     .color = glm::vec3(1.5f, 1.42f, 1.3f),
                     .shadow = what.twist_rad != 0 ? LightShadow::none : LightShadow::raycast},
                    {.kind = LightKind::directional,
                     .direction = glm::normalize(glm::dvec3(1, -0.2, 0.1)),
                     .color = glm::vec3(0.25f, 0.35f, 0.55f)}};
    troupe.fill(scene, 10);
    if (what.twist_rad != 0) {
        for (std::size_t i = 1; i < scene.meshes.size(); ++i) {
            twist(*rig, what.twist_rad, scene.meshes[i]);
        }
    }
    const glm::dvec3 eye = what.at_m + glm::dvec3(what.distance_m * std::sin(what.yaw_rad),
                                                  0.25 * what.distance_m - 0.5,
                                                  what.distance_m * std::cos(what.yaw_rad));
    const View view{.width = kWidth,
                    .height = kHeight,
                    .projection = perspective(0.62, kWidth, kHeight),
                    .world_from_view = look_at(eye, what.at_m)};
    KINO_ASSIGN(const FrameResult result,
                renderer.render_to_image(scene, view, {.read_picture = true}));
    return result.picture;
}

/// A row of poses for each rig; of the mannequin the last two are an arm twisted by 150 degrees
/// in both blends.
Result<void> draw_all(const std::string& out, const std::vector<std::string>& names) {
    KINO_ASSIGN(auto device, gpu::Device::create({}));
    Renderer renderer(*device);
    constexpr int kColumns = 6;
    Image<Rgba8> sheet(kWidth * kColumns, kHeight * static_cast<int>(names.size()));
    for (std::size_t row = 0; row < names.size(); ++row) {
        const std::string& name = names[row];
        KINO_ASSIGN(const auto rig, open_avatar(name));
        std::size_t triangles = 0;
        for (const AvatarPart& part : rig->parts) triangles += part.mesh->indices.size() / 3;
        fmt::print("{}: {} joints, {} parts, {} triangles\n", rig->name, rig->joints.size(),
                   rig->parts.size(), triangles);
        for (const std::string& note : rig->notes) fmt::print("  {}\n", note);
        std::vector<Picture> pictures = {
            {name, moving(Motion::tpose, 4)},
            {name, moving(Motion::wave, 3.4)},
            {.rig = name, .pose = moving(Motion::wave, 3.4), .mirror = true},
            {.rig = name, .pose = moving(Motion::squat, 2.5), .yaw_rad = 0.9}};
        if (name == "mannequin") {
            for (const SkinBlend skin : {SkinBlend::linear, SkinBlend::dual_quaternion}) {
                pictures.push_back({.rig = name,
                                    .pose = moving(Motion::tpose, 4),
                                    .skin = skin,
                                    .twist_rad = 2.6,
                                    .yaw_rad = 0.3,
                                    .distance_m = 1.0,
                                    .at_m = {0.5, 1.36, 0}});
            }
        } else {
            pictures.push_back({name, moving(Motion::raise, 3)});
            pictures.push_back({.rig = name, .pose = moving(Motion::dance, 3), .yaw_rad = -0.5});
        }
        for (std::size_t column = 0; column < pictures.size(); ++column) {
            KINO_ASSIGN(const Image<Rgba8> picture, draw(renderer, pictures[column]));
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
