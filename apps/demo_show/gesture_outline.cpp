#include "apps/demo_show/gesture_outline.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace kino {
namespace {

using glm::vec2;
constexpr double kTurn = 2 * std::numbers::pi;

double part_of(double time_s, double period_s) {
    const double part = time_s / period_s;
    return std::isfinite(part) ? part - std::floor(part) : 0;
}

double soft(double x) {
    x = std::clamp(x, 0.0, 1.0);
    return x * x * (3 - 2 * x);
}

vec2 at_angle(double radius, double rad) {
    return {static_cast<float>(radius * std::sin(rad)),
            static_cast<float>(-radius * std::cos(rad))};
}

OutlineLine line(vec2 from, vec2 to, float strength = 1) {
    return {{from, to}, strength};
}

/// Clockwise from the top, rad.
OutlineLine arc(vec2 middle, double radius, double from, double to, float strength = 1) {
    constexpr int kSteps = 24;
    OutlineLine out{{}, strength};
    for (int i = 0; i <= kSteps; ++i) {
        out.points.push_back(middle + at_angle(radius, from + (to - from) * i / kSteps));
    }
    return out;
}

OutlineLine dot(vec2 middle, double radius, float strength = 1) {
    OutlineLine out = arc(middle, radius, 0, kTurn, strength);
    out.filled = true;
    return out;
}

/// The two strokes of a head that looks along `direction` (length 1).
OutlineLine arrow_head(vec2 tip, vec2 direction, float size, float strength = 1) {
    const vec2 aside(-direction.y, direction.x), back = tip - size * direction;
    return {{back + 0.6f * size * aside, tip, back - 0.6f * size * aside}, strength};
}

using Lines = std::vector<OutlineLine>;

void add_figure(Lines& out, vec2 middle, float size, double arms_up) {
    const auto at = [&](float x, float y) { return middle + size * vec2(x, y); };
    out.push_back(arc(at(0, -0.62f), 0.2 * size, 0, kTurn));
    out.push_back(line(at(0, -0.40f), at(0, 0.30f)));
    out.push_back(line(at(0, 0.30f), at(-0.25f, 0.95f)));
    out.push_back(line(at(0, 0.30f), at(0.25f, 0.95f)));
    for (const float side : {-1.0f, 1.0f}) {
        const vec2 hand = at_angle(0.62, side * (2.4 - 2.0 * arms_up));
        out.push_back(line(at(0, -0.28f), at(hand.x, -0.28f + hand.y)));
    }
}

Lines waving(double time_s) {
    const vec2 elbow(0, 0.85f);
    const double lean = 0.55 * std::sin(kTurn * part_of(time_s, 0.8));
    Lines out = {arc(elbow, 1.35, -0.75, 0.75, 0.5f)};
    out.push_back(
        arrow_head(elbow + at_angle(1.35, 0.78), at_angle(1, 0.78 + kTurn / 4), 0.24f, 0.5f));
    out.push_back(
        arrow_head(elbow + at_angle(1.35, -0.78), at_angle(1, -0.78 - kTurn / 4), 0.24f, 0.5f));
    out.push_back(line(elbow, elbow + at_angle(1.0, lean)));
    out.push_back(dot(elbow + at_angle(1.12, lean), 0.22));
    return out;
}

Lines painting(double time_s) {
    const auto at = [](double angle) {
        return vec2(static_cast<float>(0.85 * std::sin(angle)),
                    static_cast<float>(0.5 * std::sin(2 * angle)));
    };
    const double head = kTurn * part_of(time_s, 2.4);
    Lines out;
    constexpr int kPieces = 5, kSteps = 8;
    for (int piece = 0; piece < kPieces; ++piece) {
        OutlineLine tail{{}, 1.0f - 0.18f * static_cast<float>(piece)};
        for (int i = 0; i <= kSteps; ++i) {
            tail.points.push_back(at(head - 0.9 * (piece + static_cast<double>(i) / kSteps)));
        }
        out.push_back(std::move(tail));
    }
    out.push_back(dot(at(head), 0.2));
    return out;
}

Lines swiping(Hand hand, double time_s) {
    const float way = hand == Hand::left ? 1.0f : -1.0f;
    const double part = part_of(time_s, 1.4);
    const auto there = static_cast<float>(way * (-0.9 + 1.8 * soft(part / 0.45)));
    const auto fading = static_cast<float>(1 - soft((part - 0.7) / 0.25));
    Lines out = {line({-0.95f * way, 0}, {0.95f * way, 0}, 0.4f),
                 arrow_head({way, 0}, {way, 0}, 0.4f, 0.4f)};
    out.push_back(line({-0.9f * way, 0}, {there, 0}, fading));
    out.push_back(dot({there, 0}, 0.26, fading));
    return out;
}

Lines pushing(double time_s) {
    Lines out;
    for (int ring = 0; ring < 3; ++ring) {
        const double part = part_of(time_s + ring * 0.5, 1.5);
        out.push_back(arc({0, 0}, 0.25 + 0.75 * part, 0, kTurn, static_cast<float>(1 - part)));
    }
    out.push_back(dot({0, 0}, 0.16 + 0.12 * soft(part_of(time_s, 0.5))));
    return out;
}

Lines both_hands(double time_s) {
    const double part = part_of(time_s, 3.2);
    const double wide = std::sin(kTurn / 2 * std::clamp(part / 0.5, 0.0, 1.0));
    const double turned = std::sin(kTurn / 2 * std::clamp(part / 0.5 - 1, 0.0, 1.0));
    const double radius = 0.42 + 0.4 * wide, angle = kTurn / 4 + 0.8 * turned;
    const bool turns = part > 0.5;
    Lines out;
    for (const double side : {0.0, kTurn / 2}) {
        const vec2 outwards = at_angle(1, kTurn / 4 + side);
        const float of_zoom = turns ? 0.2f : 0.5f, of_turn = turns ? 0.5f : 0.2f;
        out.push_back(line(0.35f * outwards, 0.95f * outwards, of_zoom));
        out.push_back(arrow_head(outwards, outwards, 0.26f, of_zoom));
        out.push_back(arc({0, 0}, 0.8, kTurn / 4 + side, kTurn / 4 + side + 0.9, of_turn));
        out.push_back(arrow_head(at_angle(0.8, kTurn / 4 + side + 0.95),
                                 at_angle(1, kTurn / 2 + side + 0.95), 0.26f, of_turn));
        out.push_back(dot(at_angle(radius, angle + side), 0.22));
    }
    return out;
}

Lines raising(double time_s) {
    Lines out;
    add_figure(out, {0, 0.15f}, 0.85f, soft(part_of(time_s, 1.6) / 0.5));
    for (const float side : {-1.0f, 1.0f}) {
        out.push_back(line({0.85f * side, 0.3f}, {0.85f * side, -0.7f}, 0.45f));
        out.push_back(arrow_head({0.85f * side, -0.8f}, {0, -1}, 0.26f, 0.45f));
    }
    return out;
}

/// From beside into the picture.
Lines stepping_in(double time_s) {
    const double part = soft(part_of(time_s, 2.2) / 0.6);
    Lines out = {OutlineLine{{{-0.55f, -0.95f}, {-0.55f, 0.95f}}, 0.45f},
                 OutlineLine{{{0.55f, -0.95f}, {0.55f, 0.95f}}, 0.45f}};
    add_figure(out, {static_cast<float>(1.0 - part), 0.05f}, 0.8f, 0);
    out.push_back(
        arrow_head({-0.7f + 0.4f * static_cast<float>(part), 0.0f}, {-1, 0}, 0.24f, 0.45f));
    return out;
}

/// Towards the screen somebody grows, away from it they shrink.
Lines stepping(bool back, double time_s) {
    const double part = soft(part_of(time_s, 1.8) / 0.7);
    const double size = back ? 0.95 - 0.4 * part : 0.55 + 0.4 * part;
    const vec2 way(0, back ? -1.0f : 1.0f);
    Lines out;
    add_figure(out, {-0.25f, static_cast<float>(0.95 - 0.95 * size)}, static_cast<float>(size), 0);
    out.push_back(line(vec2(0.75f, 0) - 0.7f * way, vec2(0.75f, 0) + 0.7f * way, 0.6f));
    out.push_back(arrow_head(vec2(0.75f, 0) + 0.8f * way, way, 0.34f, 0.6f));
    return out;
}

}  // namespace

std::vector<OutlineLine> gesture_outline(DemoHint hint, Hand hand, double time_s) {
    switch (hint) {
        case DemoHint::none:
            return {};
        case DemoHint::step_into_view:
            return stepping_in(time_s);
        case DemoHint::step_back:
            return stepping(true, time_s);
        case DemoHint::step_closer:
            return stepping(false, time_s);
        case DemoHint::wave_to_start:
            return waving(time_s);
        case DemoHint::paint:
            return painting(time_s);
        case DemoHint::swipe:
            return swiping(hand, time_s);
        case DemoHint::push:
            return pushing(time_s);
        case DemoHint::two_hands:
            return both_hands(time_s);
        case DemoHint::raise_both:
            return raising(time_s);
    }
    return {};
}

const char* hint_words(DemoHint hint) {
    switch (hint) {
        case DemoHint::none:
            return "";
        case DemoHint::step_into_view:
            return "step in front";
        case DemoHint::step_back:
            return "step back";
        case DemoHint::step_closer:
            return "come closer";
        case DemoHint::wave_to_start:
            return "wave to start";
        case DemoHint::paint:
            return "paint with a hand";
        case DemoHint::swipe:
            return "swipe: next scene";
        case DemoHint::push:
            return "push to throw";
        case DemoHint::two_hands:
            return "both hands: turn, zoom";
        case DemoHint::raise_both:
            return "hands up: clear";
    }
    return "";
}

const char* praise_words(GestureKind kind) {
    switch (kind) {
        case GestureKind::wave:
        case GestureKind::engaged:
            return "hello";
        case GestureKind::swipe_left:
        case GestureKind::swipe_right:
        case GestureKind::swipe_up:
        case GestureKind::swipe_down:
            return "swipe";
        case GestureKind::push:
            return "push";
        case GestureKind::raise:
        case GestureKind::raise_both:
            return "up";
        case GestureKind::zoom:
            return "zoom";
        case GestureKind::rotate:
            return "turn";
        case GestureKind::t_pose:
            return "straight";
        case GestureKind::dwell:
        case GestureKind::learned:
        case GestureKind::released:
            return "";
    }
    return "";
}

}  // namespace kino
