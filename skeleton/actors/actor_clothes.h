#pragma once

#include <vector>

#include "skeleton/actors/actor_body.h"
#include "skeleton/actors/actor_shape.h"

namespace kino {

/// How far clothes and hair stand off the skin, metres, at each vertex of the base mesh. The sole
/// is in `down_m`: to be added downwards.
struct ClothesOffset {
    std::vector<double> out_m, down_m;
};
[[nodiscard]] ClothesOffset clothes_offset(const ActorLook& look);

/// Skirt and long hair: cloth of their own, added to a dressed body.
void add_skirt(const ActorLook& look, const ActorShape& shape, ActorBody& body);
void add_long_hair(const ActorLook& look, const ActorShape& shape, ActorBody& body);

}  // namespace kino
