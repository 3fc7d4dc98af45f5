#pragma once

#include <vector>

#include "skeleton/synthetic/body_model.h"
#include "skeleton/synthetic/primitive.h"

namespace kino {

/// Clothes the posed skeleton: appends the person's solids, world space, always the same number in
/// the same order. Every joint lies inside one of them.
void append_flesh(const PosedBody& body, std::vector<Primitive>& out);

}  // namespace kino
