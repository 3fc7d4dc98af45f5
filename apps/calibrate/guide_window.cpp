#include "apps/calibrate/guide_window.h"

#include <algorithm>
#include <cstdlib>
#include <string_view>
#include <utility>

#include "apps/calibrate/guide_panels.h"
#include "sensor/color_conversion.h"
#include "viz/output/ui/ui_context.h"
#include "viz/output/ui/ui_renderer.h"
#include "viz/output/window.h"

namespace kino {
namespace {

// GLFW's numbers.
constexpr int kKeyEscape = 256;
constexpr int kKeyEnter = 257;
constexpr int kKeyPadEnter = 335;

// As in the viewer: for tests.
bool is_validated() {
    const char* wanted = std::getenv("KINO_VALIDATION");
    return wanted != nullptr && std::string_view(wanted) == "1";
}

}  // namespace

// The window's surface belongs to the device's instance, so the window is declared, and left,
// after it; the user interface goes before both.
struct GuideWindow::State {
    Board board;
    std::unique_ptr<Window> window;
    std::unique_ptr<gpu::Device> device;
    std::unique_ptr<UiContext> context;
    std::unique_ptr<UiRenderer> ui;
    std::unique_ptr<Renderer> renderer;
    std::vector<std::unique_ptr<UiPicture>> pictures;  // by camera
    Image<Rgba8> pixels;
    bool attached = false;

    Result<void> upload(const GuidedFrame& frame) {
        pictures.resize(frame.cameras.size());
        for (std::size_t c = 0; c < frame.cameras.size(); ++c) {
            const auto& grey = frame.pictures[c];
            if (!grey) continue;
            const bool colored =
                frame.cameras[c] == stream_name(StreamKind::color) && frame.set.color;
            if (colored) {
                KINO_TRY(to_rgba8(*frame.set.color, pixels));
            } else {
                pixels.resize(grey->width(), grey->height());
                for (std::size_t i = 0; i < grey->size(); ++i) {
                    const std::uint8_t v = grey->pixels()[i];
                    pixels.pixels()[i] = {v, v, v, 255};
                }
            }
            auto& picture = pictures[c];
            if (!picture || picture->width() != pixels.width() ||
                picture->height() != pixels.height()) {
                KINO_ASSIGN(picture, ui->make_picture(pixels.width(), pixels.height()));
            }
            picture->set(std::as_const(pixels).view());
        }
        return {};
    }

    // True: the user goes on.
    bool hear() {
        const WindowInput input = window->poll(0);
        const bool ends = std::any_of(input.keys.begin(), input.keys.end(), [](const KeyPress& k) {
            return k.key == kKeyEnter || k.key == kKeyPadEnter || k.key == kKeyEscape;
        });
        return !ends && !window->should_close();
    }

    template <class Panels>
    Result<bool> draw(Panels&& panels) {
        if (!hear()) return false;
        KINO_ASSIGN(const std::optional<PictureTarget> target, window->begin_picture());
        if (!target) return true;
        context->begin_frame();
        panels();
        ImDrawData& lists = context->end_frame();
        Scene empty;
        empty.background_top = empty.background_bottom = {0.05f, 0.055f, 0.07f};
        View view;
        view.width = static_cast<int>(target->extent.width);
        view.height = static_cast<int>(target->extent.height);
        FrameOptions options;
        std::optional<Error> trouble;
        options.overlay = [&](graph::FrameGraph& graph, graph::TextureId picture) {
            auto drawn = ui->add(graph, picture, lists);
            if (drawn) return *drawn;
            trouble = drawn.error();
            return picture;
        };
        KINO_TRY(renderer->render(empty, view, *target, options));
        if (trouble) return fail(*trouble);
        KINO_TRY(window->present());
        return true;
    }
};

Result<std::unique_ptr<GuideWindow>> GuideWindow::open(const Board& board) {
    auto state = std::make_unique<State>();
    state->board = board;
    KINO_ASSIGN(state->window,
                Window::open({.title = "Kinoscope: calibration", .width = 1280, .height = 720}));
    KINO_ASSIGN(state->device,
                gpu::Device::create({.validation = is_validated(),
                                     .instance_extensions = state->window->instance_extensions(),
                                     .presents = true}));
    KINO_TRY(state->window->attach(*state->device));
    state->attached = true;
    auto out = std::unique_ptr<GuideWindow>(new GuideWindow(std::move(state)));
    State& s = *out->state_;
    s.context = std::make_unique<UiContext>(s.window->handle(), 17.0f);
    KINO_ASSIGN(s.ui, UiRenderer::create(*s.device));
    s.renderer = std::make_unique<Renderer>(*s.device);
    return out;
}

GuideWindow::GuideWindow(std::unique_ptr<State> state) : state_(std::move(state)) {}

GuideWindow::~GuideWindow() {
    State& s = *state_;
    s.renderer.reset();
    s.pictures.clear();
    s.ui.reset();
    s.context.reset();
    if (s.attached) s.window->detach();
}

Result<bool> GuideWindow::show(const GuidedFrame& frame) {
    State& s = *state_;
    KINO_TRY(s.upload(frame));
    std::vector<UiPicture*> pictures;
    for (const auto& picture : s.pictures) pictures.push_back(picture.get());
    return s.draw([&] { draw_guide(frame, s.board, pictures); });
}

Result<bool> GuideWindow::idle() {
    return state_->draw([] { draw_waiting("waiting for pictures"); });
}

}  // namespace kino
