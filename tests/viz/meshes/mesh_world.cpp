#include "mesh_world.h"

#include <array>
#include <cmath>
#include <cstring>
#include <glm/gtc/matrix_transform.hpp>
#include <random>

#include "viz/surface/mesh_shapes.h"

namespace kino::test {
namespace {

template <class T>
bool same_bytes(const Image<T>& a, const Image<T>& b) {
    return a.size() == b.size() &&
           std::memcmp(a.pixels().data(), b.pixels().data(), a.size() * sizeof(T)) == 0;
}

}  // namespace

bool same(const MeshPicture& a, const MeshPicture& b) {
    return same_bytes(a.albedo, b.albedo) && same_bytes(a.view_z_m, b.view_z_m) &&
           same_bytes(a.normal, b.normal) && same_bytes(a.id, b.id) &&
           same_bytes(a.object, b.object);
}

glm::dvec3 unpack_normal(std::uint32_t bits) {
    const auto part = [](std::uint32_t v) {
        return std::max(static_cast<std::int16_t>(v & 0xFFFFu) / 32767.0, -1.0);
    };
    glm::dvec3 n(part(bits), part(bits >> 16), 0);
    n.z = 1 - std::abs(n.x) - std::abs(n.y);
    const double fold = std::max(-n.z, 0.0);
    n.x += n.x >= 0 ? -fold : fold;
    n.y += n.y >= 0 ? -fold : fold;
    return glm::normalize(n);
}

MeshWorld::MeshWorld(gpu::Device& device)
    : drawer(device), pipelines(device), executor(device, pipelines), device_(device) {}

MeshPicture MeshWorld::draw(const Scene& scene, const View& view, const MeshListOptions& options,
                            float behind_m) {
    const auto uploaded = drawer.upload(scene);
    EXPECT_TRUE(uploaded) << (uploaded ? "" : uploaded.error().to_string());
    return draw_list(
        view, [&](graph::FrameGraph& graph) { return drawer.prepare(graph, scene, view, options); },
        behind_m);
}

MeshPicture MeshWorld::draw_list(const View& view,
                                 const std::function<MeshList(graph::FrameGraph&)>& make,
                                 float behind_m) {
    const auto width = static_cast<std::uint32_t>(view.width);
    const auto height = static_cast<std::uint32_t>(view.height);
    graph::FrameGraph graph(executor.history());
    SurfaceTargets targets{
        .albedo = graph.create_texture("albedo", {width, height, VK_FORMAT_R8G8B8A8_UNORM}),
        .view_z = graph.create_texture("view depth", {width, height, kViewZFormat}),
        .normal = graph.create_texture("normal", {width, height, kNormalFormat}),
        .id = graph.create_texture("id", {width, height, kIdFormat}),
        .object = graph.create_texture("object", {width, height, kObjectFormat})};
    graph::TextureId depth = graph.create_texture("depth", {width, height, kDepthFormat});
    const std::array<graph::TextureId*, 5> all = {&targets.albedo, &targets.view_z, &targets.normal,
                                                  &targets.id, &targets.object};
    graph.add_pass(
        "test/clear", "test",
        [&](graph::PassBuilder& b) {
            for (graph::TextureId* id : all) *id = b.write(*id, graph::Use::color_attachment);
        },
        [targets, behind_m, width, height](graph::PassContext& c) {
            std::vector<gpu::Target> colors;
            for (const graph::TextureId id :
                 {targets.albedo, targets.view_z, targets.normal, targets.id, targets.object}) {
                colors.push_back({.view = c.view(id), .clear = true});
            }
            colors[1].clear_value.color.float32[0] = behind_m;
            colors[3].clear_value.color.uint32[0] = UINT32_MAX;
            c.commands().begin_rendering({width, height}, colors, nullptr);
            c.commands().end_rendering();
        });
    depth = add_depth_seed(graph, view, targets.view_z, depth);
    const MeshList list = make(graph);
    const MeshDrawer::Drawn drawn = drawer.add(graph, list, targets, depth);
    targets = drawn.targets;

    std::array<gpu::Buffer, 8> readback;
    const auto read = [&](std::size_t slot, const char* name, graph::TextureId id, bool is_depth) {
        auto buffer = gpu::Buffer::create(device_, name, std::uint64_t{width} * height * 4,
                                          gpu::MemoryUse::readback);
        EXPECT_TRUE(buffer);
        readback[slot] = std::move(*buffer);
        graph::BufferId host = graph.import_buffer(name, readback[slot]);
        graph.add_pass(
            name, "test",
            [&](graph::PassBuilder& b) {
                b.read(id, graph::Use::transfer_read);
                host = b.write(host, graph::Use::transfer_write);
            },
            [=](graph::PassContext& c) {
                const VkBufferImageCopy region{
                    .imageSubresource = {.aspectMask = static_cast<VkImageAspectFlags>(
                                             is_depth ? VK_IMAGE_ASPECT_DEPTH_BIT
                                                      : VK_IMAGE_ASPECT_COLOR_BIT),
                                         .layerCount = 1},
                    .imageExtent = {width, height, 1}};
                vkCmdCopyImageToBuffer(c.commands().handle(), c.image(id), VK_IMAGE_LAYOUT_GENERAL,
                                       c.buffer(host), 1, &region);
            });
        graph.require(host);
    };
    read(0, "read albedo", targets.albedo, false);
    read(1, "read view depth", targets.view_z, false);
    read(2, "read normal", targets.normal, false);
    read(3, "read id", targets.id, false);
    read(4, "read object", targets.object, false);
    read(5, "read depth", drawn.depth, true);
    const auto copy_buffer = [&](std::size_t slot, const char* name, graph::BufferId from) {
        const std::uint64_t bytes = graph.resources()[from.index].buffer.bytes;
        auto buffer = gpu::Buffer::create(device_, name, bytes, gpu::MemoryUse::readback);
        EXPECT_TRUE(buffer);
        readback[slot] = std::move(*buffer);
        graph::BufferId host = graph.import_buffer(name, readback[slot]);
        graph.add_pass(
            name, "test",
            [&](graph::PassBuilder& b) {
                b.read(from, graph::Use::transfer_read);
                host = b.write(host, graph::Use::transfer_write);
            },
            [=](graph::PassContext& c) {
                const VkBufferCopy region{.size = bytes};
                vkCmdCopyBuffer(c.commands().handle(), c.buffer(from), c.buffer(host), 1, &region);
            });
        graph.require(host);
    };
    if (list.counters.valid()) {
        copy_buffer(6, "read counters", list.counters);
        copy_buffer(7, "read commands", list.commands);
    }
    MeshPicture picture;
    auto report = executor.run(graph, graph::Timing::frame);
    EXPECT_TRUE(report) << (report ? "" : report.error().to_string());
    if (!report) return picture;
    picture.report = *report;
    const auto copy = [&](std::size_t slot, auto& image) {
        image.resize(view.width, view.height);
        std::memcpy(image.data(), readback[slot].mapped(), image.size() * 4);
    };
    copy(0, picture.albedo);
    copy(1, picture.view_z_m);
    copy(2, picture.normal);
    copy(3, picture.id);
    copy(4, picture.object);
    copy(5, picture.depth);
    if (!readback[6].empty()) {
        picture.counters = readback[6].read<shared::MeshCounters>().front();
        const auto commands = readback[7].read<VkDrawIndexedIndirectCommand>();
        picture.commands.assign(commands.begin(), commands.end());
    }
    return picture;
}

View view_from(const glm::dvec3& eye, const glm::dvec3& target, int width, int height) {
    return {.width = width,
            .height = height,
            .projection = perspective(1.0, width, height),
            .world_from_view = look_at(eye, target)};
}

MeshNode node_of(std::shared_ptr<const MeshAsset> mesh, std::uint32_t id,
                 const glm::dmat4& world_from_object, std::uint32_t material) {
    MeshNode node;
    node.id = id;
    node.mesh = std::move(mesh);
    node.world_from_object = world_from_object;
    node.previous_world_from_object = world_from_object;
    node.material = material;
    return node;
}

Scene mixed_scene(int nodes, unsigned seed) {
    std::mt19937 random(seed);
    const auto uniform = [&](double low, double high) {
        return low + (high - low) * (static_cast<double>(random()) / 4294967296.0);
    };
    const std::array shapes = {make_box({0.4f, 0.6f, 0.3f}), make_sphere(0.3f, 12, 6),
                               make_cone(0.3f, 0.6f, 9), make_torus(0.3f, 0.1f, 9, 6),
                               make_cylinder(0.2f, 0.5f, 8)};
    Scene scene;
    scene.materials = {{.name = "red", .base_color = {0.8f, 0.1f, 0.05f}},
                       {.name = "green", .base_color = {0.1f, 0.6f, 0.2f}},
                       {.name = "blue", .base_color = {0.1f, 0.2f, 0.9f}}};
    for (int i = 0; i < nodes; ++i) {
        glm::dmat4 m =
            glm::translate(glm::dmat4(1.0), {uniform(-6, 6), uniform(-4, 4), uniform(-9, 2)});
        m = glm::rotate(m, uniform(0, 6.28),
                        glm::normalize(glm::dvec3(uniform(-1, 1), uniform(-1, 1), 1.1)));
        glm::dvec3 size(uniform(0.3, 2), uniform(0.3, 2), uniform(0.3, 2));
        if (i % 5 == 0) size.x = -size.x;
        m = glm::scale(m, size);
        scene.meshes.push_back(node_of(shapes[static_cast<std::size_t>(i) % shapes.size()],
                                       static_cast<std::uint32_t>(i + 1), m,
                                       static_cast<std::uint32_t>(i % 4)));
    }
    return scene;
}

}  // namespace kino::test
