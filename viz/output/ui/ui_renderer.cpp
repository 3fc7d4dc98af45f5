#include "viz/output/ui/ui_renderer.h"

#include <imgui.h>

#include <algorithm>
#include <array>
#include <span>

#include "base/check.h"
#include "viz/gpu/commands.h"
#include "viz/graph/executor.h"
#include "viz/output/ui/ui_shared.h"

namespace kino {
namespace {

using graph::PassBuilder;
using graph::PassContext;
using graph::Use;

constexpr std::uint32_t kVertexCode[] = {
#include "ui_vert.inc"
};
constexpr std::uint32_t kFragmentCode[] = {
#include "ui_frag.inc"
};

/// Grows by halves, so a longer text does not mean new memory every time.
Result<void> reserve(gpu::Device& device, gpu::Buffer& buffer, const char* name,
                     std::size_t bytes) {
    if (!buffer.empty() && buffer.bytes() >= bytes) return {};
    const std::size_t room = std::max<std::size_t>(bytes + bytes / 2, 1 << 16);
    buffer = gpu::Buffer();
    KINO_ASSIGN(buffer, gpu::Buffer::create(device, name, room, gpu::MemoryUse::upload));
    return {};
}

gpu::PipelineDesc ui_pipeline(VkFormat format) {
    gpu::PipelineDesc desc;
    desc.name = "ui/draw";
    desc.vertex = kVertexCode;
    desc.fragment = kFragmentCode;
    desc.bindings = {gpu::Binding::texture};
    desc.push_bytes = sizeof(shared::UiParams);
    desc.color_formats = {format};
    desc.blend = gpu::Blend::alpha;
    desc.vertex_colors = true;
    return desc;
}

/// What of a command's rectangle lies inside the picture.
VkRect2D clip(const ImVec4& rect, const ImDrawData& data, VkExtent2D extent) {
    const auto inside = [](float v, std::uint32_t limit) {
        return static_cast<std::int32_t>(std::clamp(v, 0.0f, static_cast<float>(limit)));
    };
    const std::int32_t left = inside(rect.x - data.DisplayPos.x, extent.width);
    const std::int32_t top = inside(rect.y - data.DisplayPos.y, extent.height);
    const std::int32_t right = inside(rect.z - data.DisplayPos.x, extent.width);
    const std::int32_t bottom = inside(rect.w - data.DisplayPos.y, extent.height);
    return {{left, top},
            {static_cast<std::uint32_t>(std::max(0, right - left)),
             static_cast<std::uint32_t>(std::max(0, bottom - top))}};
}

}  // namespace

void UiPicture::set(ImageView<const Rgba8> pixels) {
    KINO_CHECK_EQ(pixels.width, width());
    KINO_CHECK_EQ(pixels.height, height());
    for (int y = 0; y < pixels.height; ++y) {
        const std::size_t row_bytes = sizeof(Rgba8) * static_cast<std::size_t>(pixels.width);
        staging_.write(std::span(pixels.row(y), static_cast<std::size_t>(pixels.width)),
                       row_bytes * static_cast<std::size_t>(y));
    }
    changed_ = true;
}

Result<std::unique_ptr<UiRenderer>> UiRenderer::create(gpu::Device& device) {
    std::unique_ptr<UiRenderer> ui(new UiRenderer(device));
    unsigned char* pixels = nullptr;
    int width = 0, height = 0;
    ImFontAtlas& fonts = *ImGui::GetIO().Fonts;
    fonts.GetTexDataAsRGBA32(&pixels, &width, &height);
    KINO_ASSIGN(ui->font_, ui->make_picture(width, height));
    ui->font_->set({reinterpret_cast<const Rgba8*>(pixels), width, height, width});
    fonts.SetTexID(ui->font_->id());
    return ui;
}

Result<std::unique_ptr<UiPicture>> UiRenderer::make_picture(int width, int height) {
    const VkExtent2D extent{static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height)};
    auto picture = std::make_unique<UiPicture>();
    KINO_ASSIGN(picture->texture_,
                gpu::Texture::create(device_, "ui picture", extent, VK_FORMAT_R8G8B8A8_UNORM));
    KINO_ASSIGN(
        picture->staging_,
        gpu::Buffer::create(device_, "ui staging", std::uint64_t{4} * extent.width * extent.height,
                            gpu::MemoryUse::upload));
    KINO_TRY(device_.submit_and_wait([&](VkCommandBuffer commands) {
        gpu::Commands(device_, commands).to_general(picture->texture_.image());
    }));
    return picture;
}

Result<void> UiRenderer::upload_geometry(const ImDrawData& data) {
    static_assert(sizeof(ImDrawVert) == 20);
    const auto vertex_count = static_cast<std::size_t>(data.TotalVtxCount);
    const auto index_count = static_cast<std::size_t>(data.TotalIdxCount);
    KINO_TRY(reserve(device_, vertices_, "ui vertices", vertex_count * sizeof(ImDrawVert)));
    KINO_TRY(reserve(device_, indices_, "ui indices", index_count * sizeof(ImDrawIdx)));
    std::size_t vertex_at = 0;
    std::size_t index_at = 0;
    for (int i = 0; i < data.CmdListsCount; ++i) {
        const ImDrawList& list = *data.CmdLists[i];
        const std::span vertices(list.VtxBuffer.Data,
                                 static_cast<std::size_t>(list.VtxBuffer.Size));
        const std::span indices(list.IdxBuffer.Data, static_cast<std::size_t>(list.IdxBuffer.Size));
        vertices_.write(std::span<const ImDrawVert>(vertices), vertex_at);
        indices_.write(std::span<const ImDrawIdx>(indices), index_at);
        vertex_at += vertices.size_bytes();
        index_at += indices.size_bytes();
    }
    return {};
}

Result<graph::TextureId> UiRenderer::add(graph::FrameGraph& graph, graph::TextureId target,
                                         ImDrawData& data) {
    if (data.TotalIdxCount == 0) return target;
    KINO_TRY(upload_geometry(data));

    // Every picture once, in the order of its first command.
    std::vector<UiPicture*> pictures;
    for (int i = 0; i < data.CmdListsCount; ++i) {
        for (const ImDrawCmd& command : data.CmdLists[i]->CmdBuffer) {
            auto* picture = static_cast<UiPicture*>(command.GetTexID());
            if (picture != nullptr &&
                std::find(pictures.begin(), pictures.end(), picture) == pictures.end()) {
                pictures.push_back(picture);
            }
        }
    }
    std::vector<graph::TextureId> ids;
    for (UiPicture* picture : pictures) {
        const VkExtent2D extent = picture->texture_.extent();
        graph::TextureId id =
            graph.import_texture("ui picture", picture->texture_.image(), picture->texture_.view(),
                                 {extent.width, extent.height, picture->texture_.format()});
        if (picture->changed_) {
            picture->changed_ = false;
            graph.add_pass(
                "ui/upload", "ui", [&](PassBuilder& b) { id = b.write(id, Use::transfer_write); },
                [picture, extent](PassContext& c) {
                    const VkBufferImageCopy copy{
                        .imageSubresource = {.aspectMask = VK_IMAGE_ASPECT_COLOR_BIT,
                                             .layerCount = 1},
                        .imageExtent = {extent.width, extent.height, 1}};
                    vkCmdCopyBufferToImage(c.commands().handle(), picture->staging_.handle(),
                                           picture->texture_.image(), VK_IMAGE_LAYOUT_GENERAL, 1,
                                           &copy);
                });
        }
        ids.push_back(id);
    }

    const auto draw = [this, target, &data](PassContext& c) {
        const VkExtent2D extent{c.desc(target).width, c.desc(target).height};
        const gpu::PipelineDesc desc = ui_pipeline(c.desc(target).format);
        const shared::UiParams params{.scale = {2 / data.DisplaySize.x, 2 / data.DisplaySize.y},
                                      .offset = {-1 - data.DisplayPos.x * 2 / data.DisplaySize.x,
                                                 -1 - data.DisplayPos.y * 2 / data.DisplaySize.y}};
        const std::array<gpu::Target, 1> targets = {{{.view = c.view(target)}}};
        const VkCommandBuffer commands = c.commands().handle();
        c.commands().begin_rendering(extent, targets, nullptr);
        const VkBuffer vertices = vertices_.handle();
        const VkDeviceSize zero = 0;
        vkCmdBindVertexBuffers(commands, 0, 1, &vertices, &zero);
        vkCmdBindIndexBuffer(commands, indices_.handle(), 0,
                             sizeof(ImDrawIdx) == 2 ? VK_INDEX_TYPE_UINT16 : VK_INDEX_TYPE_UINT32);
        const UiPicture* bound = nullptr;
        std::uint32_t first_vertex = 0;
        std::uint32_t first_index = 0;
        for (int i = 0; i < data.CmdListsCount; ++i) {
            const ImDrawList& list = *data.CmdLists[i];
            for (const ImDrawCmd& command : list.CmdBuffer) {
                const auto* picture = static_cast<const UiPicture*>(command.GetTexID());
                const VkRect2D scissor = clip(command.ClipRect, data, extent);
                if (picture == nullptr || scissor.extent.width == 0 || scissor.extent.height == 0) {
                    continue;
                }
                if (picture != bound) {
                    // Text is drawn pixel on pixel and images are small: nearest is exact for the
                    // one, good enough for the other, and half the price on a CPU device.
                    if (!c.bind(desc, {{.view = picture->texture_.view()}})) break;
                    c.commands().constants(params);
                    bound = picture;
                }
                vkCmdSetScissor(commands, 0, 1, &scissor);
                vkCmdDrawIndexed(commands, command.ElemCount, 1, first_index + command.IdxOffset,
                                 static_cast<std::int32_t>(first_vertex + command.VtxOffset), 0);
            }
            first_vertex += static_cast<std::uint32_t>(list.VtxBuffer.Size);
            first_index += static_cast<std::uint32_t>(list.IdxBuffer.Size);
        }
        c.commands().end_rendering();
    };
    graph.add_pass(
        "ui/draw", "ui",
        [&](PassBuilder& b) {
            for (const graph::TextureId id : ids) b.read(id, Use::fragment_read);
            target = b.write(target, Use::color_attachment);
        },
        draw);
    return target;
}

}  // namespace kino
