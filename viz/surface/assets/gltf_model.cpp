#include "viz/surface/assets/gltf_model.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <iterator>

#include "base/check.h"

namespace kino {
namespace {

glm::dquat quat_of(const glm::dvec4& v) {
    const glm::dquat q(v.w, v.x, v.y, v.z);
    const double length = glm::length(q);
    return length > 0 ? q * (1 / length) : glm::dquat(1, 0, 0, 0);
}

/// glTF 2.0, appendix C.
glm::dvec4 sample(const GltfChannel& channel, double time_s) {
    const bool cubic = channel.interpolation == GltfInterpolation::cubic;
    const auto value = [&](std::size_t key) { return channel.values[cubic ? 3 * key + 1 : key]; };
    const auto& times = channel.times_s;
    // Written so that a time that is not a number takes the first value.
    if (!(time_s > times.front())) return value(0);
    if (time_s >= times.back()) return value(times.size() - 1);
    const auto next = static_cast<std::size_t>(
        std::upper_bound(times.begin(), times.end(), time_s) - times.begin());
    const std::size_t key = next - 1;
    const double span = times[next] - times[key];
    const double t = (time_s - times[key]) / span;
    switch (channel.interpolation) {
        case GltfInterpolation::step:
            return value(key);
        case GltfInterpolation::linear: {
            if (channel.path != GltfPath::rotation) return glm::mix(value(key), value(next), t);
            const glm::dquat q = glm::slerp(quat_of(value(key)), quat_of(value(next)), t);
            return {q.x, q.y, q.z, q.w};
        }
        case GltfInterpolation::cubic:
            break;
    }
    const double t2 = t * t;
    const double t3 = t2 * t;
    const glm::dvec4 out_tangent = channel.values[3 * key + 2] * span;
    const glm::dvec4 in_tangent = channel.values[3 * next] * span;
    return (2 * t3 - 3 * t2 + 1) * value(key) + (t3 - 2 * t2 + t) * out_tangent +
           (-2 * t3 + 3 * t2) * value(next) + (t3 - t2) * in_tangent;
}

}  // namespace

glm::dmat4 GltfPlace::matrix() const {
    glm::dmat4 m = glm::mat4_cast(rotation);
    for (int axis = 0; axis < 3; ++axis) m[axis] *= scale[axis];
    m[3] = glm::dvec4(translation, 1.0);
    return m;
}

int GltfModel::find_animation(const std::string& name) const {
    const auto found = std::find_if(animations.begin(), animations.end(),
                                    [&](const GltfAnimation& a) { return a.name == name; });
    return found == animations.end() ? -1 : static_cast<int>(found - animations.begin());
}

std::vector<glm::dmat4> model_from_nodes(const GltfModel& model, const GltfAnimation* animation,
                                         double time_s) {
    std::vector<GltfPlace> places;
    places.reserve(model.nodes.size());
    for (const GltfNode& node : model.nodes) places.push_back(node.place);
    std::vector<char> moved(model.nodes.size(), 0);
    if (animation != nullptr) {
        for (const GltfChannel& channel : animation->channels) {
            const auto node = static_cast<std::size_t>(channel.node);
            const glm::dvec4 value = sample(channel, time_s);
            moved[node] = 1;
            switch (channel.path) {
                case GltfPath::translation:
                    places[node].translation = glm::dvec3(value);
                    break;
                case GltfPath::rotation:
                    places[node].rotation = quat_of(value);
                    break;
                case GltfPath::scale:
                    places[node].scale = glm::dvec3(value);
                    break;
            }
        }
    }
    std::vector<glm::dmat4> matrices;
    matrices.reserve(model.nodes.size());
    for (std::size_t i = 0; i < model.nodes.size(); ++i) {
        const GltfNode& node = model.nodes[i];
        const glm::dmat4 own = node.matrix && moved[i] == 0 ? *node.matrix : places[i].matrix();
        KINO_CHECK_LT(node.parent, static_cast<int>(i));
        matrices.push_back(node.parent < 0 ? own
                                           : matrices[static_cast<std::size_t>(node.parent)] * own);
    }
    return matrices;
}

double loop_time(const GltfAnimation& animation, double time_s) {
    if (!(animation.duration_s > 0) || !std::isfinite(time_s)) return 0;
    const double t = std::fmod(time_s, animation.duration_s);
    return t < 0 ? t + animation.duration_s : t;
}

std::vector<glm::mat4> pose_of(const GltfSkin& skin, std::span<const glm::dmat4> model_from_node) {
    std::vector<glm::mat4> pose;
    pose.reserve(skin.joints.size());
    for (std::size_t j = 0; j < skin.joints.size(); ++j) {
        pose.emplace_back(model_from_node[static_cast<std::size_t>(skin.nodes[j])] *
                          glm::dmat4(skin.joints[j].joint_from_bind));
    }
    return pose;
}

std::vector<MeshNode> mesh_nodes(const GltfModel& model, const GltfInstance& at) {
    const GltfAnimation* animation =
        at.animation < 0 ? nullptr : &model.animations.at(static_cast<std::size_t>(at.animation));
    const std::vector<glm::dmat4> matrices = model_from_nodes(
        model, animation, animation == nullptr ? 0 : loop_time(*animation, at.time_s));
    std::vector<std::shared_ptr<const std::vector<glm::mat4>>> poses(model.skins.size());
    std::vector<MeshNode> made;
    std::uint32_t id = at.first_id;
    for (std::size_t i = 0; i < model.nodes.size(); ++i) {
        const GltfNode& node = model.nodes[i];
        for (const int index : node.meshes) {
            const GltfMesh& mesh = model.meshes[static_cast<std::size_t>(index)];
            MeshNode out;
            out.id = id++;
            out.mesh = mesh.asset;
            out.material = mesh.material < 0
                               ? 0
                               : at.first_material + static_cast<std::uint32_t>(mesh.material) + 1;
            out.world_from_object = at.world_from_model * matrices[i];
            if (mesh.asset->skinned() && node.skin >= 0) {
                // Joints place a skinned mesh; its node does not.
                out.world_from_object = at.world_from_model;
                auto& pose = poses[static_cast<std::size_t>(node.skin)];
                if (pose == nullptr) {
                    pose = std::make_shared<const std::vector<glm::mat4>>(
                        pose_of(model.skins[static_cast<std::size_t>(node.skin)], matrices));
                }
                out.pose = pose;
            }
            out.previous_world_from_object = out.world_from_object;
            made.push_back(std::move(out));
        }
    }
    return made;
}

}  // namespace kino
