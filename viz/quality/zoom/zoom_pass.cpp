#include "viz/quality/zoom/zoom_pass.h"

#include <array>
#include <utility>

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

void add_fetch(FrameGraph& graph, const char* name, TextureId texture, const TextureDesc& desc,
               BufferId& into) {
    graph.add_pass(
        name, "zoom",
        [&](PassBuilder& b) {
            b.read(texture, Use::transfer_read);
            into = b.write(into, Use::transfer_write);
        },
        [=, id = into](PassContext& c) {
            const VkBufferImageCopy region = whole(desc);
            vkCmdCopyImageToBuffer(c.commands().handle(), c.image(texture), VK_IMAGE_LAYOUT_GENERAL,
                                   c.buffer(id), 1, &region);
        });
}

}  // namespace

struct ZoomPass::Copy {
    ZoomInput small;
    TextureDesc from, to;
    View shown;
    ZoomOptions options;
    const DeflectOptions* deflect = nullptr;
    bool reads_depth = false;
};

bool enlarges_on_host(const gpu::Device& device, ZoomPath path) {
    return path == ZoomPath::host || (path == ZoomPath::automatic && device.info().is_cpu);
}

void ZoomPass::clear() {
    small_ = gpu::Buffer();
    depth_ = gpu::Buffer();
    large_ = gpu::Buffer();
    inverse_z_ = Image<float>();
    report_ = {};
}

/// Where the newest view's pixel (0, 0) lies in the enlarged picture.
glm::ivec2 ZoomPass::newest_offset(const Copy& copy, double inverse_z) {
    const glm::ivec2 guard(copy.small.guard_px * copy.options.z);
    if (copy.deflect == nullptr) return guard;
    report_.shown = deflectable(copy.deflect->newest(), copy.shown);
    return guard + pan_of(*report_.shown, copy.shown, inverse_z);
}

TextureId ZoomPass::add_fragment_copy(FrameGraph& graph, const Copy& copy, TextureId target) {
    const auto execute = [=, this](PassContext& c) {
        const double z = copy.deflect == nullptr ? 0 : copy.deflect->reference_z_m;
        const shared::ZoomParams params{.offset = newest_offset(copy, z > 0 ? 1 / z : 0),
                                        .z = copy.options.z};
        gpu::PipelineDesc desc;
        desc.name = "zoom/copy";
        desc.vertex = kZoomFullscreen;
        desc.fragment = kZoomCopy;
        desc.bindings = {gpu::Binding::texture};
        desc.push_bytes = sizeof(params);
        desc.constants = {static_cast<std::uint32_t>(copy.options.blur)};
        desc.color_formats = {copy.to.format};
        const std::array<gpu::Target, 1> targets = {{{.view = c.view(target)}}};
        c.commands().begin_rendering({copy.to.width, copy.to.height}, targets, nullptr);
        if (c.bind(desc, {c.bound(copy.small.picture, copy.options.blur == ZoomBlur::box)})) {
            c.commands().constants(params);
            c.commands().draw(3);
        }
        c.commands().end_rendering();
    };
    graph.add_pass(
        "zoom/copy", "zoom",
        [&](PassBuilder& b) {
            b.read(copy.small.picture, Use::fragment_read);
            target = b.write(target, Use::color_attachment);
        },
        execute);
    return target;
}

void ZoomPass::enlarge_mapped(const Copy& copy) {
    const auto picture = rows_of<const std::uint32_t>(small_, copy.from);
    const auto out = rows_of<std::uint32_t>(large_, copy.to);
    const DeflectOptions* const deflect_by = copy.deflect;
    double inverse_z = 0;
    if (copy.reads_depth) {
        inverse_z = invert_depths(rows_of<const float>(depth_, copy.from), deflect_by->nearest_z_m,
                                  inverse_z_);
    }
    if (deflect_by != nullptr && deflect_by->reference_z_m > 0) {
        inverse_z = 1 / deflect_by->reference_z_m;
    }
    if (deflect_by == nullptr || deflect_by->form == DeflectForm::pan) {
        report_.clamped_px = enlarge(picture, copy.options.z, copy.options.blur, out,
                                     newest_offset(copy, inverse_z));
        return;
    }
    report_.shown = deflectable(deflect_by->newest(), copy.shown);
    DrawnPicture drawn{.picture = picture, .view = copy.small.view, .inverse_z = {}};
    if (deflect_by->form == DeflectForm::depth_warp && copy.reads_depth) {
        drawn.inverse_z = std::as_const(inverse_z_).view();
    }
    const bool smooth = copy.options.z == 1 || copy.options.blur != ZoomBlur::none;
    report_.clamped_px = deflect(drawn, *report_.shown, inverse_z, smooth, out);
}

Result<TextureId> ZoomPass::add(FrameGraph& graph, const ZoomInput& small, TextureId target,
                                const View& shown, const ZoomOptions& options,
                                const DeflectOptions* deflect) {
    Copy copy{.small = small,
              .from = graph.resources()[small.picture.index].texture,
              .to = graph.resources()[target.index].texture,
              .shown = shown,
              .options = options,
              .deflect = deflect};
    report_ = {};
    const bool pans = deflect == nullptr || deflect->form == DeflectForm::pan;
    if (pans && !enlarges_on_host(device_, options.path)) {
        clear();
        return add_fragment_copy(graph, copy, target);
    }
    copy.reads_depth = deflect != nullptr && small.view_z.valid() &&
                       (deflect->form == DeflectForm::depth_warp || deflect->reference_z_m <= 0);
    KINO_TRY(fit_exactly(device_, small_, "zoom, small", copy.from, gpu::MemoryUse::readback));
    KINO_TRY(fit_exactly(device_, large_, "zoom, enlarged", copy.to, gpu::MemoryUse::upload));
    BufferId fetched = graph.import_buffer("small picture, mapped", small_);
    BufferId enlarged = graph.import_buffer("enlarged picture, mapped", large_);
    BufferId depths;
    add_fetch(graph, "zoom/fetch", small.picture, copy.from, fetched);
    if (copy.reads_depth) {
        KINO_TRY(fit_exactly(device_, depth_, "zoom, depth", copy.from, gpu::MemoryUse::readback));
        depths = graph.import_buffer("small depth, mapped", depth_);
        add_fetch(graph, "zoom/fetch depth", small.view_z, copy.from, depths);
    } else {
        depth_ = gpu::Buffer();
    }
    graph.add_pass(
        "zoom/enlarge", "zoom",
        [&](PassBuilder& b) {
            b.on_host();
            b.read(fetched, Use::host_read);
            if (copy.reads_depth) b.read(depths, Use::host_read);
            enlarged = b.write(enlarged, Use::host_write);
        },
        [this, copy](PassContext&) { enlarge_mapped(copy); });
    graph.add_pass(
        "zoom/put", "zoom",
        [&](PassBuilder& b) {
            b.read(enlarged, Use::transfer_read);
            target = b.write(target, Use::transfer_write);
        },
        [enlarged, to = copy.to, id = target](PassContext& c) {
            const VkBufferImageCopy region = whole(to);
            vkCmdCopyBufferToImage(c.commands().handle(), c.buffer(enlarged), c.image(id),
                                   VK_IMAGE_LAYOUT_GENERAL, 1, &region);
        });
    return target;
}

}  // namespace kino
