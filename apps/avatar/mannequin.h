#pragma once

#include "apps/avatar/avatar_rig.h"

namespace kino {

/// An artist's mannequin of 1.75 m, made by code: one smooth skin over the bones of kJointParent
/// with collar bones and twist joints, shoes, gloves and a visor. Takes a few hundredths of a
/// second.
[[nodiscard]] AvatarRig make_mannequin();

}  // namespace kino
