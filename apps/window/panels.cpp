#include "apps/window/panels.h"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "apps/viewer/keys.h"
#include "skeleton/gestures/gesture_json.h"
#include "viz/effects/skeleton/skeleton.h"

namespace kino {
namespace {

constexpr float kMargin = 12;
constexpr float kTimelineHeight = 44;
constexpr ImGuiWindowFlags kFixed = ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove |
                                    ImGuiWindowFlags_NoSavedSettings |
                                    ImGuiWindowFlags_NoFocusOnAppearing | ImGuiWindowFlags_NoNav;

constexpr ImU32 kAmber = IM_COL32(255, 186, 92, 255);
/// Where a person's number hangs: the first of these that is known.
constexpr std::array kLabelJoints = {Joint::head, Joint::shoulder_center, Joint::spine,
                                     Joint::hip_center};
const ImVec4 kAmberText(1.0f, 0.75f, 0.38f, 1);

void text(const std::string& line) {
    ImGui::TextUnformatted(line.c_str());
}
void quiet_text(const std::string& line) {
    ImGui::PushStyleColor(ImGuiCol_Text, ImGui::GetStyleColorVec4(ImGuiCol_TextDisabled));
    ImGui::TextUnformatted(line.c_str());
    ImGui::PopStyleColor();
}

/// Two columns: a quiet name, a value.
void row(const char* name, const std::string& value) {
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    quiet_text(name);
    ImGui::TableNextColumn();
    text(value);
}

/// "surface: project vertices, resolve mesh" a line for each room.
std::string passes_text(const std::vector<std::string>& passes) {
    std::string out;
    std::string room;
    for (const std::string& pass : passes) {
        const std::size_t slash = pass.find('/');
        const std::string own_room = pass.substr(0, slash);
        const std::string name = slash == std::string::npos ? pass : pass.substr(slash + 1);
        if (own_room != room) {
            out += fmt::format("{}{}: {}", out.empty() ? "" : "\n", own_room, name);
            room = own_room;
        } else {
            out += ", " + name;
        }
    }
    return out;
}

std::string clock_text(TimeNs time) {
    const double s = to_seconds(time);
    const auto minutes = static_cast<int>(s / 60);
    return fmt::format("{}:{:05.2f}", minutes, s - 60 * minutes);
}

const char* mode_text(LoopMode mode) {
    switch (mode) {
        case LoopMode::once:
            return "once";
        case LoopMode::loop:
            return "loop";
        case LoopMode::ping_pong:
            return "ping-pong";
    }
    return "";
}

}  // namespace

void draw_overlay(const OverlayText& t) {
    ImGui::SetNextWindowPos({kMargin, kMargin});
    ImGui::SetNextWindowSizeConstraints({0, 0}, {380, ImGui::GetIO().DisplaySize.y - 90});
    ImGui::Begin("overlay", nullptr, kFixed | ImGuiWindowFlags_AlwaysAutoResize);
    constexpr float kWrap = 350;
    ImGui::PushTextWrapPos(kWrap);
    text(t.name);
    if (!t.note.empty()) {
        ImGui::PushStyleColor(ImGuiCol_Text, kAmberText);
        text(t.note);
        ImGui::PopStyleColor();
    }
    ImGui::PopTextWrapPos();
    ImGui::Spacing();
    if (ImGui::BeginTable("figures", 2, ImGuiTableFlags_SizingFixedFit)) {
        ImGui::PushTextWrapPos(kWrap);
        for (const std::string& stream : t.streams) {
            row(stream == t.streams.front() ? "streams" : "", stream);
        }
        row("shown", t.mode);
        row("pictures",
            fmt::format("{:.0f} a second, {:.1f} ms each", t.pictures_per_s, t.frame_ms));
        row("frames", fmt::format("{:.1f} a second, {} dropped{}", t.frames_per_s, t.dropped,
                                  t.errors > 0 ? fmt::format(", {} unreadable", t.errors) : ""));
        row("points", fmt::format("{}", t.points));
        std::string groups;
        for (const graph::GroupTime& group : t.groups) {
            groups +=
                fmt::format("{}{}\u00a0{:.1f}", groups.empty() ? "" : ", ", group.group, group.ms);
        }
        row("draw, ms", groups);
        row("frame, ms",
            fmt::format(
                "read {:.1f}, colour {:.1f}, {}register {:.1f}", to_ms(t.stages.read),
                to_ms(t.stages.color),
                t.stages.filter > 0 ? fmt::format("filter {:.1f}, ", to_ms(t.stages.filter)) : "",
                to_ms(t.stages.registration)));
        if (!t.people.empty()) row("bodies", t.people);
        if (t.stages.bodies > 0) {
            std::string split;
            if (t.tracking) {
                split = fmt::format(
                    ": people {:.1f}, parts {:.1f}, joints {:.1f}, fit {:.1f}, filter {:.1f}",
                    to_ms(t.tracking->people), to_ms(t.tracking->parts),
                    to_ms(t.tracking->proposals), to_ms(t.tracking->fit),
                    to_ms(t.tracking->filter));
            }
            row("bodies, ms", fmt::format("{:.1f}{}", to_ms(t.stages.bodies), split));
        }
        row("latency, ms",
            fmt::format("{:.0f}: arrive {:.1f}, process {:.1f}, wait {:.1f}, draw {:.1f}",
                        to_ms(t.latency.total()), to_ms(t.latency.arrive), to_ms(t.latency.process),
                        to_ms(t.latency.wait), to_ms(t.latency.draw)));
        if (!t.alignment.empty()) row("calibration", t.alignment);
        if (!t.recording.empty()) row("recording", t.recording);
        row("device", fmt::format("{:.1f} MB", static_cast<double>(t.device_bytes) / 1e6));
        if (ImGui::GetIO().DisplaySize.y >= 560) row("passes", passes_text(t.passes));
        ImGui::PopTextWrapPos();
        ImGui::EndTable();
    }
    if (!t.last_error.empty()) {
        ImGui::PushTextWrapPos(kWrap);
        ImGui::PushStyleColor(ImGuiCol_Text, kAmberText);
        text(t.last_error);
        ImGui::PopStyleColor();
        ImGui::PopTextWrapPos();
    }
    ImGui::End();
}

void draw_panes(const Panes& panes) {
    if (panes.depth() == nullptr && panes.color() == nullptr && panes.infrared() == nullptr) return;
    const ImVec2 display = ImGui::GetIO().DisplaySize;
    ImGui::SetNextWindowPos({display.x - kMargin, kMargin}, ImGuiCond_Always, {1, 0});
    ImGui::Begin("panes", nullptr, kFixed | ImGuiWindowFlags_AlwaysAutoResize);
    const auto picture = [](UiPicture& shown) {
        ImGui::Image(shown.id(),
                     {static_cast<float>(shown.width()), static_cast<float>(shown.height())});
    };
    if (panes.depth() != nullptr) {
        quiet_text("depth");
        picture(*panes.depth());
        picture(*panes.legend());
        const std::string near_text = fmt::format("{:.2f} m", panes.range().near_m);
        const std::string far_text = fmt::format("{:.2f} m", panes.range().far_m);
        text(near_text);
        ImGui::SameLine(ImGui::GetStyle().WindowPadding.x + Panes::kWidth -
                        ImGui::CalcTextSize(far_text.c_str()).x);
        text(far_text);
    }
    if (panes.color() != nullptr) {
        quiet_text("colour");
        picture(*panes.color());
    }
    if (panes.infrared() != nullptr) {
        quiet_text("infrared");
        picture(*panes.infrared());
    }
    ImGui::End();
}

TimelineRequest draw_timeline(const LiveStatus& status, TimeNs now, TimeNs length) {
    TimelineRequest request;
    const ImVec2 display = ImGui::GetIO().DisplaySize;
    ImGui::SetNextWindowPos({kMargin, display.y - kMargin - kTimelineHeight});
    ImGui::SetNextWindowSize({display.x - 2 * kMargin, kTimelineHeight});
    ImGui::Begin("time line", nullptr, kFixed);
    if (ImGui::Button(status.paused ? "play" : "pause", {64, 0})) request.toggle_pause = true;
    ImGui::SameLine();
    const std::string words =
        fmt::format("frame {} of {}    {} / {}    {:.2g}x    {}    F1: keys", status.position + 1,
                    std::max<std::int64_t>(1, status.frame_count), clock_text(now),
                    clock_text(length), status.speed, mode_text(status.mode));
    const float words_width = ImGui::CalcTextSize(words.c_str()).x;
    const float slider_width = ImGui::GetContentRegionAvail().x - words_width - 16;
    int index = static_cast<int>(status.position);
    const int last = static_cast<int>(std::max<std::int64_t>(0, status.frame_count - 1));
    ImGui::SetNextItemWidth(std::max(40.0f, slider_width));
    if (last > 0) {
        if (ImGui::SliderInt("##time", &index, 0, last, "",
                             ImGuiSliderFlags_AlwaysClamp | ImGuiSliderFlags_NoInput)) {
            request.seek = index;
        }
    } else {
        quiet_text(status.frame_count == 1 ? "one frame" : "live");
        ImGui::SameLine(ImGui::GetWindowWidth() - words_width - ImGui::GetStyle().WindowPadding.x);
    }
    ImGui::SameLine();
    ImGui::AlignTextToFramePadding();
    text(words);
    ImGui::End();
    return request;
}

void draw_controls(ControlsDesk& desk) {
    const std::vector<ControlsDesk::Knob> knobs = desk.knobs();
    if (knobs.empty()) return;
    const ImVec2 display = ImGui::GetIO().DisplaySize;
    ImGui::SetNextWindowPos({kMargin, display.y - kTimelineHeight - 2 * kMargin}, ImGuiCond_Always,
                            {0, 1});
    ImGui::Begin("controls", nullptr, kFixed | ImGuiWindowFlags_AlwaysAutoResize);
    for (const ControlsDesk::Knob& knob : knobs) {
        const Control& control = knob.control;
        ImGui::PushID(control.id.c_str());
        ImGui::SetNextItemWidth(200);
        if (control.kind == ControlKind::toggle) {
            bool on = knob.value != 0;
            if (ImGui::Checkbox(control.name.c_str(), &on)) desk.set(control.id, on ? 1 : 0);
        } else if (control.kind == ControlKind::menu) {
            const auto at = static_cast<std::size_t>(std::max(0.0, knob.value));
            const char* shown = at < control.menu.size() ? control.menu[at].c_str() : "";
            if (ImGui::BeginCombo(control.name.c_str(), shown)) {
                for (std::size_t i = 0; i < control.menu.size(); ++i) {
                    if (ImGui::Selectable(control.menu[i].c_str(), i == at)) {
                        desk.set(control.id, static_cast<double>(i));
                    }
                }
                ImGui::EndCombo();
            }
        } else {
            auto value = static_cast<float>(knob.value);
            ImGui::SliderFloat(control.name.c_str(), &value, static_cast<float>(control.minimum),
                               static_cast<float>(control.maximum), "%.0f");
            if (ImGui::IsItemActive()) {
                const double steps =
                    control.step > 0 ? std::round((value - control.minimum) / control.step) : 0;
                desk.set(control.id, control.step > 0 ? control.minimum + steps * control.step
                                                      : static_cast<double>(value));
            }
        }
        if (!knob.error.empty()) quiet_text(knob.error);
        ImGui::PopID();
    }
    ImGui::End();
}

void draw_banner(const std::string& words) {
    const ImVec2 display = ImGui::GetIO().DisplaySize;
    const ImVec2 size = ImGui::CalcTextSize(words.c_str());
    const ImVec2 at((display.x - size.x) / 2, display.y / 3);
    ImDrawList& list = *ImGui::GetForegroundDrawList();
    list.AddRectFilled({at.x - 14, at.y - 8}, {at.x + size.x + 14, at.y + size.y + 8},
                       IM_COL32(60, 34, 10, 235), 6);
    list.AddText(at, kAmber, words.c_str());
}

bool draw_help() {
    const ImVec2 display = ImGui::GetIO().DisplaySize;
    ImGui::SetNextWindowPos({display.x / 2, display.y / 2}, ImGuiCond_Always, {0.5f, 0.5f});
    ImGui::SetNextWindowBgAlpha(0.94f);
    ImGui::Begin("keys", nullptr, kFixed | ImGuiWindowFlags_AlwaysAutoResize);
    ImGui::SetWindowFocus();
    text("Keys");
    ImGui::Spacing();
    struct Line {
        const char* shown;
        const char* help;
    };
    std::vector<Line> lines;
    for (const KeyEntry& entry : key_table()) lines.push_back({entry.shown, entry.help});
    for (const HelpLine& line : mouse_table()) lines.push_back({line.shown, line.help});
    const std::size_t half = (lines.size() + 1) / 2;
    if (ImGui::BeginTable("keys", 4, ImGuiTableFlags_SizingFixedFit)) {
        for (std::size_t i = 0; i < half; ++i) {
            ImGui::TableNextRow();
            for (const std::size_t at : {i, i + half}) {
                if (at >= lines.size()) break;
                ImGui::TableNextColumn();
                ImGui::TextColored(kAmberText, "%s", lines[at].shown);
                ImGui::TableNextColumn();
                text(fmt::format("{}      ", lines[at].help));
            }
        }
        ImGui::EndTable();
    }
    const bool elsewhere = ImGui::IsMouseClicked(0) && !ImGui::IsWindowHovered();
    ImGui::End();
    return !elsewhere;
}

void draw_cursor_depth(const glm::dvec2& cursor_px, float depth_m) {
    const std::string label = fmt::format("{:.2f} m", depth_m);
    const ImVec2 size = ImGui::CalcTextSize(label.c_str());
    const ImVec2 at(static_cast<float>(cursor_px.x) + 16, static_cast<float>(cursor_px.y) + 12);
    ImDrawList& list = *ImGui::GetBackgroundDrawList();
    list.AddRectFilled({at.x - 5, at.y - 3}, {at.x + size.x + 5, at.y + size.y + 3},
                       IM_COL32(10, 12, 16, 200), 4);
    list.AddText(at, IM_COL32(240, 240, 245, 255), label.c_str());
}

void draw_measure(const Measure& measure, const View& view, bool active) {
    ImDrawList& list = *ImGui::GetBackgroundDrawList();
    std::vector<ImVec2> seen;
    for (const glm::dvec3& point : measure.points()) {
        const auto pixel = project_to_pixel(view, point);
        if (!pixel) continue;
        seen.emplace_back(static_cast<float>(pixel->x) + 0.5f, static_cast<float>(pixel->y) + 0.5f);
        list.AddCircleFilled(seen.back(), 5, kAmber);
        list.AddCircle(seen.back(), 6, IM_COL32(10, 12, 16, 255), 0, 2);
    }
    const auto distance = measure.distance_m();
    if (seen.size() == 2 && distance) {
        list.AddLine(seen[0], seen[1], IM_COL32(10, 12, 16, 200), 4);
        list.AddLine(seen[0], seen[1], kAmber, 2);
        const std::string label = fmt::format("{:.3f} m", *distance);
        const ImVec2 size = ImGui::CalcTextSize(label.c_str());
        const ImVec2 at((seen[0].x + seen[1].x - size.x) / 2, (seen[0].y + seen[1].y) / 2 + 8);
        list.AddRectFilled({at.x - 5, at.y - 3}, {at.x + size.x + 5, at.y + size.y + 3},
                           IM_COL32(10, 12, 16, 220), 4);
        list.AddText(at, kAmber, label.c_str());
    }
    if (active && measure.points().size() < 2) {
        draw_message(measure.points().empty() ? "measure: click the first point"
                                              : "measure: click the second point");
    }
}

void draw_body_labels(const ProcessedFrame& frame, const View& view) {
    if (!frame.set.bodies) return;
    ImDrawList& list = *ImGui::GetBackgroundDrawList();
    for (const Body& body : frame.set.bodies->bodies) {
        const auto highest =
            std::find_if(std::begin(kLabelJoints), std::end(kLabelJoints),
                         [&](Joint joint) { return body[joint].state != JointState::lost; });
        if (highest == std::end(kLabelJoints)) continue;
        constexpr double kAbove = 0.2;  // metres, beyond the hair
        const glm::dvec3 up = frame.set.world_from_depth.rotation * glm::dvec3(0, -1, 0);
        const glm::dvec3 at = frame.set.world_from_depth * glm::dvec3(body[*highest].position_m);
        const auto pixel = project_to_pixel(view, at + kAbove * up);
        if (!pixel) continue;
        const std::string label =
            fmt::format("{}{}", body.id, body.id == frame.primary_id ? " *" : "");
        const glm::vec3 c = 255.0f * person_color(body.id);
        const ImU32 color =
            IM_COL32(static_cast<int>(c.r), static_cast<int>(c.g), static_cast<int>(c.b), 255);
        const ImVec2 size = ImGui::CalcTextSize(label.c_str());
        const ImVec2 corner(static_cast<float>(pixel->x) - size.x / 2,
                            static_cast<float>(pixel->y) - size.y / 2);
        list.AddRectFilled({corner.x - 7, corner.y - 3},
                           {corner.x + size.x + 7, corner.y + size.y + 3},
                           IM_COL32(10, 12, 16, 210), 5);
        list.AddText(corner, color, label.c_str());
    }
}

void GestureLines::add(const GestureEvent& event, TimeNs now) {
    // A zoom or a turn that goes on keeps its line.
    if (event.phase == GesturePhase::change || event.phase == GesturePhase::end) {
        for (Line& line : lines_) {
            if (line.event.kind == event.kind && line.event.body_id == event.body_id &&
                line.event.phase != GesturePhase::once && line.event.phase != GesturePhase::end) {
                line = {event, now};
                return;
            }
        }
    }
    constexpr std::size_t kMost = 5;
    lines_.push_back({event, now});
    if (lines_.size() > kMost) lines_.erase(lines_.begin());
}

void GestureLines::draw(TimeNs now) {
    constexpr TimeNs kShown = 3 * kNsPerSecond;
    std::erase_if(lines_, [&](const Line& line) { return now - line.since >= kShown; });
    const ImVec2 display = ImGui::GetIO().DisplaySize;
    ImDrawList& list = *ImGui::GetForegroundDrawList();
    const float height = ImGui::GetTextLineHeight() + 12;
    float y = display.y - kTimelineHeight - 5 * kMargin - 2 * height;
    for (auto line = lines_.rbegin(); line != lines_.rend(); ++line, y -= height) {
        const auto left = static_cast<float>(to_seconds(kShown - (now - line->since)));
        const auto alpha = std::min(1.0f, left);
        const std::string words = gesture_text(line->event);
        const ImVec2 size = ImGui::CalcTextSize(words.c_str());
        const ImVec2 at((display.x - size.x) / 2, y);
        const glm::vec3 c = 255.0f * person_color(line->event.body_id);
        list.AddRectFilled({at.x - 12, at.y - 5}, {at.x + size.x + 12, at.y + size.y + 5},
                           IM_COL32(15, 17, 22, static_cast<int>(215 * alpha)), 6);
        list.AddText(at,
                     IM_COL32(static_cast<int>(c.r), static_cast<int>(c.g), static_cast<int>(c.b),
                              static_cast<int>(255 * alpha)),
                     words.c_str());
    }
}

void draw_message(const std::string& words) {
    const ImVec2 display = ImGui::GetIO().DisplaySize;
    const ImVec2 size = ImGui::CalcTextSize(words.c_str());
    const ImVec2 at((display.x - size.x) / 2, display.y - kTimelineHeight - 3 * kMargin - size.y);
    ImDrawList& list = *ImGui::GetForegroundDrawList();
    list.AddRectFilled({at.x - 12, at.y - 6}, {at.x + size.x + 12, at.y + size.y + 6},
                       IM_COL32(15, 17, 22, 225), 6);
    list.AddText(at, IM_COL32(240, 240, 245, 255), words.c_str());
}

}  // namespace kino
