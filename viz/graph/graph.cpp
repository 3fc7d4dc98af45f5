#include "viz/graph/graph.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "base/check.h"

namespace kino::graph {

Access access_of(Use use) {
    constexpr VkAccessFlags2 kRead =
        VK_ACCESS_2_SHADER_STORAGE_READ_BIT | VK_ACCESS_2_SHADER_SAMPLED_READ_BIT;
    switch (use) {
        case Use::compute_read:
            return {VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, kRead, false};
        case Use::compute_write:
            return {VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT,
                    kRead | VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT, true};
        case Use::vertex_read:
            return {VK_PIPELINE_STAGE_2_PRE_RASTERIZATION_SHADERS_BIT, kRead, false};
        case Use::fragment_read:
            return {VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT, kRead, false};
        case Use::indirect_read:
            return {VK_PIPELINE_STAGE_2_DRAW_INDIRECT_BIT, VK_ACCESS_2_INDIRECT_COMMAND_READ_BIT,
                    false};
        case Use::index_read:
            return {VK_PIPELINE_STAGE_2_INDEX_INPUT_BIT, VK_ACCESS_2_INDEX_READ_BIT, false};
        case Use::attribute_read:
            return {VK_PIPELINE_STAGE_2_VERTEX_ATTRIBUTE_INPUT_BIT,
                    VK_ACCESS_2_VERTEX_ATTRIBUTE_READ_BIT, false};
        case Use::transfer_read:
            return {VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_READ_BIT, false};
        case Use::transfer_write:
            return {VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT, true};
        case Use::color_attachment:
            return {VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT,
                    VK_ACCESS_2_COLOR_ATTACHMENT_READ_BIT | VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT,
                    true};
        case Use::depth_attachment:
            return {VK_PIPELINE_STAGE_2_EARLY_FRAGMENT_TESTS_BIT |
                        VK_PIPELINE_STAGE_2_LATE_FRAGMENT_TESTS_BIT,
                    VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_READ_BIT |
                        VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT,
                    true};
        case Use::host_read:
            return {VK_PIPELINE_STAGE_2_HOST_BIT, VK_ACCESS_2_HOST_READ_BIT, false};
        case Use::host_write:
            return {VK_PIPELINE_STAGE_2_HOST_BIT, VK_ACCESS_2_HOST_WRITE_BIT, true};
    }
    return {};
}

std::uint32_t FrameGraph::add(Resource resource) {
    resources_.push_back(std::move(resource));
    return static_cast<std::uint32_t>(resources_.size() - 1);
}

BufferId FrameGraph::create_buffer(std::string name, BufferDesc desc) {
    KINO_CHECK(desc.bytes > 0);
    return {add({.name = std::move(name), .buffer = desc}), 0};
}

TextureId FrameGraph::create_texture(std::string name, TextureDesc desc) {
    KINO_CHECK(desc.width > 0 && desc.height > 0);
    const VkExtent2D memory = room({desc.width, desc.height});
    desc.room_width = memory.width;
    desc.room_height = memory.height;
    return {add({.name = std::move(name), .kind = ResourceKind::texture, .texture = desc}), 0};
}

void FrameGraph::reserve(VkExtent2D size, VkExtent2D room) {
    KINO_CHECK(room.width >= size.width && room.height >= size.height);
    // The newest counts.
    reservations_.insert(reservations_.begin(), {size, room});
}

VkExtent2D FrameGraph::room(VkExtent2D size) const {
    for (const Reservation& reserved : reservations_) {
        if (reserved.size.width == size.width && reserved.size.height == size.height) {
            return reserved.room;
        }
    }
    return size;
}

BufferId FrameGraph::import_buffer(std::string name, const gpu::Buffer& buffer) {
    const BufferId id = import_buffer(std::move(name), BufferDesc{buffer.bytes()});
    resources_[id.index].imported_buffer = &buffer;
    return id;
}

BufferId FrameGraph::import_buffer(std::string name, BufferDesc desc) {
    return {add({.name = std::move(name), .buffer = desc, .imported = true}), 0};
}

TextureId FrameGraph::import_texture(std::string name, VkImage image, VkImageView view,
                                     TextureDesc desc) {
    return {add({.name = std::move(name),
                 .kind = ResourceKind::texture,
                 .texture = desc,
                 .imported_image = image,
                 .imported_view = view,
                 .imported = true}),
            0};
}

HistoryPair FrameGraph::history(const std::string& owner, int view, BufferDesc desc) {
    const HistoryBook::Entry& entry = history_.want(fmt::format("{}/{}", owner, view), desc.bytes);
    const auto make = [&](int slot, const char* suffix) {
        return BufferId{add({.name = entry.key + suffix,
                             .buffer = desc,
                             .history_key = entry.key,
                             .history_slot = slot}),
                        0};
    };
    HistoryPair pair;
    pair.previous = make(entry.current ^ 1, " (previous)");
    pair.current = make(entry.current, " (current)");
    pair.valid = entry.valid;
    return pair;
}

void FrameGraph::add_pass(std::string name, std::string group, const Setup& setup,
                          Execute execute) {
    Pass pass{.name = std::move(name), .group = std::move(group), .execute = std::move(execute)};
    PassBuilder builder(*this, pass);
    setup(builder);
    passes_.push_back(std::move(pass));
}

void FrameGraph::require(BufferId id) {
    check_current(id.index, id.version);
    required_.push_back(id.index);
}

void FrameGraph::require(TextureId id) {
    check_current(id.index, id.version);
    required_.push_back(id.index);
}

void FrameGraph::allow_storage(TextureId id) {
    check_current(id.index, id.version);
    Resource& resource = resources_[id.index];
    KINO_CHECK(!resource.imported);
    resource.texture.storage = true;
}

void FrameGraph::check_current(std::uint32_t index, std::uint32_t version) const {
    KINO_CHECK_LT(index, resources_.size());
    // A stale id: somebody wrote the resource after this id was made.
    KINO_CHECK_EQ(version, resources_[index].version);
}

BufferId PassBuilder::read(BufferId id, Use use) {
    graph_.check_current(id.index, id.version);
    KINO_CHECK(!access_of(use).writes);
    pass_.uses.push_back({id.index, use});
    return id;
}

TextureId PassBuilder::read(TextureId id, Use use) {
    graph_.check_current(id.index, id.version);
    KINO_CHECK(!access_of(use).writes);
    pass_.uses.push_back({id.index, use});
    return id;
}

BufferId PassBuilder::write(BufferId id, Use use) {
    graph_.check_current(id.index, id.version);
    KINO_CHECK(access_of(use).writes);
    pass_.uses.push_back({id.index, use});
    return {id.index, ++graph_.resources_[id.index].version};
}

TextureId PassBuilder::write(TextureId id, Use use) {
    graph_.check_current(id.index, id.version);
    KINO_CHECK(access_of(use).writes);
    pass_.uses.push_back({id.index, use});
    return {id.index, ++graph_.resources_[id.index].version};
}

std::vector<bool> FrameGraph::living_passes() const {
    // Backwards: a pass lives if it makes something that is wanted; then all it touches is wanted
    // from the passes before it. Writes are read-modify-write, so an earlier writer of the same
    // resource lives too.
    std::vector<bool> wanted(resources_.size(), false);
    for (const std::uint32_t resource : required_) wanted[resource] = true;
    std::vector<bool> lives(passes_.size(), false);
    for (std::size_t i = passes_.size(); i-- > 0;) {
        const Pass& pass = passes_[i];
        lives[i] = pass.side_effect ||
                   std::any_of(pass.uses.begin(), pass.uses.end(), [&](const ResourceUse& use) {
                       return access_of(use.use).writes && wanted[use.resource];
                   });
        if (!lives[i]) continue;
        for (const ResourceUse& use : pass.uses) wanted[use.resource] = true;
    }
    return lives;
}

namespace {

constexpr std::uint32_t kNone = UINT32_MAX;

/// What happened last to one piece of memory.
struct State {
    VkPipelineStageFlags2 write_stages = 0;
    VkAccessFlags2 write_access = 0;
    VkPipelineStageFlags2 read_stages = 0;  ///< since the last write
    VkPipelineStageFlags2 seen_by = 0;      ///< stages the last write was made visible to
    VkAccessFlags2 seen_access = 0;
    bool touched = false;
};

bool same_memory(const Resource& a, const Resource& b) {
    return a.kind == b.kind &&
           (a.kind == ResourceKind::buffer ? a.buffer == b.buffer : a.texture == b.texture);
}

std::uint64_t bytes_of(const Resource& r) {
    if (r.kind == ResourceKind::buffer) return r.buffer.bytes;
    return std::uint64_t{r.texture.room_width} * r.texture.room_height *
           gpu::bytes_per_pixel(r.texture.format) * r.texture.samples;
}

}  // namespace

CompiledGraph FrameGraph::compile() const {
    CompiledGraph compiled;
    compiled.slot_of_resource.assign(resources_.size(), kNone);
    const std::vector<bool> lives = living_passes();
    std::vector<std::size_t> last_use(resources_.size(), 0);
    for (std::size_t i = 0; i < passes_.size(); ++i) {
        if (!lives[i]) continue;
        for (const ResourceUse& use : passes_[i].uses) last_use[use.resource] = i;
    }

    std::vector<bool> slot_free;
    std::vector<State> slot_state;
    std::vector<State> own_state(resources_.size());  // imported and history memory
    const auto is_transient = [&](std::uint32_t r) {
        return !resources_[r].imported && resources_[r].history_key.empty();
    };
    const auto place = [&](std::uint32_t r) {
        for (std::uint32_t s = 0; s < compiled.slots.size(); ++s) {
            if (slot_free[s] && same_memory(resources_[compiled.slots[s]], resources_[r])) return s;
        }
        compiled.slots.push_back(r);
        slot_free.push_back(true);
        slot_state.emplace_back();
        compiled.transient_bytes += bytes_of(resources_[r]);
        return static_cast<std::uint32_t>(compiled.slots.size() - 1);
    };

    std::vector<bool> seen(resources_.size(), false);
    for (std::size_t i = 0; i < passes_.size(); ++i) {
        if (!lives[i]) continue;
        CompiledPass out;
        out.pass = static_cast<std::uint32_t>(i);
        for (const ResourceUse& use : passes_[i].uses) {
            const std::uint32_t r = use.resource;
            if (is_transient(r) && compiled.slot_of_resource[r] == kNone) {
                const std::uint32_t slot = place(r);
                slot_free[slot] = false;
                compiled.slot_of_resource[r] = slot;
            }
            if (!seen[r] && resources_[r].kind == ResourceKind::texture && is_transient(r)) {
                out.first_use.push_back(r);
            }
            seen[r] = true;
            State& state =
                is_transient(r) ? slot_state[compiled.slot_of_resource[r]] : own_state[r];
            const Access access = access_of(use.use);
            if (!state.touched) {
                // The frame before may still be at it: wait for everything, once.
                out.wait_stages |= VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
                out.wait_access |= VK_ACCESS_2_MEMORY_WRITE_BIT;
                out.stages |= access.stages;
                out.access |= access.access;
            } else if (access.writes) {
                out.wait_stages |= state.write_stages | state.read_stages;
                out.wait_access |= state.write_access;
                out.stages |= access.stages;
                out.access |= access.access;
            } else if ((state.seen_by & access.stages) != access.stages ||
                       (state.seen_access & access.access) != access.access) {
                out.wait_stages |= state.write_stages;
                out.wait_access |= state.write_access;
                out.stages |= access.stages;
                out.access |= access.access;
            }
            if (access.writes) {
                state = {.write_stages = access.stages,
                         .write_access = access.access,
                         .seen_by = 0,
                         .seen_access = 0};
            } else {
                state.read_stages |= access.stages;
                state.seen_by |= access.stages;
                state.seen_access |= access.access;
            }
            state.touched = true;
        }
        // A read that never had a writer waits for nothing.
        if (out.wait_stages == 0) out.stages = 0;
        for (const ResourceUse& use : passes_[i].uses) {
            if (is_transient(use.resource) && last_use[use.resource] == i) {
                slot_free[compiled.slot_of_resource[use.resource]] = true;
            }
        }
        compiled.passes.push_back(std::move(out));
    }
    // Required transients are read after the frame: they must not share memory with later ones.
    return compiled;
}

std::string FrameGraph::to_graphviz() const {
    const std::vector<bool> lives = living_passes();
    std::string dot = "digraph frame {\n  rankdir=LR;\n";
    for (std::size_t i = 0; i < passes_.size(); ++i) {
        dot += fmt::format("  p{} [shape=box label=\"{}\"{}];\n", i, passes_[i].name,
                           lives[i] ? "" : " style=dashed");
        for (const ResourceUse& use : passes_[i].uses) {
            dot += access_of(use.use).writes ? fmt::format("  p{} -> r{};\n", i, use.resource)
                                             : fmt::format("  r{} -> p{};\n", use.resource, i);
        }
    }
    for (std::size_t r = 0; r < resources_.size(); ++r) {
        dot += fmt::format("  r{} [label=\"{}\"];\n", r, resources_[r].name);
    }
    return dot + "}\n";
}

}  // namespace kino::graph
