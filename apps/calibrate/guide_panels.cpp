#include "apps/calibrate/guide_panels.h"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <array>

namespace kino {
namespace {

constexpr float kMargin = 12;
constexpr float kBottom = 132;  // of the window, for words and figures
constexpr ImGuiWindowFlags kFixed =
    ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
    ImGuiWindowFlags_NoFocusOnAppearing | ImGuiWindowFlags_NoNav | ImGuiWindowFlags_NoBackground |
    ImGuiWindowFlags_NoBringToFrontOnFocus;
constexpr ImU32 kAmber = IM_COL32(255, 186, 92, 255);
constexpr ImU32 kGreen = IM_COL32(110, 220, 130, 255);
constexpr ImU32 kRed = IM_COL32(240, 110, 100, 255);
constexpr ImU32 kQuiet = IM_COL32(160, 166, 178, 255);
constexpr ImU32 kLight = IM_COL32(235, 238, 242, 255);

ImU32 color_of(GuideState state) {
    switch (state) {
        case GuideState::no_board:
        case GuideState::blurred:
            return kRed;
        case GuideState::holding:
        case GuideState::taken:
        case GuideState::enough:
            return kGreen;
        case GuideState::moving:
        case GuideState::known:
            return kAmber;
    }
    return kLight;
}

// A picture's place on the screen: its pixels' edges run from -0.5.
struct Placed {
    ImVec2 from;
    float scale;
    [[nodiscard]] ImVec2 at(double x, double y) const {
        return {from.x + scale * static_cast<float>(x + 0.5),
                from.y + scale * static_cast<float>(y + 0.5)};
    }
};

void draw_fields(ImDrawList& list, const Placed& placed, const GuideCoverage& coverage, int width,
                 int height) {
    const double w = static_cast<double>(width) / GuideCoverage::kColumns;
    const double h = static_cast<double>(height) / GuideCoverage::kRows;
    for (int row = 0; row < GuideCoverage::kRows; ++row) {
        for (int column = 0; column < GuideCoverage::kColumns; ++column) {
            const ImVec2 a = placed.at(column * w - 0.5, row * h - 0.5);
            const ImVec2 b = placed.at((column + 1) * w - 0.5, (row + 1) * h - 0.5);
            const int views = coverage.views(column, row);
            if (views == 0) {
                list.AddRectFilled(a, b, IM_COL32(0, 0, 0, 120));
            } else {
                const int strength = std::min(80, 25 + 15 * views);
                list.AddRectFilled(a, b, IM_COL32(90, 220, 120, strength));
            }
            list.AddRect(a, b, IM_COL32(255, 255, 255, 40));
        }
    }
}

void draw_board(ImDrawList& list, const Placed& placed, const Board& board,
                const BoardSighting& sighting, ImU32 color) {
    const SeenCorner* before = nullptr;
    for (const SeenCorner& corner : sighting.corners) {
        const ImVec2 at = placed.at(corner.px.x, corner.px.y);
        if (before && before->id / board.columns == corner.id / board.columns) {
            list.AddLine(placed.at(before->px.x, before->px.y), at, color, 1.5f);
        }
        list.AddCircle(at, corner.id == 0 ? 7.0f : 3.5f, color, 0, 1.5f);
        before = &corner;
    }
}

void draw_camera(ImDrawList& list, const ImVec2& from, const ImVec2& room, const GuidedFrame& frame,
                 std::size_t camera, const Board& board, UiPicture* picture) {
    if (!picture || !frame.pictures[camera]) {
        list.AddText({from.x + kMargin, from.y + kMargin}, kQuiet,
                     fmt::format("{}: no picture", frame.cameras[camera]).c_str());
        return;
    }
    const int width = frame.pictures[camera]->width();
    const int height = frame.pictures[camera]->height();
    const float scale =
        std::min(room.x / static_cast<float>(width), room.y / static_cast<float>(height));
    const Placed placed{{from.x + (room.x - scale * static_cast<float>(width)) / 2,
                         from.y + (room.y - scale * static_cast<float>(height)) / 2},
                        scale};
    const ImVec2 to{placed.from.x + scale * static_cast<float>(width),
                    placed.from.y + scale * static_cast<float>(height)};
    list.AddImage(picture->id(), placed.from, to);
    if (const GuideCoverage* coverage = frame.guide.coverage(camera)) {
        draw_fields(list, placed, *coverage, width, height);
    }
    const auto& seen = frame.look[camera];
    if (seen && seen->board && !seen->board->mirrored) {
        draw_board(list, placed, board, *seen->board, color_of(frame.answer.state));
    }
    if (frame.answer.take) list.AddRect(placed.from, to, kGreen, 0, 0, 6);
    std::string words = frame.cameras[camera];
    if (const auto percent = frame.guide.expected_focal_percent(camera)) {
        words += fmt::format(": focal length to about {:.2f} %", *percent);
    }
    list.AddText({placed.from.x + 6, placed.from.y + 4}, kLight, words.c_str());
}

void draw_dots(ImDrawList& list, const ImVec2& at, const char* name, int have, int want, bool now) {
    list.AddText(at, now ? kLight : kQuiet, name);
    for (int i = 0; i < want; ++i) {
        const ImVec2 middle{at.x + 76 + 14.0f * static_cast<float>(i), at.y + 9};
        if (i < have) {
            list.AddCircleFilled(middle, 5, kGreen);
        } else {
            list.AddCircle(middle, 5, now ? kAmber : kQuiet, 0, 1.5f);
        }
    }
}

void draw_figures(ImDrawList& list, const ImVec2& at, const GuidedFrame& frame) {
    const GuideCoverage* coverage = frame.guide.coverage(0);
    if (!coverage) return;
    const auto& stand = frame.guide.stand(0);
    constexpr std::array<const char*, 4> kSides = {"left", "right", "back", "forward"};
    list.AddText(at, kQuiet, "tilted");
    for (std::size_t side = 0; side < kSides.size(); ++side) {
        draw_dots(list, {at.x, at.y + 22 + 20.0f * static_cast<float>(side)}, kSides[side],
                  coverage->views(static_cast<GuideCoverage::Side>(side)),
                  GuideCoverage::kWantedTilts, stand && stand->away[side]);
    }
    constexpr std::array<const char*, 3> kSteps = {"near", "middle", "far"};
    const float x = at.x + 140;
    list.AddText({x, at.y}, kQuiet, "distance");
    for (std::size_t i = 0; i < kSteps.size(); ++i) {
        const auto distance = static_cast<GuideCoverage::Distance>(i);
        draw_dots(list, {x, at.y + 22 + 20.0f * static_cast<float>(i)}, kSteps[i],
                  coverage->views(distance), GuideCoverage::kWantedDistances[i],
                  stand && stand->distance == distance);
    }
}

ImDrawList& begin_screen() {
    ImGui::SetNextWindowPos({0, 0});
    ImGui::SetNextWindowSize(ImGui::GetIO().DisplaySize);
    ImGui::Begin("guide", nullptr, kFixed);
    return *ImGui::GetWindowDrawList();
}

}  // namespace

void draw_guide(const GuidedFrame& frame, const Board& board,
                const std::vector<UiPicture*>& pictures) {
    const ImVec2 display = ImGui::GetIO().DisplaySize;
    ImDrawList& list = begin_screen();
    const auto count = static_cast<float>(frame.cameras.size());
    const ImVec2 room{(display.x - kMargin * (count + 1)) / count,
                      std::max(40.0f, display.y - kBottom - kMargin)};
    for (std::size_t c = 0; c < frame.cameras.size(); ++c) {
        const ImVec2 from{kMargin + (room.x + kMargin) * static_cast<float>(c), kMargin};
        draw_camera(list, from, room, frame, c, board, pictures[c]);
    }
    const float top = display.y - kBottom + kMargin;
    ImFont* font = ImGui::GetFont();
    list.AddText(font, 2 * ImGui::GetFontSize(), {kMargin, top}, color_of(frame.answer.state),
                 frame.answer.words.c_str());
    double covered = 0;
    for (std::size_t c = 0; c < frame.cameras.size(); ++c) {
        const GuideCoverage* coverage = frame.guide.coverage(c);
        covered += coverage ? coverage->field_share() / count : 0;
    }
    const std::string figures = fmt::format(
        "{} views, {:.0f} % of the fields    this view: {:.0f} % smaller deviations, "
        "{} new fields    found in {:.0f} ms",
        frame.guide.taken(), 100 * covered, 100 * frame.answer.fall, frame.answer.new_fields,
        to_ms(frame.detection));
    list.AddText({kMargin, top + 46}, kLight, figures.c_str());
    list.AddText({kMargin, top + 72}, kQuiet,
                 "left and right as in the picture; Enter: solve with what is there");
    draw_figures(list, {std::max(kMargin, display.x - 290), top}, frame);
    ImGui::End();
}

void draw_waiting(const char* words) {
    begin_screen().AddText({kMargin, kMargin}, kLight, words);
    ImGui::End();
}

}  // namespace kino
