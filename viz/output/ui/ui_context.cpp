#include "viz/output/ui/ui_context.h"

#include <backends/imgui_impl_glfw.h>
#include <imgui.h>

#include <array>
#include <filesystem>
#include <system_error>

namespace kino {
namespace {

/// Debian's DejaVu if it is there; ImGui's own small bitmap font else.
void load_font(float size_px) {
    constexpr std::array<const char*, 2> kFonts = {
        "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf",
        "/usr/share/fonts/truetype/liberation/LiberationSans-Regular.ttf"};
    ImFontAtlas& fonts = *ImGui::GetIO().Fonts;
    for (const char* path : kFonts) {
        std::error_code error;
        if (!std::filesystem::exists(path, error)) continue;
        if (fonts.AddFontFromFileTTF(path, size_px, nullptr, fonts.GetGlyphRangesDefault()) !=
            nullptr)
            return;
    }
    fonts.AddFontDefault();
}

void set_look() {
    ImGui::StyleColorsDark();
    ImGuiStyle& style = ImGui::GetStyle();
    style.WindowRounding = 6;
    style.FrameRounding = 4;
    style.GrabRounding = 4;
    style.WindowBorderSize = 0;
    style.WindowPadding = {12, 10};
    style.ItemSpacing = {8, 5};
    style.Colors[ImGuiCol_WindowBg] = {0.06f, 0.07f, 0.09f, 0.78f};
    style.Colors[ImGuiCol_PopupBg] = {0.06f, 0.07f, 0.09f, 0.92f};
    style.Colors[ImGuiCol_Text] = {0.92f, 0.93f, 0.95f, 1};
    style.Colors[ImGuiCol_TextDisabled] = {0.62f, 0.65f, 0.70f, 1};
    style.Colors[ImGuiCol_FrameBg] = {0.20f, 0.22f, 0.27f, 0.9f};
    style.Colors[ImGuiCol_SliderGrab] = {0.95f, 0.66f, 0.25f, 1};
    style.Colors[ImGuiCol_SliderGrabActive] = {1.0f, 0.76f, 0.35f, 1};
}

}  // namespace

UiContext::UiContext(float font_px) {
    IMGUI_CHECKVERSION();
    ImGui::CreateContext();
    ImGui::GetIO().IniFilename = nullptr;
    set_look();
    load_font(font_px);
}

UiContext::UiContext(GLFWwindow* window, float font_px) : UiContext(font_px) {
    has_window_ = ImGui_ImplGlfw_InitForOther(window, true);
}

UiContext::~UiContext() {
    if (has_window_) ImGui_ImplGlfw_Shutdown();
    ImGui::DestroyContext();
}

void UiContext::begin_frame() {
    ImGui_ImplGlfw_NewFrame();
    // Pictures are drawn in pixels of the framebuffer, whatever the display's scale.
    ImGui::NewFrame();
}

void UiContext::begin_picture(int width, int height, double dt_s) {
    ImGuiIO& io = ImGui::GetIO();
    io.DisplaySize = {static_cast<float>(width), static_cast<float>(height)};
    io.DeltaTime = static_cast<float>(dt_s);
    ImGui::NewFrame();
}

ImDrawData& UiContext::end_frame() {
    ImGui::Render();
    return *ImGui::GetDrawData();
}

bool UiContext::wants_mouse() const {
    return ImGui::GetIO().WantCaptureMouse;
}
bool UiContext::wants_keyboard() const {
    return ImGui::GetIO().WantTextInput;
}

}  // namespace kino
