#include "viz/effects/skeleton/skeleton.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace kino {
namespace {

using graph::PassBuilder;
using graph::PassContext;
using graph::Use;

constexpr std::uint32_t kVertex[] = {
#include "skeleton_vert.inc"
};
constexpr std::uint32_t kFragment[] = {
#include "skeleton_frag.inc"
};

constexpr float kJointRadius = 0.028f;  // metres
constexpr float kBoneRadius = 0.014f;
/// More bodies than any sensor tracks; a hostile session must not exhaust the frame's memory.
constexpr std::size_t kMostBodies = 32;

bool usable(const JointPosition& joint) {
    return joint.state != JointState::lost && std::isfinite(joint.position_m.x) &&
           std::isfinite(joint.position_m.y) && std::isfinite(joint.position_m.z);
}

}  // namespace

glm::vec3 person_color(std::uint32_t id) {
    constexpr std::array<glm::vec3, 6> kColors = {{{0.20f, 0.85f, 0.95f},
                                                   {1.00f, 0.62f, 0.18f},
                                                   {0.55f, 0.90f, 0.35f},
                                                   {0.95f, 0.40f, 0.65f},
                                                   {0.98f, 0.88f, 0.30f},
                                                   {0.66f, 0.55f, 0.98f}}};
    return kColors[id % kColors.size()];
}

std::optional<SkeletonRequest> skeleton_wanted(const Scene& scene, const View& view) {
    SkeletonRequest request;
    const Pose view_from_world = inverse(view.world_from_view);
    const auto near = static_cast<float>(view.projection.near_m);
    for (std::size_t i = 0; i < std::min(scene.bodies.size(), kMostBodies); ++i) {
        const BodyNode& node = scene.bodies[i];
        const Pose view_from_depth = view_from_world * node.world_from_depth;
        const auto place = [&](const JointPosition& joint) {
            return glm::vec3(view_from_depth * glm::dvec3(joint.position_m));
        };
        for (std::size_t j = 0; j < kJointCount; ++j) {
            const JointPosition& joint = node.body.joints[j];
            const JointPosition& parent = node.body[kJointParent[j]];
            if (!usable(joint) || !(place(joint).z > near)) continue;
            const bool inferred = joint.state == JointState::inferred;
            const glm::vec3 color = person_color(node.id) * (inferred ? 0.8f : 1.0f);
            request.capsules.push_back({.a = place(joint),
                                        .radius_a = kJointRadius * (inferred ? 0.7f : 1.0f),
                                        .b = place(joint),
                                        .radius_b = kJointRadius * (inferred ? 0.7f : 1.0f),
                                        .color = color,
                                        .dashed = 0});
            if (j == 0 || !usable(parent) || !(place(parent).z > near)) continue;
            const bool dashed = inferred || parent.state == JointState::inferred;
            request.capsules.push_back({.a = place(parent),
                                        .radius_a = kBoneRadius,
                                        .b = place(joint),
                                        .radius_b = kBoneRadius,
                                        .color = color * 0.9f,
                                        .dashed = dashed ? 1.0f : 0.0f});
        }
    }
    if (request.capsules.empty()) return std::nullopt;
    return request;
}

graph::TextureId add_skeleton(graph::FrameGraph& graph, const View& view, graph::TextureId target,
                              graph::TextureId view_z, const SkeletonRequest& request) {
    const Projection& k = view.projection;
    const shared::SkeletonParams params{.k = {k.fx, k.fy, k.cx, k.cy},
                                        .target = {view.width, view.height},
                                        .near_m = static_cast<float>(k.near_m),
                                        .dimmed = 0.45f};
    const auto execute = [=](PassContext& c) {
        gpu::PipelineDesc desc;
        desc.name = "skeleton/draw";
        desc.vertex = kVertex;
        desc.fragment = kFragment;
        desc.bindings = {gpu::Binding::storage, gpu::Binding::texture};
        desc.push_bytes = sizeof(params);
        desc.color_formats = {c.desc(target).format};
        desc.blend = gpu::Blend::alpha;
        const std::array<gpu::Target, 1> targets = {{{.view = c.view(target)}}};
        c.commands().begin_rendering({c.desc(target).width, c.desc(target).height}, targets,
                                     nullptr);
        if (c.bind(desc, {c.upload(request.capsules), c.bound(view_z)})) {
            c.commands().constants(params);
            c.commands().draw(6, static_cast<std::uint32_t>(request.capsules.size()));
        }
        c.commands().end_rendering();
    };
    graph.add_pass(
        "skeleton/draw", "skeleton",
        [&](PassBuilder& b) {
            b.read(view_z, Use::fragment_read);
            target = b.write(target, Use::color_attachment);
        },
        execute);
    return target;
}

}  // namespace kino
