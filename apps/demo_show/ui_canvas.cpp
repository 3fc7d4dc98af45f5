#include "apps/demo_show/ui_canvas.h"

#include <imgui.h>

#include <algorithm>
#include <glm/common.hpp>
#include <vector>

namespace kino {
namespace {

ImU32 packed(glm::vec4 color) {
    return ImGui::ColorConvertFloat4ToU32({color.r, color.g, color.b, color.a});
}

ImVec2 of(glm::vec2 v) {
    return {v.x, v.y};
}

std::vector<ImVec2> all_of(std::span<const glm::vec2> points) {
    std::vector<ImVec2> out;
    out.reserve(points.size());
    for (const glm::vec2& p : points) out.push_back(of(p));
    return out;
}

void put_words(ImDrawList& list, std::string_view text, glm::vec2 at, float height, ImU32 color) {
    list.AddText(ImGui::GetFont(), height, of(at), color, text.data(), text.data() + text.size());
}

}  // namespace

UiCanvas::UiCanvas(int width, int height)
    : size_(static_cast<float>(width), static_cast<float>(height)),
      list_(ImGui::GetForegroundDrawList()) {}

void UiCanvas::line(std::span<const glm::vec2> points, glm::vec4 color, float width) const {
    const std::vector<ImVec2> line = all_of(points);
    list_->AddPolyline(line.data(), static_cast<int>(line.size()), packed(color), 0, width);
}

void UiCanvas::filled(std::span<const glm::vec2> convex, glm::vec4 color) const {
    const std::vector<ImVec2> line = all_of(convex);
    list_->AddConvexPolyFilled(line.data(), static_cast<int>(line.size()), packed(color));
}

void UiCanvas::disc(glm::vec2 middle, float radius, glm::vec4 color) const {
    list_->AddCircleFilled(of(middle), radius, packed(color), 48);
}

void UiCanvas::ring(glm::vec2 middle, float radius, glm::vec4 color, float width) const {
    list_->AddCircle(of(middle), radius, packed(color), 48, width);
}

void UiCanvas::part_ring(glm::vec2 middle, float radius, float part, glm::vec4 color,
                         float width) const {
    constexpr float kTop = -1.5707963f, kTurn = 6.2831853f;
    list_->PathArcTo(of(middle), radius, kTop, kTop + kTurn * std::clamp(part, 0.0f, 1.0f), 48);
    list_->PathStroke(packed(color), 0, width);
}

void UiCanvas::plate(glm::vec2 from, glm::vec2 to, glm::vec4 color, float rounding) const {
    list_->AddRectFilled(of(from), of(to), packed(color), rounding);
}

float UiCanvas::width_of(std::string_view text, float height) const {
    return ImGui::GetFont()
        ->CalcTextSizeA(height, 1e6f, 0, text.data(), text.data() + text.size())
        .x;
}

void UiCanvas::words(std::string_view text, glm::vec2 middle, float height, glm::vec4 color) const {
    if (text.empty() || !(height >= 1)) return;
    const float room = 0.96f * size_.x, wanted = width_of(text, height);
    if (wanted > room) height *= room / wanted;
    const glm::vec2 half(0.5f * std::min(wanted, room), 0.5f * height);
    const glm::vec2 edge = glm::min(half + 0.02f * size_.y, 0.5f * size_);
    middle = glm::clamp(middle, edge, size_ - edge);
    const glm::vec2 at = middle - half;
    const ImU32 dark = packed({0.02f, 0.02f, 0.04f, 0.85f * color.a});
    const float rim = std::max(1.0f, 0.055f * height);
    for (const glm::vec2 aside : {glm::vec2(1, 0), glm::vec2(-1, 0), glm::vec2(0, 1),
                                  glm::vec2(0, -1), glm::vec2(0.7f, 0.7f), glm::vec2(-0.7f, 0.7f),
                                  glm::vec2(0.7f, -0.7f), glm::vec2(-0.7f, -0.7f)}) {
        put_words(*list_, text, at + rim * aside, height, dark);
    }
    put_words(*list_, text, at, height, packed(color));
}

void UiCanvas::words_from(std::string_view text, glm::vec2 left_middle, float height,
                          glm::vec4 color) const {
    put_words(*list_, text, left_middle - glm::vec2(0, 0.5f * height), height, packed(color));
}

}  // namespace kino
