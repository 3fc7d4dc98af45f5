#include "tests/viz/lights/light_rig.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <glm/gtc/packing.hpp>
#include <glm/packing.hpp>

#include "tests/viz/host_copies.h"
#include "viz/light/light_passes.h"

namespace kino::test {
namespace {

using graph::BufferId;
using graph::FrameGraph;
using graph::TextureId;
using graph::Use;

std::uint32_t packed_normal(const glm::vec3& n) {
    const glm::vec2 o = glm::vec2(n) / (std::abs(n.x) + std::abs(n.y) + std::abs(n.z));
    glm::vec2 out = o;
    if (n.z < 0) {
        out.x = (1 - std::abs(o.y)) * (o.x >= 0 ? 1.0f : -1.0f);
        out.y = (1 - std::abs(o.x)) * (o.y >= 0 ? 1.0f : -1.0f);
    }
    return glm::packSnorm2x16(out);
}

template <class T>
std::vector<T> copy_of(const gpu::Buffer& buffer, std::size_t count) {
    std::vector<T> values(count);
    std::memcpy(values.data(), buffer.mapped(), count * sizeof(T));
    return values;
}

}  // namespace

LightRig::LightRig(gpu::Device& device)
    : device_(device), pipelines_(device), executor_(device, pipelines_) {}

LightRig::~LightRig() {
    device_.wait_idle();
}

Result<void> LightRig::upload(gpu::Texture& texture, const char* name, VkFormat format, int width,
                              int height, const void* bytes, std::size_t count) {
    const VkExtent2D extent{static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height)};
    texture = gpu::Texture();
    KINO_ASSIGN(texture, filled_texture(device_, name, extent, format, bytes, count));
    return {};
}

Result<void> LightRig::set_surface(const reference::LitSurface& surface) {
    const int width = surface.view_z_m.width();
    const int height = surface.view_z_m.height();
    const std::size_t pixels = surface.view_z_m.size();
    std::vector<std::uint32_t> normals(pixels);
    std::transform(surface.normal.pixels().begin(), surface.normal.pixels().end(), normals.begin(),
                   packed_normal);
    KINO_TRY(upload(albedo_, "albedo", VK_FORMAT_R8G8B8A8_UNORM, width, height,
                    surface.albedo.data(), pixels * 4));
    KINO_TRY(upload(view_z_, "view depth", kViewZFormat, width, height, surface.view_z_m.data(),
                    pixels * 4));
    KINO_TRY(upload(normal_, "normal", kNormalFormat, width, height, normals.data(), pixels * 4));
    object_ = gpu::Texture();
    if (!surface.object.empty()) {
        KINO_TRY(
            upload(object_, "object", kIdFormat, width, height, surface.object.data(), pixels * 4));
    }
    return {};
}

Result<const gpu::Buffer*> LightRig::host_buffer(std::size_t slot, std::uint64_t bytes) {
    if (readback_[slot].bytes() < bytes) {
        readback_[slot] = gpu::Buffer();
        KINO_ASSIGN(readback_[slot],
                    gpu::Buffer::create(device_, "readback", bytes, gpu::MemoryUse::readback));
    }
    return &readback_[slot];
}

Result<LightRig::Drawn> LightRig::draw(const Scene& scene, const View& view,
                                       const Options& options) {
    FrameGraph graph(executor_.history());
    const auto imported = [&](const char* name, const gpu::Texture& texture) {
        if (texture.empty()) return TextureId{};
        const VkExtent2D extent = texture.extent();
        return graph.import_texture(name, texture.image(), texture.view(),
                                    {extent.width, extent.height, texture.format()});
    };
    const SurfaceTargets surface{.albedo = imported("albedo", albedo_),
                                 .view_z = imported("view depth", view_z_),
                                 .normal = imported("normal", normal_),
                                 .object = imported("object", object_)};
    Drawn drawn;
    TextureId lists_z = surface.view_z;
    if (options.lists_z != nullptr) {
        const Image<float>& z = *options.lists_z;
        KINO_TRY(upload(lists_z_, "list depth", kViewZFormat, z.width(), z.height(), z.data(),
                        z.size() * 4));
        lists_z = imported("list depth", lists_z_);
    }
    if (!options.own_lists) {
        drawn.lists = add_light_lists(graph, scene, view, lists_z, options.lists);
    }
    LightLists& lists = drawn.lists;
    if (lists.tile_px != 0) {
        if (options.statistics) lists.counters = add_light_statistics(graph, lists);
        graph.require(lists.counters);
    }
    TextureId linear;
    const View shading_view = options.shading_view.value_or(view);
    if (options.instead) {
        linear = options.instead(graph, lists, surface);
    } else if (options.shade) {
        ShadeInputs inputs{.surface = surface, .lists = lists, .shadow_masks = {}};
        if (options.brute_force) inputs.lists.tile_px = 0;
        if (!options.shadow_masks.empty()) {
            masks_ = gpu::Buffer();
            KINO_ASSIGN(masks_,
                        gpu::Buffer::create(device_, "masks", options.shadow_masks.size() * 4,
                                            gpu::MemoryUse::upload));
            masks_.write(std::span<const std::uint32_t>(options.shadow_masks));
            inputs.shadow_masks = graph.import_buffer("masks", masks_);
        }
        linear = add_shade_pass(graph, scene, shading_view, inputs);
    }
    if (linear.valid()) graph.require(linear);

    const VkExtent2D extent{static_cast<std::uint32_t>(shading_view.width),
                            static_cast<std::uint32_t>(shading_view.height)};
    const std::size_t pixels = std::size_t{extent.width} * extent.height;
    const std::size_t tiles = std::size_t{lists.tiles_x} * lists.tiles_y;
    const auto bytes_of = [&](BufferId id) { return graph.resources()[id.index].buffer.bytes; };
    const std::uint64_t index_bytes = lists.indices.valid() ? bytes_of(lists.indices) : 0;
    const std::size_t lights =
        lists.lights.valid() ? std::size_t{lists.global_count} + lists.local_count : 0;
    std::vector<const gpu::Buffer*> host(5, nullptr);
    if (options.read) {
        if (linear.valid()) {
            KINO_ASSIGN(host[0], host_buffer(0, pixels * 8));
            read_back(graph, linear, *host[0]);
        }
        if (lights > 0) {
            KINO_ASSIGN(host[1], host_buffer(1, bytes_of(lists.lights)));
            read_back(graph, lists.lights, *host[1], lights * sizeof(shared::LightRecord));
        }
        if (lists.tile_px != 0) {
            KINO_ASSIGN(host[2], host_buffer(2, tiles * 8));
            read_back(graph, lists.headers, *host[2], tiles * 8);
            KINO_ASSIGN(host[3], host_buffer(3, index_bytes));
            read_back(graph, lists.indices, *host[3], index_bytes);
            KINO_ASSIGN(host[4], host_buffer(4, sizeof(shared::LightListCounters)));
            read_back(graph, lists.counters, *host[4], sizeof(shared::LightListCounters));
        }
    }
    KINO_ASSIGN(drawn.report, executor_.run(graph, options.timing));
    drawn.times = executor_.group_times();
    if (host[0] != nullptr) {
        drawn.bits.resize(shading_view.width, shading_view.height);
        drawn.linear.resize(shading_view.width, shading_view.height);
        std::memcpy(drawn.bits.data(), host[0]->mapped(), pixels * 8);
        std::transform(drawn.bits.pixels().begin(), drawn.bits.pixels().end(),
                       drawn.linear.pixels().begin(),
                       [](std::uint64_t bits) { return glm::unpackHalf4x16(bits); });
    }
    if (host[1] != nullptr) drawn.records = copy_of<shared::LightRecord>(*host[1], lights);
    if (host[2] != nullptr) {
        drawn.headers = copy_of<std::uint32_t>(*host[2], tiles * 2);
        drawn.indices = copy_of<std::uint32_t>(*host[3], index_bytes / 4);
        drawn.counters = copy_of<shared::LightListCounters>(*host[4], 1)[0];
    }
    return drawn;
}

std::vector<std::uint32_t> LightRig::Drawn::list(std::size_t tile) const {
    std::vector<std::uint32_t> found;
    for (std::uint32_t i = 0; i < headers[2 * tile + 1]; ++i) {
        found.push_back(records[indices[headers[2 * tile] + i]].scene_index);
    }
    return found;
}

double LightRig::Drawn::ms(const std::string& group) const {
    double sum = 0;
    for (const graph::GroupTime& time : times) sum += time.group == group ? time.ms : 0.0;
    return sum;
}

}  // namespace kino::test
