#pragma once

#include <cstdint>

namespace kino {

/// What somebody looks like. The zeros and ones are the base mesh, undressed.
struct ActorLook {
    double stature_m = 1.70;
    // Shares of the base's proportions, 1 = as it is.
    double legs = 1, arms = 1, trunk = 1, head = 1, hands = 1, feet = 1;
    double shoulders = 1, waist = 1, hips = 1;  ///< widths
    double weight = 0;                          ///< -1 thin, 0 as the base, 2 heavy
    double belly_m = 0, bust_m = 0;             ///< how far they stand out
    double muscle = 0;                          ///< 0..1: upper arms, shoulders, thighs, calves

    // Clothes, metres off the skin. Ends count along the limb: 0 at its root, 1 at elbow or knee,
    // 2 at wrist or ankle.
    double shirt_m = 0, sleeve_m = 0, sleeve_end = 0;
    double drape_m = 0;                   ///< how far the shirt hangs off the waist
    double jacket_m = 0, jacket_end = 0;  ///< over trunk and arms; its end lies on the leg
    double trousers_m = 0, trousers_flare_m = 0, trousers_end = 0;
    double skirt_end = 0, skirt_flare_m = 0;  ///< end 0: none
    double shoe_m = 0, sole_m = 0;
    double hair_m = 0, long_hair_m = 0;  ///< thickness; length below the ears
    double cap_m = 0, hood_m = 0;
};

/// Adults of 1.45 to 2.0 m, one in twenty a child from 1.1 m; dressed.
[[nodiscard]] ActorLook random_look(std::uint64_t seed);

}  // namespace kino
