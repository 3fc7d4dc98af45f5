#include "skeleton/actors/actor_look.h"

#include <algorithm>

#include "skeleton/actors/actor_random.h"

namespace kino {
namespace {

void dress(ActorLook& look, ActorRandom& random, double masculine) {
    look.shirt_m = random.in(0.002, 0.014);
    look.drape_m = random.chance(0.7) ? random.in(0.005, 0.050) : 0;
    const double sleeves = random.unit();
    look.sleeve_end = sleeves < 0.12 ? 0 : sleeves < 0.45 ? random.in(0.3, 0.9) : 2;
    look.sleeve_m = random.chance(0.25) ? random.in(0.015, 0.040) : random.in(0.002, 0.015);
    if (random.chance(0.35)) {
        look.jacket_m = random.in(0.008, 0.035);
        look.jacket_end = random.chance(0.25) ? random.in(0.4, 1.2) : random.in(0, 0.35);
        look.sleeve_end = random.chance(0.9) ? 2 : look.sleeve_end;
    }
    if (random.chance(0.22 * (1 - masculine))) {
        look.skirt_end = random.in(0.45, 1.85);
        look.skirt_flare_m = random.in(0.0, 0.22);
    } else {
        look.trousers_end = random.chance(0.2) ? random.in(0.4, 1.2) : 2;
        look.trousers_m = random.in(0.002, 0.022);
        look.trousers_flare_m = random.chance(0.2) ? random.in(0.02, 0.06) : random.in(0, 0.015);
    }
    look.shoe_m = random.chance(0.1) ? 0 : random.in(0.004, 0.016);
    look.sole_m = look.shoe_m > 0 ? random.in(0.005, 0.035) : 0;
    look.hair_m = random.chance(0.12) ? 0 : random.in(0.004, 0.035);
    if (random.chance(0.5 * (1 - masculine) + 0.05)) look.long_hair_m = random.in(0.05, 0.30);
    if (random.chance(0.12)) look.cap_m = random.in(0.006, 0.03);
    if (random.chance(0.10)) look.hood_m = random.in(0.015, 0.05);
}

}  // namespace

ActorLook random_look(std::uint64_t seed) {
    ActorRandom random{seed, 0x100C};
    ActorLook look;
    const double masculine =
        std::clamp(random.normal(random.chance(0.5) ? 0.85 : 0.15, 0.15), 0.0, 1.0);
    const bool child = random.chance(0.05);
    look.stature_m = child ? random.in(1.10, 1.45)
                           : std::clamp(random.normal(1.63 + 0.14 * masculine, 0.075), 1.45, 2.0);
    // Longer legs go with tall people; heads hardly grow.
    look.legs = random.normal(1, 0.035) + 0.10 * (look.stature_m - 1.70);
    look.arms = random.normal(1, 0.035);
    look.trunk = random.normal(1, 0.02);
    look.head = random.normal(1, 0.035) * std::pow(1.70 / look.stature_m, 0.75);
    look.hands = random.normal(0.97 + 0.05 * masculine, 0.05);
    look.feet = random.normal(0.97 + 0.05 * masculine, 0.04);
    look.shoulders = random.normal(0.93 + 0.14 * masculine, 0.035);
    look.hips = random.normal(1.05 - 0.09 * masculine, 0.03);
    look.waist = random.normal(0.98 + 0.10 * masculine, 0.03);
    look.weight = std::clamp(random.normal(0.25, 0.65), -0.8, 2.2);
    if (child) {
        look.shoulders *= 0.95;
        look.weight = std::clamp(look.weight - 0.1, -0.6, 1.2);
    }
    look.belly_m = std::max(0.0, random.normal(0.06 * look.weight - 0.01, 0.03));
    look.bust_m = child ? 0 : std::max(0.0, (1 - masculine) * random.normal(0.035, 0.02));
    look.muscle = random.unit() * random.unit() * (0.3 + 0.7 * masculine);
    dress(look, random, masculine);
    return look;
}

}  // namespace kino
