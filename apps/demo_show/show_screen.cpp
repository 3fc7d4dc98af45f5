#include "apps/demo_show/show_screen.h"

#include <algorithm>
#include <array>

#include "apps/demo_show/show_keys.h"
#include "apps/demo_show/ui_canvas.h"

namespace kino {
namespace {

constexpr glm::vec4 kWhite{1, 1, 1, 1}, kSoft{0.75f, 0.78f, 0.82f, 1};
constexpr glm::vec4 kPlate{0.03f, 0.03f, 0.06f, 0.72f};
/// Of the first person and of the second.
constexpr std::array<glm::vec3, 2> kGuidanceColors = {{{1.0f, 0.72f, 0.30f}, {0.40f, 0.85f, 1.0f}}};
constexpr double kSceneNameS = 2.5;

void draw_banner(const UiCanvas& canvas, const std::string& words) {
    const float height = canvas.high(0.052f), middle = canvas.high(0.065f);
    const float half = std::min(0.5f * canvas.width_of(words, height) + canvas.high(0.04f),
                                0.5f * canvas.size().x);
    const float x = 0.5f * canvas.size().x, tall = canvas.high(0.045f);
    canvas.plate({x - half, middle - tall}, {x + half, middle + tall}, kPlate, tall);
    canvas.words(words, {x, middle}, height, kWhite);
}

void draw_trouble(const UiCanvas& canvas, const ShowScreen::Trouble& trouble) {
    const glm::vec2 size = canvas.size();
    canvas.plate({0, 0}, size, {0.03f, 0.02f, 0.04f, 0.82f}, 0);
    const glm::vec2 sign(0.5f * size.x, 0.26f * size.y);
    const float half = canvas.high(0.09f);
    const std::array<glm::vec2, 4> triangle = {
        sign + half * glm::vec2(0, -1), sign + half * glm::vec2(1.1f, 0.85f),
        sign + half * glm::vec2(-1.1f, 0.85f), sign + half * glm::vec2(0, -1)};
    canvas.line(triangle, {1.0f, 0.72f, 0.30f, 1}, canvas.high(0.014f));
    canvas.words("!", sign + half * glm::vec2(0, 0.28f), 1.1f * half, {1.0f, 0.72f, 0.30f, 1});
    canvas.words(trouble.what, {0.5f * size.x, 0.50f * size.y}, canvas.high(0.12f), kWhite);
    canvas.words(trouble.remedy, {0.5f * size.x, 0.66f * size.y}, canvas.high(0.066f), kSoft);
}

void draw_keys(const UiCanvas& canvas) {
    const auto keys = show_key_table();
    const float row = canvas.high(0.062f), text = canvas.high(0.044f);
    const float tall = row * static_cast<float>(keys.size() + 1);
    const glm::vec2 size = canvas.size();
    const glm::vec2 from(0.5f * size.x - canvas.high(0.46f), 0.5f * (size.y - tall));
    canvas.plate(from, {size.x - from.x, from.y + tall}, {0.03f, 0.03f, 0.06f, 0.9f},
                 canvas.high(0.02f));
    for (std::size_t i = 0; i < keys.size(); ++i) {
        const float y = from.y + row * (static_cast<float>(i) + 1);
        canvas.words_from(keys[i].shown, {from.x + canvas.high(0.05f), y}, text,
                          {1.0f, 0.80f, 0.45f, 1});
        canvas.words_from(keys[i].help, {from.x + canvas.high(0.24f), y}, text, kWhite);
    }
}

void draw_stats(const UiCanvas& canvas, const std::vector<std::string>& lines) {
    const float text = canvas.high(0.026f), row = canvas.high(0.034f);
    float wide = 0;
    for (const std::string& line : lines) wide = std::max(wide, canvas.width_of(line, text));
    // Below the banner.
    const float edge = canvas.high(0.02f), top = canvas.high(0.125f);
    canvas.plate({edge, top},
                 {wide + 3 * edge, top + row * static_cast<float>(lines.size()) + edge}, kPlate,
                 0.5f * edge);
    for (std::size_t i = 0; i < lines.size(); ++i) {
        const float y = top + 0.5f * edge + row * (static_cast<float>(i) + 0.5f);
        canvas.words_from(lines[i], {2 * edge, y}, text, kSoft);
    }
}

bool shows_scene_name(const ShowScreen& screen) {
    return !screen.scene_name.empty() && screen.scene_name_shown_s < kSceneNameS;
}

}  // namespace

bool ShowScreen::empty() const {
    const bool silent = std::none_of(guidance.begin(), guidance.end(), [](const auto* one) {
        return one != nullptr && says_anything(*one);
    });
    return silent && banner.empty() && !trouble && !keys && note.empty() && !records &&
           stats.empty() && !shows_scene_name(*this);
}

void draw_screen(const UiCanvas& canvas, const View& view, const ShowScreen& screen, double dt_s,
                 std::array<GuidanceSpot, 2>& spots) {
    if (screen.trouble) {
        draw_trouble(canvas, *screen.trouble);
    } else {
        if (shows_scene_name(screen)) {
            const double left = kSceneNameS - screen.scene_name_shown_s;
            canvas.words(screen.scene_name, {0.5f * canvas.size().x, canvas.high(0.93f)},
                         canvas.high(0.07f), {1, 1, 1, std::min(1.0, 2 * left)});
        }
        for (std::size_t i = 0; i < screen.guidance.size(); ++i) {
            if (screen.guidance[i] == nullptr) {
                spots[i] = {};
                continue;
            }
            draw_guidance(canvas, view, *screen.guidance[i], screen.praised_m[i],
                          kGuidanceColors[i], dt_s, spots[i]);
        }
    }
    if (!screen.banner.empty()) draw_banner(canvas, screen.banner);
    if (!screen.stats.empty()) draw_stats(canvas, screen.stats);
    const float text = canvas.high(0.04f), edge = canvas.high(0.05f);
    if (!screen.note.empty()) {
        const float half = 0.5f * canvas.width_of(screen.note, text);
        canvas.words(screen.note, {half + edge, canvas.size().y - edge}, text, kWhite);
    }
    if (screen.records) {
        const glm::vec2 at(canvas.size().x - edge, edge);
        canvas.disc(at, canvas.high(0.018f), {0.95f, 0.15f, 0.12f, 1});
        canvas.ring(at, canvas.high(0.026f), {0.95f, 0.15f, 0.12f, 0.8f}, canvas.high(0.004f));
    }
    if (screen.keys) draw_keys(canvas);
}

}  // namespace kino
