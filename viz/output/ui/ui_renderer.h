#pragma once

#include <memory>
#include <vector>

#include "base/image.h"
#include "viz/gpu/resource.h"
#include "viz/graph/graph.h"

struct ImDrawData;

namespace kino {

/// A picture inside the user interface that changes from frame to frame. Belongs to a UiRenderer.
class UiPicture {
  public:
    [[nodiscard]] int width() const { return static_cast<int>(texture_.extent().width); }
    [[nodiscard]] int height() const { return static_cast<int>(texture_.extent().height); }
    /// What ImGui::Image() takes.
    [[nodiscard]] void* id() { return this; }
    /// Copied at once, drawn from the next frame on. The size is that of creation.
    void set(ImageView<const Rgba8> pixels);

  private:
    friend class UiRenderer;
    gpu::Texture texture_;
    gpu::Buffer staging_;
    bool changed_ = false;
};

/// Draws Dear ImGui's lists as one pass of the frame graph. Needs a current ImGui context.
class UiRenderer {
  public:
    /// Makes the font picture of the current ImGui context.
    [[nodiscard]] static Result<std::unique_ptr<UiRenderer>> create(gpu::Device& device);

    [[nodiscard]] Result<std::unique_ptr<UiPicture>> make_picture(int width, int height);

    /// Adds the passes that draw `data` over `target`; returns its new id. `data` and every
    /// picture in it must live until the graph has run.
    [[nodiscard]] Result<graph::TextureId> add(graph::FrameGraph& graph, graph::TextureId target,
                                               ImDrawData& data);

  private:
    explicit UiRenderer(gpu::Device& device) : device_(device) {}
    Result<void> upload_geometry(const ImDrawData& data);

    gpu::Device& device_;
    std::unique_ptr<UiPicture> font_;
    gpu::Buffer vertices_;
    gpu::Buffer indices_;
};

}  // namespace kino
