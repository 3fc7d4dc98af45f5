#include "viz/quality/zoom/zoom_pass.h"

#include <array>

#include "viz/quality/zoom/zoom_copy.h"
#include "viz/quality/zoom/zoom_shared.h"

namespace kino {
namespace {

using graph::BufferId;
using graph::FrameGraph;
using graph::PassBuilder;
using graph::PassContext;
using graph::TextureDesc;
using graph::TextureId;
using graph::Use;

constexpr std::uint32_t kZoomFullscreen[] = {
#include "zoom_fullscreen_vert.inc"
};
constexpr std::uint32_t kZoomCopy[] = {
#include "zoom_copy_frag.inc"
};

VkBufferImageCopy whole(const TextureDesc& desc) {
    return {.imageSubresource = {.aspectMask = VK_IMAGE_ASPECT_COLOR_BIT, .layerCount = 1},
            .imageExtent = {desc.width, desc.height, 1}};
}

Result<void> fit_exactly(gpu::Device& device, gpu::Buffer& buffer, const char* name,
                         const TextureDesc& desc, gpu::MemoryUse use) {
    const std::uint64_t bytes = std::uint64_t{desc.width} * desc.height * 4;
    if (buffer.bytes() == bytes) return {};
    buffer = gpu::Buffer();
    KINO_ASSIGN(buffer, gpu::Buffer::create(device, name, bytes, use));
    return {};
}

template <class T>
ImageView<T> rows_of(const gpu::Buffer& buffer, const TextureDesc& desc) {
    return {static_cast<T*>(buffer.mapped()), static_cast<int>(desc.width),
            static_cast<int>(desc.height), static_cast<std::ptrdiff_t>(desc.width)};
}

TextureId add_fragment_copy(FrameGraph& graph, TextureId small, TextureId target,
                            const ZoomOptions& options, glm::ivec2 offset) {
    const shared::ZoomParams params{.offset = offset, .z = options.z};
    const auto execute = [=](PassContext& c) {
        gpu::PipelineDesc desc;
        desc.name = "zoom/copy";
        desc.vertex = kZoomFullscreen;
        desc.fragment = kZoomCopy;
        desc.bindings = {gpu::Binding::texture};
        desc.push_bytes = sizeof(params);
        desc.constants = {static_cast<std::uint32_t>(options.blur)};
        desc.color_formats = {c.desc(target).format};
        const std::array<gpu::Target, 1> targets = {{{.view = c.view(target)}}};
        c.commands().begin_rendering({c.desc(target).width, c.desc(target).height}, targets,
                                     nullptr);
        if (c.bind(desc, {c.bound(small, options.blur == ZoomBlur::box)})) {
            c.commands().constants(params);
            c.commands().draw(3);
        }
        c.commands().end_rendering();
    };
    graph.add_pass(
        "zoom/copy", "zoom",
        [&](PassBuilder& b) {
            b.read(small, Use::fragment_read);
            target = b.write(target, Use::color_attachment);
        },
        execute);
    return target;
}

}  // namespace

bool enlarges_on_host(const gpu::Device& device, ZoomPath path) {
    return path == ZoomPath::host || (path == ZoomPath::automatic && device.info().is_cpu);
}

void ZoomPass::clear() {
    small_ = gpu::Buffer();
    large_ = gpu::Buffer();
}

Result<TextureId> ZoomPass::add(FrameGraph& graph, TextureId small, TextureId target,
                                const ZoomOptions& options, glm::ivec2 offset) {
    if (!enlarges_on_host(device_, options.path)) {
        clear();
        return add_fragment_copy(graph, small, target, options, offset);
    }
    const TextureDesc from = graph.resources()[small.index].texture;
    const TextureDesc to = graph.resources()[target.index].texture;
    KINO_TRY(fit_exactly(device_, small_, "zoom, small", from, gpu::MemoryUse::readback));
    KINO_TRY(fit_exactly(device_, large_, "zoom, enlarged", to, gpu::MemoryUse::upload));
    BufferId fetched = graph.import_buffer("small picture, mapped", small_);
    BufferId enlarged = graph.import_buffer("enlarged picture, mapped", large_);
    graph.add_pass(
        "zoom/fetch", "zoom",
        [&](PassBuilder& b) {
            b.read(small, Use::transfer_read);
            fetched = b.write(fetched, Use::transfer_write);
        },
        [=, id = fetched](PassContext& c) {
            const VkBufferImageCopy region = whole(from);
            vkCmdCopyImageToBuffer(c.commands().handle(), c.image(small), VK_IMAGE_LAYOUT_GENERAL,
                                   c.buffer(id), 1, &region);
        });
    graph.add_pass(
        "zoom/enlarge", "zoom",
        [&](PassBuilder& b) {
            b.on_host();
            b.read(fetched, Use::host_read);
            enlarged = b.write(enlarged, Use::host_write);
        },
        [this, from, to, options, offset](PassContext&) {
            enlarge(rows_of<const std::uint32_t>(small_, from), options.z, options.blur,
                    rows_of<std::uint32_t>(large_, to), offset);
        });
    graph.add_pass(
        "zoom/put", "zoom",
        [&](PassBuilder& b) {
            b.read(enlarged, Use::transfer_read);
            target = b.write(target, Use::transfer_write);
        },
        [enlarged, to, id = target](PassContext& c) {
            const VkBufferImageCopy region = whole(to);
            vkCmdCopyBufferToImage(c.commands().handle(), c.buffer(enlarged), c.image(id),
                                   VK_IMAGE_LAYOUT_GENERAL, 1, &region);
        });
    return target;
}

}  // namespace kino
