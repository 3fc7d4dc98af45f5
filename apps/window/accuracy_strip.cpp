#include "apps/window/accuracy_strip.h"

#include <fmt/format.h>
#include <imgui.h>

#include <array>
#include <cmath>
#include <string>

namespace kino {
namespace {

constexpr float kStripMargin = 12;
constexpr float kAboveTimeline = 44 + 2 * kStripMargin;
constexpr float kStripWidth = 300;
constexpr float kRoomBelowPanes = 760;
constexpr float kPanesWidth = 276;
constexpr std::int64_t kTrueErrorEvery = 30;
constexpr std::size_t kMostParts = 6;
constexpr float kLeastTargetMs = 5;
constexpr float kMostTargetMs = 500;

void line(const char* name, const std::string& value) {
    ImGui::TextDisabled("%s", name);
    ImGui::SameLine(70);
    ImGui::PushTextWrapPos(kStripWidth);
    ImGui::TextUnformatted(value.c_str());
    ImGui::PopTextWrapPos();
}

/// Who holds the rate.
constexpr std::array kOwners = {"nobody", "budget", "zoom: reactive", "zoom: predictive",
                                "zoom: head"};

int owner_of(const FrameBudget& budget, const ZoomChooser& chooser) {
    if (budget.mode() == GovernorMode::automatic) return 1;
    return chooser.on() ? 1 + static_cast<int>(chooser.options().by) : 0;
}

void set_owner(int owner, FrameBudget& budget, ZoomChooser& chooser) {
    ZoomChooserOptions zoom = chooser.options();
    zoom.by = owner < 2 ? SceneZoomBy::fixed : static_cast<SceneZoomBy>(owner - 1);
    chooser.set(zoom);
    budget.set_zoom(1);
    budget.set_mode(owner == 1 ? GovernorMode::automatic : GovernorMode::fixed);
}

std::string decibels(double db) {
    return std::isfinite(db) ? fmt::format("{:.1f} dB", db) : "equal";
}

}  // namespace

bool AccuracyStrip::true_error_due(std::int64_t picture) const {
    return wants_true_error_ && picture % kTrueErrorEvery == kTrueErrorEvery - 1;
}

void AccuracyStrip::draw(FrameBudget& budget, ZoomChooser& chooser) {
    const ImVec2 display = ImGui::GetIO().DisplaySize;
    // Beside the sensor's images where there is no room below them.
    const float right = display.y < kRoomBelowPanes ? kPanesWidth : 0;
    ImGui::SetNextWindowPos({display.x - kStripMargin - right, display.y - kAboveTimeline},
                            ImGuiCond_Always, {1, 1});
    ImGui::Begin("accuracy", nullptr,
                 ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove |
                     ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoFocusOnAppearing |
                     ImGuiWindowFlags_NoNav | ImGuiWindowFlags_AlwaysAutoResize);
    ImGui::Dummy({kStripWidth, 0});
    const FrameChoice& choice = budget.choice();
    std::string levels;
    for (const std::string& level : choice.levels) {
        levels += (levels.empty() ? "" : ", ") + level;
    }
    line("drawn", levels.empty() ? "in full" : levels);
    std::string parts;
    std::size_t shown = 0;
    for (const PictureCost::Part& part : budget.parts()) {
        if (part.ms < 0.05 || ++shown > kMostParts) continue;
        parts += fmt::format("{}{}\u00a0{:.1f}", parts.empty() ? "" : ", ", part.name, part.ms);
    }
    if (!parts.empty()) line("ms", parts);
    if (choice.predicted_ms > 0) {
        line("picture",
             fmt::format("{:.1f} ms of {:.0f}", choice.predicted_ms, budget.target_ms()));
    }
    if (chooser.on()) line("zoom", chooser.words());
    line("error", fmt::format("{:.4f} FLIP, estimated", choice.estimated_error));
    if (wants_true_error_ && true_error_) {
        line("", fmt::format("{:.4f} FLIP, {}, {:.2f} % failed", true_error_->flip,
                             decibels(true_error_->psnr_db), 100 * true_error_->failed_pixels));
    }
    int owner = owner_of(budget, chooser);
    ImGui::SetNextItemWidth(kStripWidth / 2);
    if (ImGui::Combo("rate", &owner, kOwners.data(), static_cast<int>(kOwners.size()))) {
        set_owner(owner, budget, chooser);
    }
    ImGui::SameLine();
    ImGui::Checkbox("true error", &wants_true_error_);
    // Left is quick, right is good.
    auto target_ms = static_cast<float>(budget.target_ms());
    ImGui::SetNextItemWidth(kStripWidth);
    if (ImGui::SliderFloat("##target", &target_ms, kLeastTargetMs, kMostTargetMs,
                           "%.0f ms a picture",
                           ImGuiSliderFlags_Logarithmic | ImGuiSliderFlags_AlwaysClamp |
                               ImGuiSliderFlags_NoInput)) {
        budget.set_target(target_ms);
        chooser.set_target(target_ms);
    }
    ImGui::End();
}

}  // namespace kino
