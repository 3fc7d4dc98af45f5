#include "apps/demo/painter.h"

#include <glm/gtc/matrix_transform.hpp>

#include "apps/demo/easing.h"
#include "apps/stage/stage_shapes.h"

namespace kino::demo {
namespace {

constexpr double kSpacingM = 0.03;
constexpr double kPaletteM = 2.4;  // of way for once through the palette
constexpr double kStrokeM = 0.02;
constexpr float kTrailIntensity = 0.024f, kTrailRadiusM = 0.55f;
constexpr float kShare = 55;
constexpr float kSparkIntensity = 0.05f, kSparkRadiusM = 0.6f;
constexpr double kSparkM = 0.032;
constexpr double kTailPart = 0.15;  // the oldest of a full trail fades
constexpr double kLeast = 1.0 / 256;

/// Takes the rod of length 1 along y from `from` to `to`.
glm::dmat4 stroke_between(const glm::dvec3& from, const glm::dvec3& to, double width) {
    const glm::dvec3 along = to - from;
    const double length = glm::length(along);
    const glm::dvec3 y = length > 1e-9 ? along / length : glm::dvec3(0, 1, 0);
    const glm::dvec3 other = std::abs(y.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0);
    const glm::dvec3 x = glm::normalize(glm::cross(y, other));
    // Longer by half a width, so that a bend shows no gap.
    return {glm::dvec4(width * x, 0), glm::dvec4((length + 0.5 * width) * y, 0),
            glm::dvec4(width * glm::cross(x, y), 0), glm::dvec4(0.5 * (from + to), 1)};
}

Trail new_trail() {
    return {Painter::kTrailLights, kSpacingM};
}

}  // namespace

Painter::Painter(std::uint64_t seed)
    : trails_{new_trail(), new_trail(), new_trail(), new_trail()},
      chance_(seed),
      seed_(seed),
      stroke_(make_stroke()),
      bead_(make_bead()) {}

void Painter::reset() {
    // Anew, for numbers of points begin at 0 again.
    for (Trail& trail : trails_) trail = new_trail();
    painted_m_ = {};
    sparks_ = {};
    next_spark_ = 0;
    chance_ = Chance(seed_);
    time_s_ = 0;
}

void Painter::step(double dt_s, const Players& players, std::span<const CastMember> cast,
                   const glm::dvec3& off_m) {
    time_s_ += dt_s;
    for (std::size_t place = 0; place < Players::kMost; ++place) {
        const Player& player = players.all()[place];
        const CastMember* member = nullptr;
        for (const CastMember& one : cast) {
            if (player.id != 0 && one.id == player.id && one.present) member = &one;
        }
        for (std::size_t side = 0; side < 2; ++side) {
            Trail& trail = trails_[2 * place + side];
            const Joint joint = side == 0 ? Joint::hand_left : Joint::hand_right;
            if (member != nullptr && (*member)[joint].seen) {
                const std::uint64_t before = trail.size() > 0 ? trail.newest(0).number + 1 : 0;
                trail.reach((*member)[joint].world_m + off_m, time_s_);
                const std::uint64_t after = trail.size() > 0 ? trail.newest(0).number + 1 : 0;
                if (after > before) {
                    painted_m_[place] += kSpacingM * static_cast<double>(after - before);
                }
            } else {
                trail.lift();
            }
            trail.forget_before(time_s_ - kLifeS);
        }
        if (player.id == 0) painted_m_[place] = 0;
    }
    for (Spark& spark : sparks_) {
        if (spark.age_s >= spark.life_s) continue;
        spark.age_s += dt_s;
        // Air stops them soon.
        spark.speed_m_s *= std::exp(-2.5 * dt_s);
        spark.speed_m_s.y -= 1.2 * dt_s;
        spark.at_m += dt_s * spark.speed_m_s;
    }
}

void Painter::add_spark(const Spark& spark) {
    if (!is_finite(spark.at_m) || !is_finite(spark.speed_m_s)) return;
    sparks_[next_spark_] = spark;
    sparks_[next_spark_].shown_m = spark.at_m;
    sparks_[next_spark_].age_s = 0;
    next_spark_ = (next_spark_ + 1) % kSparks;
}

std::size_t Painter::burst(int painter, const glm::dvec3& from_m) {
    std::size_t flown = 0;
    for (std::size_t i = 0; i < trails_.size(); ++i) {
        const int whose = static_cast<int>(i / 2);
        if (painter >= 0 && whose != painter) continue;
        Trail& trail = trails_[i];
        for (std::size_t k = 0; k < trail.size(); ++k) {
            const TrailPoint& point = trail.newest(k);
            glm::dvec3 out = point.world_m - from_m;
            const double length = glm::length(out);
            out = length > 1e-6 ? out / length : glm::dvec3(0, 1, 0);
            const glm::dvec3 by_chance(chance_.between(-1, 1), chance_.between(-0.4, 1.4),
                                       chance_.between(-1, 1));
            add_spark({.at_m = point.world_m,
                       .speed_m_s = chance_.between(1.2, 2.6) * out + 0.9 * by_chance,
                       .life_s = kBurstS * chance_.between(0.7, 1),
                       .rounds = point.way_m / kPaletteM,
                       .painter = whose});
            ++flown;
        }
        trail.clear();
    }
    return flown;
}

void Painter::spray(int painter, const glm::dvec3& from_m, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
        const double angle = chance_.between(0, 6.283185307179586);
        const double flat = chance_.between(0.2, 1);
        add_spark({.at_m = from_m,
                   .speed_m_s = 2.2 * glm::dvec3(flat * std::cos(angle), chance_.between(0.3, 1.3),
                                                 flat * std::sin(angle)),
                   .life_s = chance_.between(0.6, 0.9),
                   .rounds = chance_.part(),
                   .painter = painter});
    }
}

std::size_t Painter::points() const {
    std::size_t sum = 0;
    for (const Trail& trail : trails_) sum += trail.size();
    return sum;
}

std::size_t Painter::lights() const {
    std::size_t sum = points();
    for (const Spark& spark : sparks_) sum += spark.age_s < spark.life_s;
    return sum;
}

void Painter::fill(Scene& scene, std::uint32_t first_id, std::span<const Colors> colors,
                   std::span<const std::uint32_t> glow) const {
    const auto add_light = [&](const glm::dvec3& at, const glm::vec3& color, float radius) {
        scene.lights.push_back(
            {.kind = LightKind::point, .position = at, .color = color, .radius_m = radius});
    };
    for (std::size_t i = 0; i < trails_.size(); ++i) {
        const Trail& trail = trails_[i];
        const Colors& own = colors[i / 2];
        // Many lights near each other share what few have, or whoever paints would be burnt out.
        const float share = kTrailIntensity / (1 + static_cast<float>(trail.size()) / kShare);
        for (std::size_t k = 0; k < trail.size(); ++k) {
            const TrailPoint& point = trail.newest(k);
            const double left = 1 - (time_s_ - point.born_s) / kLifeS;
            const double tail =
                (1 - static_cast<double>(k) / static_cast<double>(kTrailLights)) / kTailPart;
            const double weight = smooth(left) * smooth(tail);
            if (weight < kLeast) continue;
            const double rounds = point.way_m / kPaletteM;
            add_light(point.world_m, own.along(rounds) * (share * static_cast<float>(weight)),
                      kTrailRadiusM);
            if (!point.joined || k + 1 >= trail.size()) continue;
            const double width = kStrokeM * std::sqrt(weight);
            const glm::dmat4 at = stroke_between(trail.newest(k + 1).world_m, point.world_m, width);
            scene.meshes.push_back(
                {.id = first_id +
                       static_cast<std::uint32_t>(i * kTrailLights + point.number % kTrailLights),
                 .mesh = stroke_,
                 .world_from_object = at,
                 .previous_world_from_object = at,
                 .material = glow[i / 2] + static_cast<std::uint32_t>(Colors::index(rounds))});
        }
    }
    const auto spark_id = first_id + static_cast<std::uint32_t>(trails_.size() * kTrailLights);
    for (std::size_t i = 0; i < sparks_.size(); ++i) {
        const Spark& spark = sparks_[i];
        if (!(spark.age_s < spark.life_s)) continue;
        const double weight = smooth(1 - spark.age_s / spark.life_s);
        if (weight < kLeast) continue;
        const auto whose = static_cast<std::size_t>(spark.painter < 0 ? 0 : spark.painter);
        add_light(
            spark.at_m,
            colors[whose].along(spark.rounds) * (kSparkIntensity * static_cast<float>(weight)),
            kSparkRadiusM);
        const glm::dvec3 size(kSparkM * std::sqrt(weight));
        const glm::dmat4 one(1);
        scene.meshes.push_back(
            {.id = spark_id + static_cast<std::uint32_t>(i),
             .mesh = bead_,
             .world_from_object = glm::scale(glm::translate(one, spark.at_m), size),
             .previous_world_from_object = glm::scale(glm::translate(one, spark.shown_m), size),
             .material = glow[whose] + static_cast<std::uint32_t>(Colors::index(spark.rounds))});
    }
}

void Painter::shown() {
    for (Spark& spark : sparks_) spark.shown_m = spark.at_m;
}

}  // namespace kino::demo
