#include "apps/demo_show/screen_painter.h"

#include <algorithm>
#include <utility>

#include "apps/demo_show/ui_canvas.h"

namespace kino {
namespace {

/// Of the letters that all sizes are drawn from, as a part of the picture's height.
constexpr float kLetters = 0.065f;

}  // namespace

Result<std::unique_ptr<ScreenPainter>> ScreenPainter::create(gpu::Device& device,
                                                             GLFWwindow* window, int height) {
    const float letters = std::clamp(kLetters * static_cast<float>(height), 12.0f, 96.0f);
    auto context = window != nullptr ? std::make_unique<UiContext>(window, letters)
                                     : std::make_unique<UiContext>(letters);
    std::unique_ptr<ScreenPainter> painter(
        new ScreenPainter(std::move(context), window != nullptr));
    KINO_ASSIGN(painter->ui_, UiRenderer::create(device));
    return painter;
}

void ScreenPainter::prepare(const ShowScreen& screen, const View& view, double dt_s,
                            FrameOptions& frame) {
    if (has_window_) {
        context_->begin_frame();
    } else {
        context_->begin_picture(view.width, view.height, std::max(dt_s, 1e-3));
    }
    const bool empty = screen.empty();
    if (!empty) draw_screen(UiCanvas(view.width, view.height), view, screen, dt_s, spots_);
    ImDrawData& lists = context_->end_frame();
    if (empty) return;
    frame.overlay = [this, &lists](graph::FrameGraph& graph, graph::TextureId picture) {
        auto drawn = ui_->add(graph, picture, lists);
        if (drawn) return *drawn;
        trouble_ = drawn.error();
        return picture;
    };
}

Result<void> ScreenPainter::result() {
    if (trouble_) return fail(*std::exchange(trouble_, std::nullopt));
    return {};
}

}  // namespace kino
