#include "apps/demo_show/guidance_overlay.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <vector>

#include "apps/demo_show/gesture_outline.h"

namespace kino {
namespace {

constexpr float kOutline = 0.10f;  ///< half its size, as a part of the picture's height
constexpr float kLine = 0.0085f;
constexpr double kFadeS = 0.3;
constexpr double kPraiseS = 0.7;
constexpr double kFollowS = 0.5;
constexpr float kFar = 0.42f;  ///< the other hand, as a part of the picture's height
constexpr glm::vec4 kWhite{1, 1, 1, 1};

bool praises(const DemoGuidance& guidance) {
    return guidance.praised_ago_s >= 0 && guidance.praised_ago_s < kPraiseS &&
           praise_words(guidance.praised)[0] != '\0';
}

std::optional<glm::vec2> anchor_px(const UiCanvas& canvas, const View& view,
                                   const std::optional<glm::dvec3>& world_m) {
    if (!world_m) return std::nullopt;
    const auto pixel = project_to_pixel(view, *world_m);
    if (!pixel || !std::isfinite(pixel->x) || !std::isfinite(pixel->y)) return std::nullopt;
    const glm::vec2 at(*pixel);
    const glm::vec2 size = canvas.size();
    const bool near = at.x > -0.2f * size.x && at.x < 1.2f * size.x && at.y > -0.2f * size.y &&
                      at.y < 1.2f * size.y;
    return near ? std::optional(at) : std::nullopt;
}

/// Where the outline's middle goes: on the side of the joint that is nearer to the picture's edge,
/// if it fits there.
glm::vec2 place_of(const UiCanvas& canvas, const std::optional<glm::vec2>& anchor) {
    const glm::vec2 size = canvas.size();
    const float half = canvas.high(1.3f * kOutline), below = canvas.high(0.12f);
    const glm::vec2 least(half + canvas.high(0.02f), half + canvas.high(0.02f));
    const glm::vec2 most(size.x - least.x, size.y - half - below);
    if (!anchor) return {0.5f * size.x, most.y};
    const float aside = canvas.high(0.24f);
    float x = anchor->x + (anchor->x < 0.5f * size.x ? -aside : aside);
    if (x < least.x || x > most.x) x = anchor->x + (x < least.x ? aside : -aside);
    return glm::clamp(glm::vec2(x, anchor->y), least, glm::max(least, most));
}

void draw_hint(const UiCanvas& canvas, const DemoGuidance& guidance, glm::vec2 middle,
               double shown_s, glm::vec3 color) {
    const auto shown = static_cast<float>(std::clamp(shown_s / kFadeS, 0.0, 1.0));
    const float half = canvas.high(kOutline), width = canvas.high(kLine);
    canvas.disc(middle, 1.42f * half, {0.02f, 0.02f, 0.05f, 0.55f * shown});
    canvas.ring(middle, 1.42f * half, {glm::vec3(1), 0.25f * shown}, 0.5f * width);
    if (guidance.progress > 0.01) {
        canvas.part_ring(middle, 1.42f * half, static_cast<float>(guidance.progress),
                         {color, shown}, 1.2f * width);
    }
    for (const OutlineLine& line :
         gesture_outline(guidance.hint, guidance.hand, guidance.shown_s)) {
        std::vector<glm::vec2> points;
        points.reserve(line.points.size());
        for (const glm::vec2& p : line.points) points.push_back(middle + half * p);
        const glm::vec4 shade(color, shown * line.strength);
        if (line.filled) {
            canvas.filled(points, shade);
        } else {
            canvas.line(points, shade, width);
        }
    }
    canvas.words(hint_words(guidance.hint),
                 middle + glm::vec2(0, 1.42f * half + canvas.high(0.05f)),
                 canvas.high(kGuidanceWords), kWhite * glm::vec4(1, 1, 1, shown));
}

/// Goes on while the hands do; a flash would hide what they change.
bool lasts(GestureKind kind) {
    return kind == GestureKind::zoom || kind == GestureKind::rotate;
}

/// Bright at once, then wider and fainter.
void draw_praise(const UiCanvas& canvas, const DemoGuidance& guidance, glm::vec2 at,
                 glm::vec3 color) {
    const auto part = static_cast<float>(guidance.praised_ago_s / kPraiseS);
    const float fading = 1 - part, half = canvas.high(kOutline);
    if (!lasts(guidance.praised)) {
        canvas.disc(at, half * (0.35f + 0.4f * part), {color, 0.75f * fading * fading});
        canvas.ring(at, half * (0.5f + 1.6f * part), {glm::vec3(1), fading},
                    canvas.high(1.6f * kLine) * fading);
    }
    canvas.words(praise_words(guidance.praised), at - glm::vec2(0, half * (1.5f + part)),
                 canvas.high(1.2f * kGuidanceWords), {1, 1, 1, fading});
}

}  // namespace

bool says_anything(const DemoGuidance& guidance) {
    return guidance.hint != DemoHint::none || praises(guidance);
}

void draw_guidance(const UiCanvas& canvas, const View& view, const DemoGuidance& guidance,
                   const std::optional<glm::dvec3>& praised_m, glm::vec3 color, double dt_s,
                   GuidanceSpot& spot) {
    const std::optional<glm::vec2> anchor = anchor_px(canvas, view, guidance.anchor_m);
    if (guidance.hint == DemoHint::none) {
        spot = {};
    } else {
        const glm::vec2 wanted = place_of(canvas, anchor);
        const bool stays = spot.at && spot.hint == guidance.hint &&
                           glm::distance(*spot.at, wanted) < canvas.high(kFar);
        const auto part = static_cast<float>(stays ? -std::expm1(-dt_s / kFollowS) : 1);
        spot.shown_s = stays || !spot.at ? spot.shown_s + dt_s : 0;
        spot.at = spot.at.value_or(wanted) + part * (wanted - spot.at.value_or(wanted));
        spot.hint = guidance.hint;
        draw_hint(canvas, guidance, *spot.at, std::min(guidance.shown_s, spot.shown_s), color);
    }
    if (praises(guidance)) {
        const auto hand = anchor_px(canvas, view, praised_m);
        draw_praise(
            canvas, guidance,
            hand ? *hand
                 : anchor.value_or(glm::vec2(0.5f * canvas.size().x, 0.45f * canvas.size().y)),
            color);
    }
}

}  // namespace kino
